"""``moseg segment``: the whole method, from files to files."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from moseg_core.cli.console import console, message, print_json, progress_reporter, terms_table
from moseg_core.cli.interrupt import stop_on_interrupt
from moseg_core.cli.reading import read_shape
from moseg_core.cli.request import Asked, read_pins, read_start, read_task
from moseg_core.clipping.clip import check_clippable
from moseg_core.components.chosen import Choice
from moseg_core.errors import MosegError, UsageError
from moseg_core.io.files import check_output, save
from moseg_core.io.result_json import evaluation_document
from moseg_core.io.write.formats import check_writable
from moseg_core.problem.settings import read_resolution
from moseg_core.problem.slow_calls import naming_slow_calls
from moseg_core.search.clipped_result import check_parameterization, clip
from moseg_core.search.levels import check_hierarchy, segment_hierarchy
from moseg_core.search.result import Result
from moseg_core.search.segment import check_frozen, check_limits, matched_centers, prepare_method
from moseg_core.search.workers import available_workers, read_workers

#: Seconds after which an objective that has not answered is named.
PATIENCE = 10.0


def run_segment(
    path: Path,
    *,
    asked: Asked,
    voxels: str,
    adjacency: str,
    volume: str | None,
    choices: Mapping[str, str | None],
    centers: str | None,
    start: Path | None,
    pins: Sequence[str],
    freeze: str | None,
    restarts: int | None,
    finalists: int | None,
    resolution: str | None,
    settings: str,
    seed: int,
    max_seconds: float | None,
    workers: int | None,
    clipped: bool,
    outputs: list[Path],
    as_json: bool,
    quiet: bool,
) -> None:
    """Check everything that can be checked, then read, search, write and print.

    Where the search fails, and files were asked for, these receive the best that it had found.
    """
    earlier = read_start(start)
    task = read_task(asked, start=earlier)
    problem = task.problem
    chosen = _read_choices(choices, centers)
    check_hierarchy(task, {**chosen, "settings": settings, "resolution": resolution})
    if clipped:
        ready = prepare_method(problem, task.method, chosen)
        check_parameterization(ready["parameterization"].component.id)
        if task.children:
            raise UsageError("boundaries can be clipped for results of one level only, so far")
    if resolution is not None:
        read_resolution(resolution)
    begin = None
    if earlier is not None:
        begin = matched_centers(
            earlier.names, earlier.centers, problem, embedding=earlier.embedding
        )
    pinned = read_pins(pins)
    check_limits(seed, max_seconds)
    processes = available_workers() if workers is None else read_workers(workers)
    frozen = [name.strip() for name in freeze.split(",")] if freeze else []
    check_frozen(problem, frozen)
    if start is not None and centers is not None:
        raise UsageError("--start and --centers both say where to begin; give one of them")
    for output in outputs:
        check_output(output)
        if output.exists() and path.exists() and output.samefile(path):
            raise UsageError(f"'{output}' is the shape itself; write the result to another file")

    started = time.monotonic()
    shape = read_shape(path, voxels=voxels, adjacency=adjacency, volume=volume)
    problem.check(problem.embed(shape))
    if clipped:
        check_clippable(shape)
    for output in outputs:
        check_writable(output.suffix, shape)
    if earlier is not None and earlier.shape.get("fingerprint") != shape.fingerprint:
        message(
            f"warning: {start} is a result of another shape, '{earlier.shape.get('name')}'",
            quiet=quiet,
        )
    for note in shape.notes:
        message(f"{path.name}: {note}", quiet=quiet)
    failure: MosegError | None = None
    with (
        progress_reporter(quiet=quiet) as show,
        stop_on_interrupt(wanted=bool(outputs)) as stop,
        naming_slow_calls(partial(_tell_waiting, quiet=quiet), after=PATIENCE),
    ):
        try:
            result = segment_hierarchy(
                shape,
                task,
                **chosen,
                start=begin,
                freeze=frozen,
                pins=pinned,
                restarts=restarts,
                finalists=finalists,
                resolution=resolution,
                settings=settings,
                seed=seed,
                max_seconds=max_seconds,
                workers=processes,
                report=lambda progress: show(progress) or stop(),
            )
        except MosegError as error:
            if error.result is None or not outputs:
                raise
            result, failure = error.result, error
    for warning in result.warnings:
        message(f"warning: {warning}", quiet=quiet)
    if clipped:
        result = clip(result)
        message(_told(result), quiet=quiet)
    for output in outputs:
        save(result, output)
    free, whole = result.dimension
    if free < whole:
        message(f"constraints leave {free} of {whole} dimensions to search", quiet=quiet)
    written = f"; wrote {', '.join(str(output) for output in outputs)}" if outputs else ""
    message(f"{time.monotonic() - started:.1f} s{written}", quiet=quiet)
    if as_json:
        print_json(_summary(result))
    elif not quiet:
        _print_tables(result)
    if failure is not None:
        raise failure
    if result.reason == "interrupted":
        raise KeyboardInterrupt


def _tell_waiting(what: str, seconds: float, *, quiet: bool) -> None:
    message(f"waiting for {what}, {seconds:.0f} s so far", quiet=quiet)


def _read_choices(choices: Mapping[str, str | None], centers: str | None) -> dict[str, Any]:
    """The components to use instead of the method's."""
    chosen: dict[str, Any] = {
        kind: Choice.read(text, kind)  # type: ignore[arg-type]  # the keys are kinds
        for kind, text in choices.items()
        if text is not None
    }
    if centers is not None:
        if chosen.get("seeder", Choice("given")).name not in ("given", "core:given"):
            raise UsageError(
                f"--centers goes with the seeder 'given', not '{chosen['seeder'].name}'"
            )
        chosen["seeder"] = Choice("given", {"centers": centers})
    return chosen


def _told(result: Result) -> str:
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
        "seed": result.seed,
        "reason": result.reason,
        "warnings": list(result.warnings),
    }


def _print_tables(result: Result) -> None:
    out = console(sys.stdout)
    parts = Table(box=None, pad_edge=False, header_style="bold")
    parts.add_column("part")
    parts.add_column(f"{result.shape.noun}s", justify="right")
    parts.add_column("volume" if result.shape.solid else "area", justify="right")
    for name, part in result.parts.items():
        share = part.area / result.shape.area
        parts.add_row(name, str(part.n_elements), f"{100 * share:.1f} %")
    out.print(parts)
    out.print()
    out.print(terms_table(result.evaluation))
