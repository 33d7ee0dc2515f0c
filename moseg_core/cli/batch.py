"""``moseg batch``: many shapes, each in a guarded process of its own.

What the options ask for becomes :class:`~moseg_core.batching.instructions.Instructions`, and the
driver (:mod:`moseg_core.batching.driver`) does the rest. Here is what people see of it: a bar with
counts, a line for each failure as it comes, and at the end a table of what became of all.

The first Ctrl-C, or SIGTERM, lets the shapes at work be finished and begins no others; the second
ends these too. Either way, and even after ``kill -9``, ``--resume`` goes on where the batch was.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, TextColumn
from rich.progress import Progress as Bars
from rich.table import Table

from moseg_core.batching.cluster import cluster_executor
from moseg_core.batching.driver import BatchReport, Limits, run_batch
from moseg_core.batching.instructions import EarlierResult, Instructions
from moseg_core.batching.jobs import PLACE
from moseg_core.batching.outcome import BatchProgress, BatchResult
from moseg_core.cli.console import console, message, print_json
from moseg_core.cli.flags import (
    BatchFlags,
    PartFlags,
    SearchedProblemFlags,
    SearchFlags,
    ShapeFlags,
    SteeringFlags,
)
from moseg_core.cli.interrupt import stop_on_interrupt
from moseg_core.cli.reading import reading_of
from moseg_core.cli.request import (
    partitioned_as,
    read_search,
    read_start,
    read_statement,
    read_variants,
)
from moseg_core.components.discovery.registry import registry
from moseg_core.errors import MosegError, UsageError
from moseg_core.io.part_files import PartForm

#: Failures that the table at the end lists; the ledger has all.
_LISTED = 20
#: Characters of a failure that the table shows.
_LONGEST = 160
#: Seconds between two lines of progress off a terminal.
_LINE_EVERY = 30.0


def run_batch_command(
    shapes: Sequence[str],
    *,
    problem_flags: SearchedProblemFlags,
    reading: ShapeFlags,
    search: SearchFlags,
    limits: BatchFlags,
    clipped: bool,
    outputs: Sequence[Path],
    part_flags: PartFlags,
    as_json: bool,
    quiet: bool,
) -> None:
    """Check what can be checked, do the batch, and print what became of each shape.

    Raises
    ------
    MosegError
        Some shapes have failed; all others were done.
    """
    folder, templates = read_outputs(outputs)
    form = PartForm(
        close=part_flags.close, hulls=part_flags.hulls, hull_vertices=part_flags.hull_vertices
    )
    instructions = read_instructions(
        problem_flags, reading, search, limits, clip=clipped, form=form
    )
    if limits.scheduler is not None and search.workers is not None:
        raise UsageError("--workers is for this computer; with --scheduler the cluster has its own")
    began = time.monotonic()
    with (
        executor_at(limits.scheduler, search.workers) as (executor, workers),
        progress_of_batch(quiet=quiet) as show,
        stop_on_interrupt(wanted=True, finishing="the shapes at work") as stop,
    ):
        try:
            result = run_batch(
                shapes,
                instructions,
                folder,
                templates=templates,
                limits=Limits(timeout=limits.timeout, memory=limits.memory),
                workers=workers,
                resume=limits.resume or limits.retry_failed,
                retry_failed=limits.retry_failed,
                executor=executor,
                report=lambda progress: show(progress) or stop(),
                page=limits.report,
            )
        except KeyboardInterrupt:
            message("what was done is kept; go on with --resume", quiet=quiet)
            raise
    message(f"{time.monotonic() - began:.1f} s; results and ledger are in '{folder}'", quiet=quiet)
    if result.page is not None:
        message(f"wrote {result.page}", quiet=quiet)
    if as_json:
        print_json(summary(result))
    elif not quiet:
        print_outcomes(result)
    if stop():
        message(what_is_left(result, page=limits.report), quiet=quiet)
        raise stop.ended()
    if result.failed:
        raise MosegError(
            f"{len(result.failed)} of {result.total} shapes failed; --retry-failed does these again"
        )


@contextmanager
def executor_at(
    scheduler: str | None, workers: int | None
) -> Iterator[tuple[Executor | None, int | None]]:
    """Where jobs are done, and how many at a time: a cluster, or None for this computer."""
    if scheduler is None:
        yield None, workers
        return
    with cluster_executor(scheduler) as (executor, count):
        yield executor, count


def read_outputs(outputs: Sequence[Path]) -> tuple[Path, list[str]]:
    """The folder of a batch, and the paths of further files, which have ``{shape}`` in them.

    Raises
    ------
    UsageError
        No folder, or several; a file that would be one for all shapes.

    Examples
    --------
    >>> read_outputs([Path("out"), Path("out/{shape}.glb")])
    (PosixPath('out'), ['out/{shape}.glb'])
    """
    templates = [str(output) for output in outputs if PLACE in str(output)]
    folders = [output for output in outputs if PLACE not in str(output)]
    suffixes = registry().suffixes("writer")
    for folder in folders:
        if folder.suffix.lower() in suffixes and not folder.is_dir():
            raise UsageError(
                f"'-o {folder}' would be one file for all shapes; give a folder for the results,"
                f" such as -o out, and further files as -o 'out/{PLACE}{folder.suffix}'"
            )
    if len(folders) != 1:
        asked = "say where: " if not folders else "give one folder, not several: "
        raise UsageError(
            f"{asked}-o FOLDER is for the results and the ledger of the batch, and -o"
            f" 'FOLDER/{PLACE}.glb' for further files"
        )
    return folders[0], templates


def read_instructions(
    problem_flags: SearchedProblemFlags,
    reading: ShapeFlags,
    search: SearchFlags,
    limits: BatchFlags,
    *,
    clip: bool,
    form: PartForm,
) -> Instructions:
    """What the options ask to be done with each shape.

    Raises
    ------
    UsageError
        As for :func:`moseg_core.cli.request.read_variants`.
    """
    earlier, options = read_start(limits.start_from), read_search(search, SteeringFlags())
    if problem_flags.recipe is None:
        options = partitioned_as(earlier, options)
    more: dict[str, Any] = {
        "options": options,
        "reading": reading_of(reading),
        "clip": clip,
        "form": form,
        "start_from": limits.start_from and EarlierResult.at(limits.start_from),
        "term_timeout": limits.term_timeout,
    }
    variants = read_variants(problem_flags, start=earlier)
    if problem_flags.parts is not None:
        statement = read_statement(problem_flags)
        return Instructions(statement=statement, n_parts=problem_flags.parts, **more)
    sets = tuple(task.problem.labels for task in variants.tasks)
    return Instructions(
        statement=variants.statement, sets=sets if variants.statement.has_counts else None, **more
    )


def summary(result: BatchResult) -> dict[str, Any]:
    """What became of a batch, as plain data."""
    return {
        "folder": str(result.folder),
        "shapes": result.total,
        "counts": result.counts,
        "outcomes": [outcome.document() for outcome in result.outcomes.values()],
    }


def print_outcomes(result: BatchResult) -> None:
    """Print how many outcomes there are of each kind, and the first failures."""
    out = console(sys.stdout)
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("outcome")
    table.add_column("shapes", justify="right")
    for kind, count in result.counts.items():
        table.add_row(kind, str(count))
    out.print(table)
    if not result.failed:
        return
    out.print()
    failures = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("shape", "outcome", "why"):
        failures.add_column(heading, overflow="fold")
    for outcome in result.failed[:_LISTED]:
        failures.add_row(outcome.shape, outcome.kind, _short(outcome.message))
    out.print(failures)
    if len(result.failed) > _LISTED:
        out.print(f"and {len(result.failed) - _LISTED} others, in the ledger")


def what_is_left(result: BatchResult, *, page: bool) -> str:
    """What a batch that was stopped has left to do, and how that is done.

    Examples
    --------
    >>> what_is_left(BatchResult(folder=Path("out"), total=3), page=False)
    '3 of 3 shapes are left; go on with --resume'
    >>> what_is_left(BatchResult(folder=Path("out")), page=True)
    'all shapes are done, and the page is not; go on with --resume --report'
    """
    left = result.total - len(result.outcomes)
    options = "--resume --report" if page and result.page is None else "--resume"
    if left:
        return f"{left} of {result.total} shapes are left; go on with {options}"
    done = "all shapes are done"
    return f"{done}, and the page is not; go on with {options}" if "--report" in options else done


def counts_text(counts: Mapping[str, int]) -> str:
    """Counts of outcomes in words.

    Examples
    --------
    >>> counts_text({"ok": 12, "timeout": 1})
    '12 ok, 1 timeout'
    """
    return ", ".join(f"{count} {kind}" for kind, count in counts.items())


def duration_text(seconds: float) -> str:
    """About how long something takes.

    Examples
    --------
    >>> duration_text(45.2), duration_text(754), duration_text(8000)
    ('45 s', '13 min', '2.2 h')
    """
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"


@contextmanager
def progress_of_batch(
    *, quiet: bool, clock: Callable[[], float] = time.monotonic
) -> Iterator[BatchReport]:
    """A function to report the progress of a batch to: a bar on a terminal, else lines.

    Failures are told as they come.
    """
    if quiet:
        yield lambda progress: False
        return
    if not sys.stderr.isatty():
        yield _lines(clock)
        return
    bars = Bars(
        TextColumn("{task.fields[count]}", markup=False),
        BarColumn(),
        TextColumn("{task.description}", markup=False),
        console=console(sys.stderr),
        transient=True,
        auto_refresh=False,
    )
    task = bars.add_task("looking at the shapes", total=None, count="")

    def report(progress: BatchProgress) -> bool:
        _tell_failures(progress)
        bars.update(
            task,
            total=progress.total,
            completed=progress.done,
            description=_state(progress),
            count=f"{progress.done} of {progress.total}",
        )
        bars.refresh()
        return False

    with bars:
        yield report


def _lines(clock: Callable[[], float]) -> BatchReport:
    """Progress for logs."""
    spoke = clock()

    def report(progress: BatchProgress) -> bool:
        nonlocal spoke
        _tell_failures(progress)
        if clock() - spoke >= _LINE_EVERY:
            spoke = clock()
            message(f"{progress.done} of {progress.total} shapes: {_state(progress)}")
        return False

    return report


def _tell_failures(progress: BatchProgress) -> None:
    for outcome in progress.news:
        if not outcome.ok:
            message(f"{outcome.shape}: {outcome.kind}: {outcome.message}")


def _state(progress: BatchProgress) -> str:
    """Counts, and about how long the rest takes."""
    words = [f"{progress.kept} done before"] if progress.kept else []
    words += [counts_text(progress.counts)] if progress.counts else []
    left = progress.seconds_left
    if left is not None and math.isfinite(left) and progress.done < progress.total:
        words.append(f"about {duration_text(left)} left")
    return ", ".join(words) or "starting"


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
