"""Checks of readers and writers: on files that are whole, cut short or none, and on results.

A reader meets whatever has its suffix: files that a program has not finished, other formats under
the wrong name, nothing at all. What it promises is a shape or a reason. A writer comes last, after
a search of hours, and what it must not do is lose that.
"""

from __future__ import annotations

import importlib
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import numpy as np

from moseg_core.components.discovery.registry import Bundle, Registry
from moseg_core.components.discovery.specs import ReaderSpec, WriterSpec
from moseg_core.errors import PluginError
from moseg_core.io.files import files_of, load, write_files
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.comparison import Raised, attempt
from moseg_core.testing.fixtures.results import result_on
from moseg_core.testing.fixtures.shapes import specimen

_WRITTEN = ("tetrahedron", "cube", "disc", "cloud", "voxels", "shell", "lump")
_STEM = "specimen"

#: Files of no format: a text, bytes as they come, zeros.
_NOISE: dict[str, bytes] = {
    "a file of a sentence": b"This is the wrong file, but it has the right name.\n",
    "a file of random bytes": np.random.default_rng(9).bytes(700),
    "a file of zeros": bytes(200),
}
_PIECES = 40


def _alone(subject: Subject) -> Registry:
    """Nothing but the component: of several for one suffix the first found is asked."""
    component = subject.component
    own = Bundle(component.bundle, component.distribution, "", "", (component,))
    return Registry([own])


def _bundle(subject: Subject) -> Registry:
    """Nothing but the component's bundle."""
    return Registry([b for b in subject.registry.bundles if b.name == subject.component.bundle])


# -- Readers ----------------------------------------------------------------------------------


def _read(subject: Subject, suffix: str, data: bytes) -> Any:
    """What reading a file comes to: a shape, or an error, excused where it says why."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{_STEM}{suffix}"
        path.write_bytes(data)
        found = attempt(load, path, source=_alone(subject))
        if path.read_bytes() != data:
            raise ContractFailure(
                did=f"a {suffix} file was read",
                got="other contents in the file than before",
                expected="a reader that only reads",
                fix="open the file with 'rb'",
            )
        return found


def _refused(found: Any) -> bool:
    """Whether a file was refused in words: by one of moseg's errors that blames nobody's code."""
    return isinstance(found, Raised) and found.excused and not isinstance(found.error, PluginError)


def _examples(subject: Subject) -> dict[str, bytes]:
    """The contents of a small file for each suffix of which the reader has an example."""
    spec = cast(ReaderSpec, subject.component.spec)
    if not spec.example:
        raise Skip(
            "it has no example: name a function of a suffix that returns the bytes of a small file"
            " in its ReaderSpec, example='package.module:name'"
        )
    module, _, name = spec.example.partition(":")
    made = {suffix: _example(module, name, suffix) for suffix in spec.suffixes}
    return {suffix: data for suffix, data in made.items() if data is not None}


def _example(module: str, name: str, suffix: str) -> bytes | None:
    made = getattr(importlib.import_module(module), name)(suffix)
    if made is None or isinstance(made, bytes):
        return made
    raise ContractFailure(
        did=f"its example of a {suffix} file was asked for",
        got=f"a {type(made).__name__}",
        expected="bytes, or None",
        fix="return the contents of the file, text encoded",
    )


@check("reader-reads-its-example", kinds=["reader"])
def _reads_its_example(subject: Subject) -> None:
    """What a reader says of a file must not hang on which files were read before."""
    examples = _examples(subject)
    first = {suffix: _fingerprint(subject, suffix, data) for suffix, data in examples.items()}
    for suffix, data in reversed(examples.items()):
        for noise in _NOISE.values():
            _read(subject, suffix, noise)
        for again in (suffix, suffix.upper()):
            found = _fingerprint(subject, again, data)
            if found != first[suffix]:
                raise ContractFailure(
                    did=f"a {again} file was read once more, after other files",
                    got=f"the shape {found}",
                    expected=f"the same as the first time, {first[suffix]}",
                    fix="keep nothing between two calls",
                )


def _fingerprint(subject: Subject, suffix: str, data: bytes) -> str:
    found = _read(subject, suffix, data)
    if not (isinstance(found, Shape) and found.n_elements):
        raise ContractFailure(
            did=f"its own example of a {suffix} file was read",
            got=str(found),
            expected="a Shape with elements",
            fix="mend the reader, or the example",
        )
    return found.fingerprint


@check("reader-refuses-what-is-none", kinds=["reader"])
def _refuses_what_is_none(subject: Subject) -> None:
    """A user who names the wrong file is to hear what is wrong with it, not how the reader fell."""
    for suffix in cast(ReaderSpec, subject.component.spec).suffixes:
        found = _read(subject, suffix, b"")
        if not _refused(found):
            raise _unsettled(f"an empty {suffix} file was read", found, "moseg_core.ShapeError")
        for title, data in _NOISE.items():
            found = _read(subject, suffix, data)
            if not (_refused(found) or isinstance(found, Shape)):
                raise _unsettled(f"{title}, {suffix}, was read", found, "moseg_core.ShapeError")


@check("reader-survives-cut-files", kinds=["reader"])
def _survives_cut_files(subject: Subject) -> None:
    """Copies are interrupted and disks full: files end in the middle."""
    for suffix, data in _examples(subject).items():
        for cut in sorted({len(data) * k // _PIECES for k in range(1, _PIECES)} - {0}):
            found = _read(subject, suffix, data[:cut])
            if not (_refused(found) or isinstance(found, Shape)):
                did = f"the first {cut} of {len(data)} bytes of its {suffix} example were read"
                raise _unsettled(did, found, "a Shape, or moseg_core.ShapeError")


@check("reader-reads-what-is-written", kinds=["reader"])
def _reads_what_is_written(subject: Subject) -> None:
    """A result is looked at again, cut further, or measured: by the bundle that wrote it."""
    mine = {
        suffix
        for component in _bundle(subject).components("writer")
        for suffix in cast(WriterSpec, component.spec).suffixes
    }
    common = [s for s in cast(ReaderSpec, subject.component.spec).suffixes if s in mine]
    if not common:
        raise Skip("its bundle writes no such files")
    shape = specimen("lump")
    for suffix in common:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{_STEM}{suffix}"
            files = attempt(files_of, result_on(shape), path, source=_bundle(subject))
            if isinstance(files, Raised):
                continue  # the writer's business
            write_files(files)
            found = attempt(load, path, source=_alone(subject))
        # Points are as many as the faces that they stand for; triangles cover what polygons do.
        whole = isinstance(found, Shape) and (
            found.n_elements == shape.n_elements or abs(found.area / shape.area - 1.0) < 1e-4
        )
        if not whole:
            raise ContractFailure(
                did=f"a result on the lump was written as {suffix}, and read",
                got=str(found),
                expected=f"a Shape of {shape.n_elements} elements, or of the area {shape.area:.6g}",
                fix="read all that the writer of the bundle writes",
            )


def _unsettled(did: str, found: Any, expected: str) -> ContractFailure:
    failure = ContractFailure(
        did=did,
        got=str(found),
        expected=expected,
        fix="check counts and offsets against the size of the file before they are used, and raise"
        " moseg_core.ShapeError with the file's name and what is wrong",
    )
    failure.__cause__ = found.error if isinstance(found, Raised) else None
    return failure


# -- Writers ----------------------------------------------------------------------------------


def _written(subject: Subject, name: str) -> Iterator[tuple[str, Any]]:
    """For each suffix, what a writer makes of a result on a specimen: files, or an error."""
    with tempfile.TemporaryDirectory() as folder:
        for suffix in cast(WriterSpec, subject.component.spec).suffixes:
            path = Path(folder) / f"{_STEM}{suffix}"
            result = result_on(specimen(name))
            found = attempt(files_of, result, path, source=_alone(subject))
            if not isinstance(found, Raised):
                found = {str(file.relative_to(folder)): data for file, data in found.items()}
            yield suffix, found


@check("writer-returns-bytes", kinds=["writer"])
def _returns_bytes(subject: Subject) -> None:
    """A writer is asked last: what it returns is found to be no file after the whole search."""
    refusals: dict[str, list[str]] = {}
    for name in _WRITTEN:
        for suffix, found in _written(subject, name):
            if not isinstance(found, Raised):
                refusals.setdefault(suffix, [])
            elif _refused(found):
                refusals.setdefault(suffix, []).append(found.text)
            else:
                raise ContractFailure(
                    did=f"a result on the {name} was written as {suffix}",
                    got=found.text,
                    expected="bytes; a mapping of file names to bytes; or a moseg_core.UsageError"
                    " where the format cannot hold such a shape",
                    fix="encode text: text.encode()",
                ) from found.error
    for suffix, reasons in refusals.items():
        if len(reasons) == len(_WRITTEN):
            raise ContractFailure(
                did=f"results on {len(_WRITTEN)} shapes were written as {suffix}",
                got=f"refusals of all, the last for {reasons[-1]}",
                expected="a file for one of them",
                fix="write meshes, clouds or voxels; refuse only what the format cannot hold",
            )


@check("writer-repeats", kinds=["writer"])
def _repeats(subject: Subject) -> None:
    """Files are compared to see whether a run gave the same; a date in them hides it."""
    for name in _WRITTEN:
        for (suffix, first), (_, second) in zip(
            _written(subject, name), _written(subject, name), strict=True
        ):
            if first != second:
                raise ContractFailure(
                    did=f"a result on the {name} was written as {suffix} twice",
                    got="two different files",
                    expected="equal bytes of equal results",
                    fix="write no dates, no random numbers and no sets in their own order",
                )
