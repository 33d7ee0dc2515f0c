"""From a result to all the files that were asked for.

A search may have taken hours, so that nothing may be lost at its last step. Before it, every file's
folder is tried and every writer imported (:func:`check_outputs`). After it all files are tried,
whatever happens to one of them, those of the core's own writers first (:func:`save_outputs`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from moseg_core.cli.console import message
from moseg_core.cli.working_folder import working_folder_kept
from moseg_core.components.faults import describe
from moseg_core.errors import MosegError, UsageError
from moseg_core.io.files import check_any_output, check_form, files_of, write_files, writer_for
from moseg_core.io.part_files import (
    PartForm,
    check_part_form,
    is_for_parts,
    part_files,
    part_paths,
)
from moseg_core.io.whole_file import check_destination, identity, is_stream, same_file
from moseg_core.io.write.formats import check_writable, output_note
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape

#: Files of one output that are listed by name when they were written; of more it is the number.
_LISTED = 3


def check_outputs(
    outputs: Sequence[Path],
    form: PartForm,
    *,
    read: Iterable[Path],
    labels: Iterable[Sequence[str]] = (),
) -> None:
    """Refuse outputs that could not be written, now rather than after the search.

    Parameters
    ----------
    outputs : sequence of Path
    form : PartForm
    read : iterable of Path
        Files that are not to be written over.
    labels : iterable of sequences of str
        What parts may be called, as far as it is known: for the names of their files.

    Raises
    ------
    MosegError
        No writer, or one that cannot be imported; no such folder, or one that takes no files; two
        outputs that are one file.
    """
    check_form(form, outputs)
    sets = list(labels)
    files: list[Path] = []
    for output in outputs:
        check_any_output(output)
        named = [output]
        if is_for_parts(output):
            named = list(dict.fromkeys(file for each in sets for file in part_paths(output, each)))
            if named and output.parent.is_dir():
                check_destination(max(named, key=lambda file: len(file.name.encode())))
        files += named
    check_distinct(files, read=read)


def check_distinct(
    outputs: Iterable[Path], *, read: Iterable[Path], what: str = "the result"
) -> None:
    """Refuse files that are read as well, or of which two are one.

    Parameters
    ----------
    outputs, read : iterable of Path
    what : str
        What is written, for the message.

    Raises
    ------
    UsageError
        With their names.
    """
    used = {identity(source) for source in read}
    known: dict[object, Path] = {}
    for output in outputs:
        mark = identity(output)
        if mark is None:
            continue
        if mark in used:
            raise UsageError(f"'{output}' is read here; write {what} to another file")
        if mark in known:
            two = f"'{output}' is given twice" if known[mark] == output else ""
            two = two or f"'{known[mark]}' and '{output}' are one file"
            raise UsageError(f"{two}; give every output a name of its own")
        known[mark] = output


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

    Parameters
    ----------
    result : Result
    outputs : sequence of Path
        Written in the order of what may happen: first what the core's own writers make, then what
        bundles make, at last pipes, which wait for a reader.
    shape : Path
        Of the shape, which is not written over.
    form : PartForm
    """
    written: list[str] = []
    failures: list[MosegError] = []
    notes: list[str] = []
    for output in sorted(outputs, key=lambda each: (is_stream(each), not _by_core(each))):
        try:
            with working_folder_kept():
                files, said = _files(result, output, form)
            notes += [note for note in said if note not in notes]
            for file in files:
                if same_file(file, shape):
                    raise UsageError(f"'{output}' comes with '{file}', which is the shape itself")
            write_files(files)
        except MosegError as error:
            failures.append(error)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # noqa: BLE001  # strangers decide what they raise here
            failures.append(MosegError(f"cannot write '{output}': {describe(error)}"))
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


def _files(result: Result, output: Path, form: PartForm) -> tuple[dict[Path, bytes], list[str]]:
    """The files of an output with their contents, and what a user should know."""
    if is_for_parts(output):
        return part_files(result, output, form)
    return files_of(result, output, hull_vertices=form.hull_vertices), []


def _by_core(output: Path) -> bool:
    """Whether an output is the core's to make, not a bundle's."""
    try:
        return is_for_parts(output) or writer_for(output).bundle == "core"
    except MosegError:  # told when it is tried
        return False
