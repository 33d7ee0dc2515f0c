"""``moseg segment``: the whole method, from files to files."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt

from moseg_core.cli.console import message, others_on_stderr, print_json, progress_reporter
from moseg_core.cli.flags import (
    CheckpointFlags,
    PartFlags,
    SearchedProblemFlags,
    SearchFlags,
    ShapeFlags,
    SteeringFlags,
)
from moseg_core.cli.interrupt import Stop, stop_on_interrupt
from moseg_core.cli.long_run import checkpoint_path, how_to_go_on, keeping_checkpoint
from moseg_core.cli.reading import read_shape
from moseg_core.cli.request import (
    centered,
    partitioned_as,
    read_pins,
    read_search,
    read_start,
    read_statement,
    read_variants,
)
from moseg_core.cli.saving import check_outputs, check_saving, raise_last, save_outputs
from moseg_core.cli.segment_output import next_step, print_tables, summary
from moseg_core.cli.waiting import waiting
from moseg_core.cli.working_folder import working_folder_kept
from moseg_core.clipping.clip import check_clippable
from moseg_core.components.faults import describe
from moseg_core.components.profile import timed
from moseg_core.components.protocols import Centers, Report
from moseg_core.errors import REPORT, MosegError, PluginError, UsageError
from moseg_core.io.part_files import PartForm
from moseg_core.io.result_json import SavedResult
from moseg_core.io.result_loading import load_template
from moseg_core.problem.call_limit import limiting_calls
from moseg_core.problem.label_sets import set_text
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import SearchOptions
from moseg_core.problem.slow_calls import naming_slow_calls
from moseg_core.problem.statement import SEPARATOR, Statement
from moseg_core.problem.variants import Variants
from moseg_core.search.alignment import Alignment, Template, align
from moseg_core.search.clipped_result import check_clipping, clip
from moseg_core.search.number_of_parts import solve_parts
from moseg_core.search.pieces import searched_part
from moseg_core.search.request import check_frozen
from moseg_core.search.result import Result
from moseg_core.search.start_centers import matched_centers
from moseg_core.search.variants import check_variants, solve_variants, tried_sets
from moseg_core.shape.shape import Shape

#: Seconds after which an objective that has not answered is named.
PATIENCE = 10.0


def run_segment(
    path: Path,
    *,
    problem_flags: SearchedProblemFlags,
    reading: ShapeFlags,
    search: SearchFlags,
    steering: SteeringFlags,
    long_run: CheckpointFlags,
    clipped: bool,
    outputs: list[Path],
    part_flags: PartFlags,
    term_timeout: float | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Check everything that can be checked, then read, search, write and print.

    Where the search fails, and files were asked for, these receive the best that it had found.
    """
    task = _asked(problem_flags, search, steering, clipped=clipped)
    form = PartForm(
        close=part_flags.close, hulls=part_flags.hulls, hull_vertices=part_flags.hull_vertices
    )
    labels = [each.problem.labels for each in task.variants.tasks]
    check_outputs(outputs, form, read=[path], labels=labels)
    checkpoint = checkpoint_path(long_run, [path, *outputs])

    started = time.monotonic()
    shape = _readable(path, task, reading, clipped=clipped, quiet=quiet)
    check_saving(shape, outputs, form, quiet=quiet)
    start = _start_on(shape, task, quiet=quiet)
    for note in shape.notes:
        message(f"{path.name}: {note}", quiet=quiet)
    with stop_on_interrupt(wanted=bool(outputs) or checkpoint is not None) as stop:
        with (
            limiting_calls(term_timeout),
            keeping_checkpoint(long_run, checkpoint, quiet=quiet),
        ):
            result, failures = _searched(
                shape, task, start, stop, keep_best=bool(outputs), quiet=quiet
            )
        stop.writing()
        _tell_of_search(result, task, quiet=quiet)
        if clipped:
            result, failed = _with_clipped_boundaries(result, needed=not outputs, quiet=quiet)
            failures += failed
        with timed("stage", "write"):
            written, unwritten, notes = save_outputs(result, outputs, path, form)
    for note in notes:
        message(note, quiet=quiet)
    free, whole = result.dimension
    if free < whole:
        message(f"constraints leave {free} of {whole} dimensions to search", quiet=quiet)
    wrote = f"; wrote {', '.join(written)}" if written else ""
    message(f"{time.monotonic() - started:.1f} s{wrote}", quiet=quiet)
    if checkpoint is not None and result.reason in ("interrupted", "seconds"):
        message(how_to_go_on(checkpoint), quiet=quiet)
    failures = unwritten + failures
    try:
        if as_json:
            print_json(summary(result))
        elif not quiet:
            print_tables(result)
        if not failures and sys.stderr.isatty():
            message(next_step(path, outputs), quiet=quiet)
    finally:  # also where nobody takes what is printed
        raise_last(failures)
        stop.raise_if_asked()


@dataclass(frozen=True, eq=False, kw_only=True)
class _Task:
    """What the options ask for, all of it checked that does not take the shape.

    Parameters
    ----------
    variants : Variants
        The label sets to choose among.
    options : SearchOptions
    parts : tuple of Statement and str, or None
        The statement and its number of parts, where that is open.
    pinned : mapping of str to (k,) int
        Elements by their labels.
    frozen : sequence of str
        Labels whose centres stay.
    earlier : SavedResult or None
        Whose centres the search starts from.
    earlier_path : Path or None
        Its file.
    start : Centers or None
        These centres, if they are taken as they are.
    template : Template or None
        What the earlier result says of another shape, if that is to be laid onto this one.
    """

    variants: Variants
    options: SearchOptions
    parts: tuple[Statement, int | str] | None
    pinned: Mapping[str, npt.ArrayLike]
    frozen: Sequence[str]
    earlier: SavedResult | None
    earlier_path: Path | None
    start: Centers | None
    template: Template | None

    @property
    def problem(self) -> Problem:
        """The problem with the fewest labels, by which shapes are checked."""
        return _smallest(self.variants)


def _smallest(variants: Variants) -> Problem:
    return min((each.problem for each in variants.tasks), key=lambda each: len(each.labels))


def _asked(
    problem_flags: SearchedProblemFlags,
    search: SearchFlags,
    steering: SteeringFlags,
    *,
    clipped: bool,
) -> _Task:
    """What the options ask for.

    Raises
    ------
    UsageError, PluginError
        They contradict each other, or ask for what does not exist.
    """
    _check_one_start(steering)
    if problem_flags.parts is not None:
        _check_unsteered(steering)
    earlier_path = steering.start or steering.start_from
    earlier = read_start(earlier_path)
    pinned = read_pins(steering.pin or [])
    frozen = [name.strip() for name in steering.freeze.split(",")] if steering.freeze else []
    variants = read_variants(problem_flags, start=earlier)
    if len(variants.tasks) > 1:
        variants = _steered(variants, steering, earlier, [*pinned, *frozen])
    options = read_search(search, steering)
    if problem_flags.recipe is None:
        options = partitioned_as(earlier, options)
    check_variants(variants, options)
    if clipped:
        check_clipping(variants.tasks, options)
    problem, start, template, parts = _smallest(variants), None, None, None
    if earlier is not None:
        embedding = earlier.statement.embedding
        start = matched_centers(earlier.names, earlier.centers, problem, embedding=embedding)
    if steering.start_from is not None:
        template = load_template(steering.start_from)
    check_frozen(problem, frozen)
    if problem_flags.parts is not None:
        parts = read_statement(problem_flags), problem_flags.parts
    return _Task(
        variants=variants,
        options=options,
        parts=parts,
        pinned=pinned,
        frozen=frozen,
        earlier=earlier,
        earlier_path=earlier_path,
        start=start,
        template=template,
    )


def _readable(path: Path, task: _Task, reading: ShapeFlags, *, clipped: bool, quiet: bool) -> Shape:
    """The shape, if it can be used with the problem."""
    with timed("stage", "read"):
        shape = read_shape(path, reading, quiet=quiet)
    with waiting(f"looking at {shape.n_elements} {shape.noun}s", quiet=quiet):
        problem = task.problem
        problem.check(problem.embed(searched_part(shape, task.options)))
    if clipped:
        check_clippable(shape)
    return shape


def _start_on(shape: Shape, task: _Task, *, quiet: bool) -> Centers | Alignment | None:
    """Where the search starts on this shape; None where it seeds."""
    if task.template is not None:
        with waiting(f"laying '{task.template.name}' onto '{shape.name}'", quiet=quiet):
            alignment = align(task.template, shape, task.problem)
        message(_how_near(task.template, alignment), quiet=quiet)
        return alignment
    if task.earlier is not None and task.earlier.shape.get("fingerprint") != shape.fingerprint:
        message(
            f"warning: {task.earlier_path} is a result of another shape,"
            f" '{task.earlier.shape.get('name')}'; --start-from lays that onto this one",
            quiet=quiet,
        )
    return task.start


def _searched(
    shape: Shape,
    task: _Task,
    start: Centers | Alignment | None,
    stop: Stop,
    *,
    keep_best: bool,
    quiet: bool,
) -> tuple[Result, list[MosegError]]:
    """The result of the search; or the best that it had found, with the error that ended it.

    Parameters
    ----------
    shape : Shape
    task : _Task
    start : Centers, Alignment or None
    stop : Stop
    keep_best : bool
        Whether a result is of use where the search fails.
    quiet : bool
    """
    slow = partial(_report_slow_call, quiet=quiet)
    with (
        working_folder_kept(),
        progress_reporter(quiet=quiet) as show,
        naming_slow_calls(slow, after=PATIENCE),
        others_on_stderr(),
    ):
        try:
            return _solved(shape, task, start, lambda progress: show(progress) or stop()), []
        except MosegError as error:
            if error.result is None or not keep_best:
                raise
            return error.result, [error]
        except SystemExit as error:  # of code that no component's call is around
            raise PluginError(
                f"a component ended the search: {describe(error)}; {REPORT}"
            ) from error


def _solved(shape: Shape, task: _Task, start: Centers | Alignment | None, report: Report) -> Result:
    """Search for the parts, or for their number too."""
    if task.parts is not None:
        statement, number = task.parts
        return solve_parts(shape, statement, number, task.options, report=report)
    return solve_variants(
        shape,
        task.variants,
        task.options,
        start=start,
        freeze=task.frozen,
        pins=task.pinned,
        report=report,
    )


def _tell_of_search(result: Result, task: _Task, *, quiet: bool) -> None:
    """Tell what a user should know of a result, and which labels it has where these were open."""
    for warning in result.warnings:
        message(f"warning: {warning}", quiet=quiet)
    if sets := tried_sets(result.history):
        wholes = [name.partition(SEPARATOR)[0] for name in result.problem.labels]
        chosen = set_text(wholes, task.variants.statement.labels)
        message(f"chosen among {len(sets)} label sets: {chosen}", quiet=quiet)


def _with_clipped_boundaries(
    result: Result, *, needed: bool, quiet: bool
) -> tuple[Result, list[MosegError]]:
    """A result with boundaries that cut faces; where that fails, as it was, with the error.

    Parameters
    ----------
    result : Result
    needed : bool
        Whether it is of no use without.
    quiet : bool
    """
    try:
        with working_folder_kept(), timed("stage", "clip"):
            clipped = clip(result)
    except MosegError as error:
        if needed:
            raise
        return result, [MosegError(f"{error}; written without clipped boundaries")]
    message(_clipping_summary(clipped), quiet=quiet)
    return clipped, []


def _check_one_start(steering: SteeringFlags) -> None:
    """Refuse several places to begin at."""
    given = [
        option
        for option, value in (
            ("--start", steering.start),
            ("--start-from", steering.start_from),
            ("--centers", steering.centers),
        )
        if value is not None
    ]
    if len(given) > 1:
        raise UsageError(f"{' and '.join(given)} both say where to begin; give one of them")


def _how_near(template: Template, alignment: Alignment) -> str:
    """How an earlier shape was laid onto this one."""
    similarity = alignment.similarity
    return (
        f"'{template.name}' is laid onto it, {similarity.scale:.3g} times as large; the surfaces"
        f" are {100 * similarity.distance:.2g} % of the diagonal apart"
    )


def _steered(
    variants: Variants, steering: SteeringFlags, earlier: SavedResult | None, named: list[str]
) -> Variants:
    """The label sets that have the labels which are steered, and no others where all must be."""
    if earlier is not None:
        option = "--start" if steering.start_from is None else "--start-from"
        variants = variants.having(earlier.names, option, exactly=True)
    if steering.centers is not None:
        variants = variants.having(centered(steering.centers), "--centers", exactly=True)
    return variants.having(named, "--pin and --freeze") if named else variants


def _check_unsteered(steering: SteeringFlags) -> None:
    """Refuse what speaks of single labels where these get their numbers after the search."""
    for option, given in (
        ("--centers", steering.centers),
        ("--start", steering.start),
        ("--start-from", steering.start_from),
        ("--pin", steering.pin),
        ("--freeze", steering.freeze),
    ):
        if given:
            raise UsageError(
                f"{option} speaks of single labels, but with --parts these get their numbers at the"
                f" end, by size; give --labels and --minimize, or a recipe with fixed labels"
            )


def _report_slow_call(what: str, seconds: float, *, quiet: bool) -> None:
    message(f"waiting for {what}, {seconds:.0f} s so far", quiet=quiet)


def _clipping_summary(result: Result) -> str:
    """How much was clipped."""
    assert result.clipped is not None  # clipped results only
    pieces = np.bincount(result.clipped.source, minlength=result.shape.n_elements)
    cut = pieces > 1
    return f"clipped {cut.sum()} faces into {pieces[cut].sum()}"
