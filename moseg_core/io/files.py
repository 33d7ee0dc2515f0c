"""Reading shapes and writing results, by suffix; the only place that writes shapes and results.

Readers and writers are components (:mod:`moseg_core.components.discovery.specs`), so that a bundle
can add formats. A file is written beside its destination and renamed when it is whole: a run that
dies leaves either the old file or none.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from moseg_core.components.discovery.registry import Component, Registry, registry
from moseg_core.errors import MosegError, PluginError, ShapeError, UsageError
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape


def load(path: str | os.PathLike[str], *, source: Registry | None = None) -> Shape:
    """Read a shape; one surface element per polygon, point or cell, in file order.

    Parameters
    ----------
    path : path-like
        A mesh (OFF, PLY, OBJ, STL, GLB, GLTF), a point cloud (PLY without faces, text, NPY) or a
        voxel grid (NPY, BINVOX), by suffix, or what installed bundles add.
    source : Registry, optional
        Where to look for readers.

    Returns
    -------
    Shape

    Raises
    ------
    ShapeError
        The file does not exist, is empty or malformed.
    UsageError
        No reader for the suffix.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> moseg.load(moseg.sample_path("hammer")).n_elements > 5000
    True
    """
    path = Path(path)
    component = (registry() if source is None else source).by_suffix("reader", path.suffix)
    if not path.exists():
        raise ShapeError(f"'{path}' does not exist")
    if path.is_dir():
        raise ShapeError(f"'{path}' is a folder; name a file in it")
    reader = component.load()
    try:
        with component.guard(f"failed on '{path}'"):
            shape = reader(path)
    except OSError as error:
        raise ShapeError(f"'{path}' cannot be read: {error.strerror or error}") from error
    if not isinstance(shape, Shape):
        raise PluginError(
            f"reader '{component.id}' of {component.distribution} returned a"
            f" {type(shape).__name__}, not a Shape"
        )
    return shape


def save(result: Result, path: str | os.PathLike[str], *, source: Registry | None = None) -> None:
    """Write a result in the format that the suffix says.

    Parameters
    ----------
    result : Result
    path : path-like
        ``.json``, ``.seg``, ``.ply``, ``.glb``, ``.npz``, ``.npy``, ``.png``, ``.svg``, or what
        installed bundles add.
    source : Registry, optional
        Where to look for writers.

    Raises
    ------
    UsageError
        No writer for the suffix, or no such folder.
    MosegError
        The file cannot be written.

    Examples
    --------
    >>> moseg.save(result, "hammer.glb")  # doctest: +SKIP
    """
    path = Path(path)
    component = check_output(path, source=source)
    write = component.load()
    with component.guard():
        data = write(result)
    if not isinstance(data, bytes):
        raise PluginError(
            f"writer '{component.id}' of {component.distribution} returned a"
            f" {type(data).__name__}, not bytes"
        )
    write_file(path, data)


def check_output(path: Path, *, source: Registry | None = None) -> Component:
    """The writer for a path, or an error now rather than after a long search.

    Raises
    ------
    UsageError
        No writer for the suffix, no such folder, or a folder of that name.
    """
    component = (registry() if source is None else source).by_suffix("writer", path.suffix)
    check_destination(path)
    return component


def check_destination(path: Path) -> None:
    """Refuse a path whose folder does not exist, or that is a folder.

    Raises
    ------
    UsageError
        With the folder's name.
    """
    if path.is_dir():
        raise UsageError(f"cannot write '{path}': it is a folder")
    if not path.parent.is_dir():
        raise UsageError(f"cannot write '{path}': there is no folder '{path.parent}'")


def write_file(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file whole or not at all: aside, then renamed.

    Parameters
    ----------
    path : path-like
        In a folder that exists; what stands there is replaced.
    data : bytes

    Raises
    ------
    MosegError
        The disk is full, or the folder not writable.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_file(Path(folder) / "note.txt", b"whole")
    ...     [(path.name, path.read_bytes()) for path in Path(folder).iterdir()]
    [('note.txt', b'whole')]
    """
    path = Path(path)
    try:
        descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise MosegError(f"cannot write '{path}': {error.strerror}") from error
    aside = Path(name)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
        # mkstemp makes files private; a result gets the permissions of any new file.
        mask = os.umask(0)
        os.umask(mask)
        aside.chmod(0o666 & ~mask)
        aside.replace(path)
    except OSError as error:
        raise MosegError(f"cannot write '{path}': {error.strerror}") from error
    finally:
        aside.unlink(missing_ok=True)
