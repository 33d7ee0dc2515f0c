"""``moseg segment``: the whole method, from files to files."""

from __future__ import annotations

import shlex
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from moseg_core.cli.console import (
    console,
    message,
    others_on_stderr,
    print_json,
    print_terms,
    progress_reporter,
)
from moseg_core.cli.flags import (
    CheckpointFlags,
    PartFlags,
    SearchedProblemFlags,
    SearchFlags,
    ShapeFlags,
    SteeringFlags,
)
from moseg_core.cli.interrupt import stop_on_interrupt
from moseg_core.cli.long_run import checkpoint_path, how_to_go_on, keeping_checkpoint
from moseg_core.cli.reading import read_shape
from moseg_core.cli.request import (
    centered,
    read_pins,
    read_search,
    read_start,
    read_statement,
    read_variants,
)
from moseg_core.cli.saving import check_outputs, check_saving, raise_last, save_outputs
from moseg_core.cli.waiting import waiting
from moseg_core.cli.working_folder import working_folder_kept
from moseg_core.clipping.clip import check_clippable
from moseg_core.components.faults import describe
from moseg_core.components.profile import timed
from moseg_core.components.protocols import Centers
from moseg_core.errors import REPORT, MosegError, PluginError, UsageError
from moseg_core.io.part_files import PartForm
from moseg_core.io.result_json import SavedResult, evaluation_document
from moseg_core.io.result_loading import load_template
from moseg_core.problem.call_limit import limiting_calls
from moseg_core.problem.label_sets import set_text
from moseg_core.problem.slow_calls import naming_slow_calls
from moseg_core.problem.statement import SEPARATOR
from moseg_core.problem.variants import Variants
from moseg_core.search.alignment import Alignment, Template, align
from moseg_core.search.clipped_result import check_components, clip
from moseg_core.search.number_of_parts import TRIED, solve_parts
from moseg_core.search.pieces import searched_part
from moseg_core.search.result import Result
from moseg_core.search.segment import check_frozen, matched_centers, prepare_components
from moseg_core.search.variants import check_variants, solve_variants, tried_sets

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
    _check_one_start(steering)
    if problem_flags.parts is not None:
        _check_unsteered(steering)
    earlier = read_start(steering.start or steering.start_from)
    pinned = read_pins(steering.pin or [])
    frozen = [name.strip() for name in steering.freeze.split(",")] if steering.freeze else []
    variants = read_variants(problem_flags, start=earlier)
    if len(variants.tasks) > 1:
        variants = _steered(variants, steering, earlier, [*pinned, *frozen])
    task = min(variants.tasks, key=lambda task: len(task.problem.labels))
    problem = task.problem
    options = read_search(search, steering)
    if earlier is not None and problem_flags.recipe is None and options.parameterization is None:
        # Its centres are those of its own parameterization.
        options = replace(options, parameterization=earlier.search().parameterization)
    check_variants(variants, options)
    if clipped:
        for each in variants.tasks:
            check_components(prepare_components(each.problem, options.settled(each.search)))
            if each.children:
                raise UsageError("boundaries can be clipped for results of one level only, so far")
    start: Centers | Alignment | None = None
    if earlier is not None:
        start = matched_centers(
            earlier.names, earlier.centers, problem, embedding=earlier.statement.embedding
        )
    template = None
    if earlier is not None and steering.start_from is not None:
        template = load_template(steering.start_from)
    check_frozen(problem, frozen)
    form = PartForm(
        close=part_flags.close, hulls=part_flags.hulls, hull_vertices=part_flags.hull_vertices
    )
    labels = [each.problem.labels for each in variants.tasks]
    check_outputs(outputs, form, read=[path], labels=labels)
    checkpoint = checkpoint_path(long_run, [path, *outputs])

    started = time.monotonic()
    with timed("stage", "read"):
        shape = read_shape(path, reading, quiet=quiet)
    with waiting(f"looking at {shape.n_elements} {shape.noun}s", quiet=quiet):
        problem.check(problem.embed(searched_part(shape, options)))
    if clipped:
        check_clippable(shape)
    check_saving(shape, outputs, form, quiet=quiet)
    if template is not None:
        with waiting(f"laying '{template.name}' onto '{shape.name}'", quiet=quiet):
            start = align(template, shape, problem)
        message(_how_near(template, start), quiet=quiet)
    elif earlier is not None and earlier.shape.get("fingerprint") != shape.fingerprint:
        message(
            f"warning: {steering.start} is a result of another shape,"
            f" '{earlier.shape.get('name')}'; --start-from lays that onto this one",
            quiet=quiet,
        )
    for note in shape.notes:
        message(f"{path.name}: {note}", quiet=quiet)
    failed: list[MosegError] = []
    with stop_on_interrupt(wanted=bool(outputs) or checkpoint is not None) as stop:
        with (
            working_folder_kept(),
            progress_reporter(quiet=quiet) as show,
            naming_slow_calls(partial(_report_slow_call, quiet=quiet), after=PATIENCE),
            limiting_calls(term_timeout),
            others_on_stderr(),
            keeping_checkpoint(long_run, checkpoint, quiet=quiet),
        ):
            try:
                if problem_flags.parts is not None:
                    result = solve_parts(
                        shape,
                        read_statement(problem_flags),
                        problem_flags.parts,
                        options,
                        report=lambda progress: show(progress) or stop(),
                    )
                else:
                    result = solve_variants(
                        shape,
                        variants,
                        options,
                        start=start,
                        freeze=frozen,
                        pins=pinned,
                        report=lambda progress: show(progress) or stop(),
                    )
            except MosegError as error:
                if error.result is None or not outputs:
                    raise
                result = error.result
                failed.append(error)
            except SystemExit as error:  # of code that no component's call is around
                raise PluginError(
                    f"a component ended the search: {describe(error)}; {REPORT}"
                ) from error
        stop.writing()
        for warning in result.warnings:
            message(f"warning: {warning}", quiet=quiet)
        if sets := tried_sets(result.history):
            wholes = [name.partition(SEPARATOR)[0] for name in result.problem.labels]
            chosen = set_text(wholes, variants.statement.labels)
            message(f"chosen among {len(sets)} label sets: {chosen}", quiet=quiet)
        if clipped:
            try:
                with working_folder_kept(), timed("stage", "clip"):
                    result = clip(result)
                message(_clipping_summary(result), quiet=quiet)
            except MosegError as error:  # the result is good without
                if not outputs:
                    raise
                failed.append(MosegError(f"{error}; written without clipped boundaries"))
        with timed("stage", "write"):
            written, failures, notes = save_outputs(result, outputs, path, form)
    for note in notes:
        message(note, quiet=quiet)
    free, whole = result.dimension
    if free < whole:
        message(f"constraints leave {free} of {whole} dimensions to search", quiet=quiet)
    wrote = f"; wrote {', '.join(written)}" if written else ""
    message(f"{time.monotonic() - started:.1f} s{wrote}", quiet=quiet)
    if checkpoint is not None and result.reason in ("interrupted", "seconds"):
        message(how_to_go_on(checkpoint), quiet=quiet)
    failures += failed
    try:
        if as_json:
            print_json(_summary(result))
        elif not quiet:
            _print_tables(result)
        if not failures and sys.stderr.isatty():
            message(next_step(path, outputs), quiet=quiet)
    finally:  # also where nobody takes what is printed
        raise_last(failures)
        stop.raise_if_asked()


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


def next_step(shape: Path, written: Sequence[Path]) -> str:
    """What a user may do next with the files that were written; logs need not know.

    Examples
    --------
    >>> next_step(Path("horse.off"), [Path("a.glb"), Path("horse.json")])
    'next: moseg view horse.off horse.json; moseg explain horse.json'
    >>> next_step(Path("horse.off"), [Path("a.png")])
    'next: with -o result.json the result is kept, to be looked at, explained and gone on from'
    """
    kept = next((file for file in written if file.suffix.lower() == ".json"), None)
    if kept is None:
        return (
            "next: with -o result.json the result is kept, to be looked at, explained and gone on"
            " from"
        )
    result = shlex.quote(str(kept))
    return f"next: moseg view {shlex.quote(str(shape))} {result}; moseg explain {result}"


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


def _summary(result: Result) -> dict[str, Any]:
    return {
        "shape": result.shape.name,
        "elements": result.shape.n_elements,
        **evaluation_document(result.evaluation),
        "parts": [
            {
                "label": name,
                "elements": part.n_elements,
                "area_share": part.area / result.shape.area,
            }
            for name, part in result.parts.items()
        ],
        "dimension": {"free": result.dimension[0], "all": result.dimension[1]},
        **({"numbers": list(result.history[TRIED])} if TRIED in result.history else {}),
        **({"label_sets": sets} if (sets := tried_sets(result.history)) else {}),
        "seed": result.seed,
        "reason": result.reason,
        "warnings": list(result.warnings),
    }


def _sets_table(sets: Mapping[str, Mapping[str, float]]) -> Table:
    """What each label set that was tried came to."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("labels", overflow="fold")
    for heading in ("typical cost", "cost", "empty", ""):
        table.add_column(heading, justify="right")
    for text, record in sets.items():
        empty = f"{record['empty']}" if record["empty"] else ""
        brief = "" if record.get("finalist", 1) else "brief search"
        costs = [f"{record[key]:.6f}" for key in ("typical cost", "cost")]
        table.add_row(text, *costs, empty, brief)
    return table


def _numbers_table(records: Sequence[Mapping[str, float]]) -> Table:
    """What each number of parts that was tried came to."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("number of parts", "cost", "empty"):
        table.add_column(heading, justify="right")
    for record in records:
        empty = f"{record['empty']}" if record["empty"] else ""
        table.add_row(f"{record['parts']}", f"{record['cost']:.6f}", empty)
    return table


def _print_tables(result: Result) -> None:
    out = console(sys.stdout)
    if TRIED in result.history:
        out.print(_numbers_table(result.history[TRIED]))
        out.print()
    if sets := tried_sets(result.history):
        out.print(_sets_table(sets))
        out.print()
    parts = Table(box=None, pad_edge=False, header_style="bold")
    parts.add_column("part")
    parts.add_column(f"{result.shape.noun}s", justify="right")
    parts.add_column("volume" if result.shape.solid else "area", justify="right")
    for name, part in result.parts.items():
        share = part.area / result.shape.area
        parts.add_row(name, str(part.n_elements), f"{100 * share:.1f} %")
    out.print(parts)
    out.print()
    print_terms(result.evaluation)
