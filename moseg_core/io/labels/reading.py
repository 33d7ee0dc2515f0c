"""The one reader of labels: of any file that bears them, for a shape.

By the suffix the file is read as a listing of labels, which is then fitted to the shape
(:mod:`moseg_core.io.labels`). Of other suffixes the reader of a bundle may know what labels the
file bears (:class:`moseg_core.ReaderSpec`); it is told the shape and answers with a labelling.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import cast

import numpy as np

from moseg_core.components.discovery.registry import Component, registry
from moseg_core.components.discovery.specs import ReaderSpec
from moseg_core.components.parameters import takes
from moseg_core.errors import REPORT, PluginError, ShapeError, UsageError
from moseg_core.io.labels.arrays import read_npy, read_npz
from moseg_core.io.labels.fitting import fitted
from moseg_core.io.labels.glb import read_glb_labels
from moseg_core.io.labels.json_forms import read_json
from moseg_core.io.labels.labelling import Labelling
from moseg_core.io.labels.listing import Listing, Wanted
from moseg_core.io.labels.obj import read_obj_labels
from moseg_core.io.labels.ply import read_ply_labels
from moseg_core.io.labels.safe_names import safe_names
from moseg_core.io.labels.stl import read_stl_labels
from moseg_core.io.labels.text import read_text
from moseg_core.io.read.checked import file_error
from moseg_core.io.read.limits import LIMITS, ReadLimits
from moseg_core.shape.shape import Shape
from moseg_core.untrusted.regular_file import refuse_irregular

_READERS: dict[str, Callable[[Path, Wanted], Listing]] = {
    **dict.fromkeys((".seg", ".txt", ".labels", ".label", ".lab", ".csv", ".tsv"), read_text),
    **dict.fromkeys((".dat", ".xyz", ".pts", ".asc"), read_text),
    ".json": read_json,
    ".npy": read_npy,
    ".npz": read_npz,
    ".ply": read_ply_labels,
    ".obj": read_obj_labels,
    ".stl": read_stl_labels,
    ".glb": read_glb_labels,
    ".gltf": read_glb_labels,
}
#: Shapes, which may bear labels.
_SHAPES = (".ply", ".obj", ".stl", ".glb", ".gltf")
_OF_EDGES = (".eseg", ".seseg")


def read_labels(
    path: str | os.PathLike[str],
    shape: Shape | int,
    *,
    label_property: str | Sequence[str] = (),
    fill: bool = False,
    limits: ReadLimits = LIMITS,
) -> Labelling:
    r"""Read the labelling of a shape, in any form that the suffix may have.

    Parameters
    ----------
    path : path-like
        Text (".seg", ".txt", ".labels", ".csv", ...), ".json", ".npy", ".npz", or a shape that
        bears labels: ".ply", ".obj", ".stl" or ".glb".
    shape : Shape or int
        What the labels are of; or how many elements it has, and then labels of its vertices cannot
        be told, nor labels of faces in another order.
    label_property : str or sequence of str
        What the property, column, array or member is called that holds the labels, where a file has
        several; the first that there is. Usual names are known.
    fill : bool
        Whether elements without a label get that of the nearest element that has one; needs a
        shape.
    limits : ReadLimits, optional
        How much a file may become that is a shape with labels, as in :func:`moseg_core.load`.

    Returns
    -------
    Labelling
        With one label for each element, -1 where there is none; its notes say what was passed
        over, chosen or carried.

    Raises
    ------
    UsageError
        Another suffix; `fill` where only a number of elements is known.
    ShapeError
        The file cannot be read, is malformed, labels nothing, does not fit the shape, or becomes
        more than the limits allow.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "cup_labels.txt"
    ...     _ = file.write_text("body\n1 3\nhandle\n2\n")
    ...     cup = read_labels(file, 4)
    >>> cup.labels.tolist(), cup.names
    ([0, 1, 0, -1], ('body', 'handle'))
    >>> cup.notes
    ('cup_labels.txt: 1 of 4 elements is unlabelled and left out',)
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if fill and not isinstance(shape, Shape):
        raise UsageError(
            f"{path.name}: fill=True takes the label of the nearest element, and of the shape only"
            " the number of elements is known; give the shape"
        )
    if suffix in _OF_EDGES:
        raise UsageError(
            f"{path.name}: '{suffix}' has labels of edges, as MeshCNN writes them, and moseg labels"
            " faces; give the labels of the faces"
        )
    asked = (label_property,) if isinstance(label_property, str) else tuple(label_property)
    wanted = Wanted.of(shape, asked, limits=limits)
    if reader := _READERS.get(suffix):
        listing = reader(path, wanted)
        labels, notes = fitted(path, listing, shape)
        names, notes = listing.names, (*listing.notes, *notes)
    else:
        told = _told_by_bundle(path, shape, limits)
        labels, names, notes = told.labels, told.names, told.notes
    if names is not None and labels.size and labels.max() >= len(names):
        element = int(np.argmax(labels >= len(names)))
        raise file_error(
            path,
            f"gives {wanted.noun} {element} the label {labels[element]}, but names only"
            f" {len(names)} labels (both counted from 0)",
        )
    if names is not None and (safe := safe_names(names)) != tuple(names):
        changed = [new for new, old in zip(safe, names, strict=True) if new != old]
        notes = (
            *notes,
            f"{path.name}: names of labels that are too long, or hold what cannot be seen:"
            f" {len(changed)}, such as '{changed[0]:.40}'",
        )
        names = safe
    missing = int((labels < 0).sum())
    if missing and missing == len(labels):
        raise file_error(path, f"gives a label to none of the {missing} {wanted.noun}s")
    found = Labelling(labels=labels, names=names)
    if missing:
        are = "is" if missing == 1 else "are"
        said = f"{path.name}: {missing} of {len(labels)} {wanted.noun}s {are} unlabelled and"
        if fill and isinstance(shape, Shape):
            labels = found.filled(shape)
            notes = (*notes, f"{said} counted as the nearest labelled")
        else:
            notes = (*notes, f"{said} left out")
    return Labelling(labels=labels, names=names, notes=notes)


def bearing_suffixes() -> tuple[str, ...]:
    """Suffixes of shapes that may bear labels themselves, those that bundles read among them."""
    return (*_SHAPES, *_bearers())


def _bearers() -> dict[str, Component]:
    """By suffix the readers of bundles whose formats bear labels."""
    return {
        suffix: component
        for suffix, component in registry().suffixes("reader").items()
        if getattr(component.spec, "labels", "")
    }


def _told_by_bundle(path: Path, shape: Shape | int, limits: ReadLimits) -> Labelling:
    """Labels as the reader of a bundle tells them."""
    able = _bearers()
    fitting = [suffix for suffix in able if path.name.lower().endswith(suffix)]
    if not fitting:
        kind = f"'{path.suffix}'" if path.suffix else "no suffix"
        raise UsageError(
            f"{path.name}: cannot read labels from a file with {kind};"
            f" allowed: {', '.join([*_READERS, *able])}"
        )
    if not isinstance(shape, Shape):
        raise UsageError(f"{path.name}: its labels are those of places; give the shape")
    component = able[max(fitting, key=len)]
    module, _, name = cast(ReaderSpec, component.spec).labels.partition(":")
    try:
        refuse_irregular(path)
        with component.guard(f"failed on the labels of '{path}'"):
            tell = getattr(importlib.import_module(module), name)
            given = {"limits": limits} if takes(tell, "limits") else {}
            told = tell(path, shape, **given)
    except OSError as error:
        raise ShapeError(f"'{path}' cannot be read: {error.strerror or error}") from error
    if not isinstance(told, Labelling) or told.labels.shape != (shape.n_elements,):
        raise PluginError(
            f"{component.who} must tell a Labelling of {shape.n_elements} labels of '{path}', not"
            f" {told!r:.60}; {REPORT}"
        )
    return told
