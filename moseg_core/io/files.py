"""Reading shapes and writing results, by suffix; the only place that writes shapes and results.

Readers and writers are components (:mod:`moseg_core.components.discovery.specs`), so that a bundle
can add formats. A writer makes bytes and touches no disk; a format of several files (a mesh with
its materials) makes several, beside the one that was asked for or below. Each is written whole or
not at all (:mod:`moseg_core.io.whole_file`). With ``{part}`` in its name a path stands for one file
for each part (:mod:`moseg_core.io.part_files`).
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from moseg_core.components.discovery.registry import Component, Registry, registry
from moseg_core.components.parameters import takes
from moseg_core.errors import REPORT, MosegError, PluginError, ShapeError, UsageError, nearest
from moseg_core.io.byte_names import readable
from moseg_core.io.part_files import PartForm, check_part_files, is_for_parts, part_files
from moseg_core.io.read.limits import LIMITS, ReadLimits
from moseg_core.io.whole_file import check_destination, told_of, write_file
from moseg_core.io.write.part_meshes import PART_SUFFIXES
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape
from moseg_core.untrusted.regular_file import refuse_irregular

#: Characters that lead elsewhere on some system, or into no file: drives, streams, other slashes.
_NOT_IN_NAMES = {"\\", ":", *map(chr, range(32))}

HULL_VERTICES = "hull_vertices"
"""The keyword by which a writer of hulls is told how many vertices these may have."""


def load(
    path: str | os.PathLike[str],
    *,
    limits: ReadLimits = LIMITS,
    source: Registry | None = None,
) -> Shape:
    """Read a shape; one surface element per polygon, point or cell, in file order.

    Parameters
    ----------
    path : path-like
        A mesh (OFF, PLY, OBJ, STL, GLB, GLTF), a point cloud (PLY without faces, text, NPY) or a
        voxel grid (NPY, BINVOX), by suffix, or what installed bundles add.
    limits : ReadLimits, optional
        How much the file may become: triangles and cells in proportion to its bytes.
    source : Registry, optional
        Where to look for readers.

    Returns
    -------
    Shape

    Raises
    ------
    ShapeError
        The file does not exist, is empty or malformed, or becomes more than the limits allow.
    UsageError
        No reader for the suffix.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> moseg.load(moseg.sample_path("hammer")).n_elements > 5000
    True
    """
    path = Path(path)
    component = (registry() if source is None else source).by_suffix(
        "reader", "".join(path.suffixes)
    )
    if not os.path.exists(path):  # also where no file can have that name
        raise ShapeError(f"'{path}' does not exist{instead_of(path)}")
    if path.is_dir():
        raise ShapeError(f"'{path}' is a folder; name a file in it")
    reader = component.load()
    given: dict[str, Any] = {"limits": limits} if takes(reader, "limits") else {}
    try:
        refuse_irregular(path)  # a bundle's reader may open it as it likes
        with component.guard(f"failed on '{path}'"):
            try:
                shape = reader(path, **given)
            except MemoryError as error:
                raise ShapeError(
                    f"'{path}' ({path.stat().st_size} bytes) takes more memory than there is;"
                    " simplify or resample the shape first"
                ) from error
    except OSError as error:
        raise ShapeError(f"'{path}' cannot be read: {error.strerror or error}") from error
    if not isinstance(shape, Shape):
        raise PluginError(
            f"reader '{component.id}' of {component.distribution} returned a"
            f" {type(shape).__name__}, not a Shape"
        )
    return shape.with_file(str(path), name=readable(shape.name))


def instead_of(path: Path) -> str:
    """What is there in place of a file that does not exist: the end of a message."""
    try:
        if not path.parent.is_dir():
            return f"; there is no folder '{path.parent}'"
        near = nearest(path.name, [each.name for each in path.parent.iterdir()])
    except OSError:  # a folder that may not be looked into, a name that no file can have
        return ""
    return f"; did you mean '{path.with_name(near)}'?" if near else ""


def save(
    result: Result,
    path: str | os.PathLike[str],
    *,
    close: bool = False,
    hulls: bool = False,
    hull_vertices: int | None = None,
    source: Registry | None = None,
) -> None:
    """Write a result in the format that the suffix says, or each part as a file of its own.

    A part that cannot be closed, and what else is to be said of single parts, is a warning.

    Parameters
    ----------
    result : Result
    path : path-like
        ``.json``, ``.seg``, ``.ply``, ``.obj``, ``.glb``, ``.vtu``, ``.3mf``, ``.npz``, ``.npy``,
        ``.png``, ``.svg``, or what installed bundles add. With ``{part}`` in its name, one file
        for each part: ``parts/{part}.stl``, or ``.obj``, ``.ply``, ``.glb``; the last folder is
        made where it lacks.
    close : bool
        Each part as a closed solid; this and the next two with ``{part}`` only.
    hulls : bool
        The convex hull of each part instead of its surface.
    hull_vertices : int, optional
        The greatest number of vertices of a hull, 4 or more; also of formats that hold hulls.
    source : Registry, optional
        Where to look for writers.

    Raises
    ------
    UsageError
        No writer for the suffix, no such folder, or a form of parts where none are asked for.
    ShapeError
        The parts of a point cloud cannot be written so.
    MosegError
        The file cannot be written.

    Examples
    --------
    >>> moseg.save(result, "hammer.glb")  # doctest: +SKIP
    >>> moseg.save(result, "parts/{part}.stl", close=True)  # doctest: +SKIP
    """
    path = Path(path)
    form = PartForm(close=close, hulls=hulls, hull_vertices=hull_vertices)
    check_form(form, [path], source=source)
    check_any_output(path, source=source)
    if not is_for_parts(path):
        write_files(files_of(result, path, hull_vertices=hull_vertices, source=source))
        return
    files, notes = part_files(result, path, form)
    write_files(files)
    for note in notes:
        warnings.warn(note, stacklevel=2)


def check_form(form: PartForm, paths: Iterable[Path], *, source: Registry | None = None) -> None:
    """Refuse a form of parts where no path asks for parts, or for hulls.

    Raises
    ------
    UsageError
        With what to ask for.
    """
    if form.asked and not any(is_for_parts(path) for path in paths):
        raise UsageError(
            f"'{form.asked}' is about files of single parts, and none is asked for: give a path"
            " such as 'parts/{part}.stl'"
        )
    if form.hull_vertices is None or form.hulls:
        return
    for path in paths:
        if not is_for_parts(path):
            writer = writer_for(path, source=source).load()
            if takes(writer, HULL_VERTICES):
                return
    raise UsageError(
        "a number of vertices of hulls is given, but no hulls are asked for: give hulls, and a path"
        " such as 'parts/{part}.stl', or a format that holds hulls, such as '.urdf'"
    )


def files_of(
    result: Result,
    path: Path,
    *,
    hull_vertices: int | None = None,
    source: Registry | None = None,
) -> dict[Path, bytes]:
    """What the writer of a path makes of a result: each file with its contents, nothing written.

    Parameters
    ----------
    result : Result
    path : Path
        The file that was asked for; the others are in its folder, or in folders below.
    hull_vertices : int, optional
        The greatest number of vertices of a hull, for formats that hold hulls.
    source : Registry, optional
        Where to look for writers.

    Raises
    ------
    UsageError
        No writer for the suffix.
    PluginError
        The writer fails, or what it returns is neither bytes nor files for that folder.
    """
    component = writer_for(path, source=source)
    write = component.load()
    given: dict[str, Any] = {"name": path.name}
    if hull_vertices is not None:
        given[HULL_VERTICES] = hull_vertices
    with component.guard():
        made = write(result, **{key: v for key, v in given.items() if takes(write, key)})
    if isinstance(made, bytes):
        return {path: made}
    if not isinstance(made, Mapping):
        hint = "; encode the text" if isinstance(made, str) else ""
        raise PluginError(
            f"{component.who} returned a {type(made).__name__}, not bytes{hint}; {REPORT}"
        )
    for name, data in made.items():
        if wrong := _wrong_name(name, path) or ("" if isinstance(data, bytes) else "no bytes"):
            raise PluginError(
                f"{component.who} returned {wrong} for the file {name!r:.80}; names are relative,"
                f" of files in the folder of '{path.name}', and their contents bytes; {REPORT}"
            )
    if path.name not in made:
        raise PluginError(
            f"{component.who} returned the files {', '.join(sorted(made)) or 'none'}, but not"
            f" '{path.name}', which was asked for; a writer that takes 'name' by keyword is told;"
            f" {REPORT}"
        )
    # The one that was asked for comes last: where it is, the others are.
    others = {path.parent / name: data for name, data in made.items() if name != path.name}
    return {**others, path: made[path.name]}


def write_files(files: Mapping[Path, bytes]) -> None:
    """Write several files, each whole or not at all, in order; folders are made where they lack.

    One that cannot be written does not keep the others from being written.

    Raises
    ------
    MosegError
        The disk is full, or a folder not writable; after the others were tried.
    """
    failures: list[MosegError] = []
    for file, data in files.items():
        try:
            with told_of(file):
                file.parent.mkdir(parents=True, exist_ok=True)
            write_file(file, data)
        except MosegError as error:
            failures.append(error)
    if failures:
        more = f", nor {len(failures) - 1} files more" if len(failures) > 1 else ""
        raise MosegError(f"{failures[0]}{more}")


def _wrong_name(name: object, path: Path) -> str:
    """What is wrong with the name of a file that is to be beside a path; empty for nothing."""
    if not isinstance(name, str):
        return "no name"
    if name == path.name:
        return ""  # the user's own, of any letters that the system takes
    parts = name.split("/")
    if any(part in ("", ".", "..") for part in parts) or set(name) & _NOT_IN_NAMES:
        return "a name that is not relative or not safe"
    # A folder that is a link elsewhere would take the file along.
    folder = path.parent.resolve()
    if not (folder / name).parent.resolve().is_relative_to(folder):
        return "a place outside of the folder"
    return "the name of a folder" if (folder / name).is_dir() else ""


def writer_for(path: Path, *, source: Registry | None = None) -> Component:
    """The writer for a path, by its suffix.

    Raises
    ------
    UsageError
        There is none.
    """
    try:
        found = registry() if source is None else source
        return found.by_suffix("writer", "".join(path.suffixes))
    except UsageError as error:
        if path.suffix.lower() not in PART_SUFFIXES:
            raise
        each = path.with_name(f"{path.stem}-{{part}}{path.suffix}")
        raise UsageError(f"{error}; or a file for each part: '{each}'") from None


def check_output(path: Path, *, source: Registry | None = None) -> Component:
    """The writer for a path, or an error now rather than after a long search.

    Raises
    ------
    UsageError
        No writer for the suffix, no such folder, a folder of that name, or a name that no file can
        have.
    PluginError
        The writer cannot be imported.
    MosegError
        The folder takes no files; the disk is full.
    """
    component = writer_for(path, source=source)
    component.load()
    check_destination(path)
    return component


def check_any_output(path: Path, *, source: Registry | None = None) -> None:
    """Refuse a path, of a file or of one for each part, that cannot be written.

    Raises
    ------
    MosegError
        As :func:`check_output`, or :func:`moseg_core.io.part_files.check_part_files`.
    """
    if is_for_parts(path):
        check_part_files(path)
    else:
        check_output(path, source=source)
