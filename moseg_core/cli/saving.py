"""From a result to all the files that were asked for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from moseg_core.cli.console import message
from moseg_core.errors import MosegError, UsageError
from moseg_core.io.files import files_of, write_files
from moseg_core.io.part_files import PartForm, check_part_form, is_for_parts, part_files
from moseg_core.io.write.formats import check_writable, output_note
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape

#: Files of one output that are listed by name when they were written; of more it is the number.
_LISTED = 3


def check_saving(
    shape: Shape, outputs: Sequence[Path], form: PartForm, *, quiet: bool = False
) -> None:
    """Refuse what a shape cannot be written as, and say what a user should know of the rest.

    Raises
    ------
    UsageError, ShapeError
        A format cannot hold such a shape, or its parts.
    """
    for output in outputs:
        if is_for_parts(output):
            check_part_form(output, shape, form)
            continue
        check_writable(output.suffix, shape)
        if note := output_note(output.suffix, shape):
            message(f"{output.name}: {note}", quiet=quiet)


def save_outputs(
    result: Result, outputs: Sequence[Path], shape: Path, form: PartForm
) -> tuple[list[str], list[MosegError], list[str]]:
    """Write each output; what was written, what went wrong with the others, what is to be said.

    A search may have taken hours: a writer that fails must not take the other files along.
    """
    written: list[str] = []
    failures: list[MosegError] = []
    notes: list[str] = []
    for output in outputs:
        try:
            if is_for_parts(output):
                files, said = part_files(result, output, form)
                notes += [note for note in said if note not in notes]
            else:
                files = files_of(result, output, hull_vertices=form.hull_vertices)
            for file in files:
                if file.exists() and shape.exists() and file.samefile(shape):
                    raise UsageError(f"'{output}' comes with '{file}', which is the shape itself")
            write_files(files)
        except MosegError as error:
            failures.append(error)
        else:
            many = is_for_parts(output) or len(files) > _LISTED
            written += [f"{output} ({len(files)} files)"] if many else map(str, files)
    return written, failures, notes


def raise_last(failures: Sequence[MosegError]) -> None:
    """Say what went wrong, the last by raising it; nothing where nothing did."""
    for failure in failures[:-1]:
        message(str(failure))
    if failures:
        raise failures[-1]
