"""``moseg measure``: a table of what parts measure, of one shape or of many.

A word of the command line is a saved result, a shape with its labels, a shape that bears labels
itself, or, where a recipe says what to look for, a shape that is segmented first. One that fails is
named and the others go on: of a hundred scans two are broken as a rule, and whoever has waited for
ninety-eight wants these.
"""

from __future__ import annotations

import os
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from rich.table import Table

from moseg_core.batching.jobs import shape_stem
from moseg_core.batching.ledger import is_batch, results_in
from moseg_core.cli.console import console, message, progress_reporter
from moseg_core.cli.flags import SearchedProblemFlags, SearchFlags, ShapeFlags, SteeringFlags
from moseg_core.cli.interrupt import Stop, stop_on_interrupt
from moseg_core.cli.reading import limits_of, named_labels, read_label_property, read_shape
from moseg_core.cli.request import read_search, read_statement, read_variants
from moseg_core.cli.saving import check_distinct, raise_last
from moseg_core.cli.working_folder import working_folder_kept
from moseg_core.components.discovery.registry import registry
from moseg_core.components.protocols import Progress
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import MosegError, ShapeError, UsageError
from moseg_core.io import read_labels, read_result, write_file
from moseg_core.io.byte_names import readable
from moseg_core.io.files import files_of, instead_of, write_files
from moseg_core.io.labels.reading import bearing_suffixes
from moseg_core.io.read.limits import ReadLimits
from moseg_core.io.result_loading import check_shape, find_shape, measure_saved
from moseg_core.io.whole_file import check_destination
from moseg_core.problem.settings import SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants
from moseg_core.search.number_of_parts import solve_parts
from moseg_core.search.part_measures import measure_parts
from moseg_core.search.part_table import Cell, PartTable, shown
from moseg_core.search.result import Result
from moseg_core.search.variants import check_variants, solve_variants
from moseg_core.shape.shape import Shape
from moseg_core.untrusted.terminal import printable_json

FORMATS = (".csv", ".tsv", ".json")
#: Of a table on the terminal: what there is room for.
_SHOWN = ("elements", "area", "share", "closed_volume", "length", "width", "height", "pieces")


@dataclass(frozen=True, kw_only=True)
class Finder:
    """How shapes without labels are cut into parts.

    Parameters
    ----------
    statement : Statement
    variants : Variants
        The same with its names looked up.
    number : str or None
        How many parts there are, as ``--parts`` says it.
    options : SearchOptions
    """

    statement: Statement
    variants: Variants
    number: str | None
    options: SearchOptions

    @classmethod
    def of(cls, problem: SearchedProblemFlags, search: SearchFlags) -> Finder | None:
        """What the options ask for; None where they ask for nothing."""
        if not problem.anything:
            return None
        found = cls(
            statement=read_statement(problem),
            variants=read_variants(problem),
            number=problem.parts,
            options=read_search(search, SteeringFlags()),
        )
        check_variants(found.variants, found.options)
        return found

    def find(self, shape: Shape, *, stop: Callable[[], bool], quiet: bool) -> Result:
        """The parts of a shape."""
        with working_folder_kept(), progress_reporter(quiet=quiet) as show:

            def report(progress: Progress) -> bool:
                return show(progress) or stop()

            if self.number is None:
                return solve_variants(shape, self.variants, self.options, report=report)
            return solve_parts(shape, self.statement, self.number, self.options, report=report)


def run_measure(
    words: Sequence[str],
    *,
    problem: SearchedProblemFlags,
    reading: ShapeFlags,
    search: SearchFlags,
    shapes: Path | None,
    label_property: str | None,
    keep: Path | None,
    outputs: Sequence[Path],
    as_json: bool,
    quiet: bool,
) -> None:
    """Measure what every word stands for; write the table, or print it.

    Raises
    ------
    MosegError
        Something failed; after the table of the others was written.
    """
    if not words:
        raise UsageError(
            "there is nothing to measure; give results (.json), SHAPE=LABELS, or shapes and a"
            " --recipe"
        )
    words = [file for word in words for file in _of_batch(word)]
    for output in outputs:
        if output.suffix.lower() not in FORMATS:
            raise UsageError(f"a table is written as {', '.join(FORMATS)}, not to '{output}'")
        check_destination(output)
    check_distinct(outputs, read=map(Path, words), what="the table")
    finder = Finder.of(problem, search)
    if keep is not None:
        _check_kept(keep, words, finder)
    unkept: list[str] = []
    measure = partial(
        _measured,
        finder=finder,
        reading=reading,
        folders=[] if shapes is None else [shapes],
        label_property=read_label_property(label_property),
        keep=keep,
        unkept=unkept,
        quiet=quiet,
    )
    tables: list[PartTable] = []
    failed: list[str] = []
    wanted = bool(outputs) or keep is not None or len(words) > 1
    with stop_on_interrupt(wanted=wanted) as stop:
        for k, word in enumerate(words, 1):
            if stop():
                break
            began = time.monotonic()
            try:
                with working_folder_kept():
                    table = measure(word, stop=stop)
            except MosegError as error:
                if len(words) == 1:
                    raise
                failed.append(word)
                message(f"[{k}/{len(words)}] {word}: {error}")
                continue
            tables.append(table.with_column("file", readable(word)))
            seconds = time.monotonic() - began
            said = f"[{k}/{len(words)}] {word}: {len(table)} parts, {seconds:.1f} s"
            message(said, quiet=quiet or len(words) == 1)
        stop.writing()
        whole = PartTable.joined(tables)
        failures: list[MosegError] = []
        for output in outputs if tables else ():
            try:
                write_file(output, encoded(whole, output.suffix))
            except MosegError as error:
                failures.append(error)
                continue
            count = f"{len(whole)} parts of {len(tables)} shape{'s' if len(tables) > 1 else ''}"
            message(f"wrote {output}: {count}, {len(whole.columns)} columns", quiet=quiet)
    if unkept:
        said = f"the results of {len(unkept)} could not be kept: {', '.join(unkept)}"
        failures.append(MosegError(said))
    if failed:
        said = f"{len(failed)} of {len(words)} could not be measured: {', '.join(failed)}"
        failures.append(MosegError(said))
    try:
        if as_json:
            print(printable_json(whole.to_json()), end="")
        elif tables and not outputs:
            console(sys.stdout).print(_printed(whole))
    finally:  # also where nobody takes what is printed
        stop.raise_if_asked()
        raise_last(failures)


def encoded(table: PartTable, suffix: str) -> bytes:
    r"""The table as the contents of a file.

    Parameters
    ----------
    table : PartTable
    suffix : {".csv", ".tsv", ".json"}

    Examples
    --------
    >>> encoded(PartTable(columns=("part",), cells=(("leg",),)), ".tsv")
    b'part\r\nleg\r\n'
    """
    if suffix.lower() == ".json":
        return table.to_json().encode()
    return table.to_csv(delimiter="\t" if suffix.lower() == ".tsv" else ",").encode()


def _measured(
    word: str,
    *,
    finder: Finder | None,
    reading: ShapeFlags,
    folders: Sequence[Path],
    label_property: Sequence[str],
    keep: Path | None,
    unkept: list[str],
    quiet: bool,
    stop: Stop,
) -> PartTable:
    """The table of what one word stands for; a result that could not be kept is added to them."""
    path, labels = _files(word, finder)
    saved = path.suffix.lower() == ".json"
    for file in (labels, path if saved else None):  # of shapes whoever reads them says more
        if file is not None and not os.path.exists(file):
            raise ShapeError(f"'{file}' does not exist{instead_of(file)}")
    if saved:
        return _of_result(path, reading, folders)
    shape = read_shape(path, reading)
    for note in shape.notes:
        message(f"{path.name}: {note}", quiet=quiet)
    if labels is not None:
        try:
            return _of_labels(labels, shape, label_property, limits_of(reading), quiet=quiet)
        except (ShapeError, UsageError):
            if finder is None or labels != path:
                raise
    assert finder is not None  # or there would be labels
    failure: MosegError | None = None
    try:
        result = finder.find(shape, stop=stop, quiet=quiet)
    except MosegError as error:
        if keep is None or error.result is None:
            raise
        result, failure = error.result, error
    for warning in result.warnings:
        message(f"{path.name}: warning: {warning}", quiet=quiet)
    if keep is not None:
        try:
            write_files(files_of(result, keep / f"{shape_stem(path)}.json"))
        except MosegError as error:  # its row of the table is there all the same
            message(f"{path.name}: {error}")
            unkept.append(word)
    if failure is not None:
        raise failure
    return result.table()


def _of_batch(word: str) -> list[str]:
    """The results of a batch, where a word is its folder; else the word."""
    folder = Path(word)
    return [str(file) for file in results_in(folder)] if is_batch(folder) else [word]


def _files(word: str, finder: Finder | None) -> tuple[Path, Path | None]:
    """A shape and its labels, the same file where it may bear them, or none where it cannot."""
    whole = Path(word)
    if "=" in word and not os.path.exists(whole):  # a file may have the sign in its name
        shape, _, labels = word.rpartition("=")
        if not shape or not labels:
            raise UsageError(f"'{word}' is not understood; write SHAPE=LABELS")
        return Path(shape), Path(labels)
    if whole.suffix.lower() == ".json":
        return whole, None
    # Groups and nodes of a model are no parts where others are to be found.
    bearing = bearing_suffixes() if finder is None else (".ply",)
    if whole.name.lower().endswith(bearing):
        return whole, whole
    if finder is None:
        raise UsageError(
            f"'{word}' has no labels; give {word}=LABELS, or say what to look for: --recipe NAME"
        )
    return whole, None


def _of_result(path: Path, reading: ShapeFlags, folders: Sequence[Path]) -> PartTable:
    """The parts of a saved result."""
    saved = read_result(path)
    shape = find_shape(saved, path, folders=folders, read=lambda file: read_shape(file, reading))
    check_shape(saved, path, shape)
    return measure_saved(saved, shape)


def _of_labels(
    path: Path,
    shape: Shape,
    label_property: Sequence[str],
    limits: ReadLimits,
    *,
    quiet: bool,
) -> PartTable:
    """The parts of a labelled shape; what has no label is no part."""
    labelling = read_labels(path, shape, label_property=label_property, limits=limits)
    for note in labelling.notes:
        message(note, quiet=quiet)
    labels, names = named_labels(labelling)
    rest = len(names)
    whole = Segmentation.from_labels(shape, np.where(labels < 0, rest, labels), rest + 1)
    table = measure_parts(whole, [*names, ""], source=registry())
    table = replace(table, cells=table.cells[:rest])
    if several := [f"{row['part']} ({row['pieces']})" for row in table if _several(row)]:
        message(
            f"{path.name}: in several pieces, each measured as one part: {', '.join(several)}; for"
            f" a row each give the pieces names of their own",
            quiet=quiet,
        )
    return table


def _several(row: Mapping[str, Cell]) -> bool:
    """Whether a part is in several pieces."""
    pieces = row["pieces"]
    return isinstance(pieces, int) and pieces > 1


def _check_kept(folder: Path, words: Sequence[str], finder: Finder | None) -> None:
    """Refuse a folder for results that cannot be, before anything is searched."""
    if finder is None:
        raise UsageError("--keep keeps what is found; say what to look for: --recipe NAME")
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"--keep '{folder}' is a file; give a folder")
    if not folder.parent.is_dir():
        raise UsageError(f"--keep '{folder}': there is no folder '{folder.parent}'")
    paths = [path for path, labels in (_files(w, finder) for w in words) if labels in (None, path)]
    stems = Counter(shape_stem(path).lower() for path in paths if path.suffix.lower() != ".json")
    twice = [stem for stem, count in stems.items() if count > 1]
    if twice:
        raise UsageError(
            f"--keep: several shapes are called '{twice[0]}', and their results would be one file;"
            f" measure them one after the other, with folders of their own"
        )
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise UsageError(f"--keep: '{folder}' cannot be made: {error.strerror}") from error
    for path in paths:
        if path.suffix.lower() != ".json":
            check_destination(folder / f"{shape_stem(path)}.json")


def _printed(table: PartTable) -> Table:
    """The most of a table that a terminal has room for."""
    printed = Table(box=None, pad_edge=False, header_style="bold")
    several = len({row["file"] for row in table}) > 1
    for name in ("shape", "part") if several else ("part",):
        printed.add_column(name)
    for name in _SHOWN:
        printed.add_column(name, justify="right")
    for row in table:
        texts = [str(row["shape"]), str(row["part"])] if several else [str(row["part"])]
        printed.add_row(*texts, *(shown(row[name]) for name in _SHOWN))
    return printed
