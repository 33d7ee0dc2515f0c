"""Jobs of whole runs from the command line: what a user waits for on one machine."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import moseg_core as moseg
from moseg_core.samples import SAMPLES
from speed_jobs.processes import (
    MOSEG,
    SEARCH,
    final_cost,
    run,
    run_by_stage,
    segmenting,
    stage_records,
    used_records,
)
from speed_jobs.records import Record, Request
from speed_jobs.subdivision import small_hammer, write_mesh

SMALL_SHAPES = 100


def record(request: Request) -> Iterator[Record]:
    """The mesh with the recipe paper_horse, default settings, seeds 0 to 4; and by stage."""
    yield from _recipe_runs("record", "paper_horse", request, seeds=range(request.repeat))


def learned(request: Request) -> Iterator[Record]:
    """The mesh with the learned recipe fourleg, after a run to warm up; and by stage."""
    run([MOSEG, *segmenting(request.mesh, "fourleg", request)], request)
    yield from _recipe_runs("learned", "fourleg", request, seeds=[0] * request.repeat)


def _recipe_runs(
    job: str, recipe: str, request: Request, *, seeds: range | list[int]
) -> Iterator[Record]:
    """Runs as users do them, with a process for each processor, and in one process by stage."""
    runs, costs = [], []
    for seed in seeds:
        arguments = segmenting(request.mesh, recipe, request, "--seed", str(seed))
        runs.append(run([MOSEG, *arguments], request))
        costs.append(final_cost(request))
    yield from used_records(job, recipe, runs)
    yield Record(job=job, what=f"{recipe}: final cost", unit="cost", runs=tuple(costs))
    arguments = [segmenting(request.mesh, recipe, request, "--seed", str(seed)) for seed in seeds]
    stages = [run_by_stage([each], request)[1] for each in arguments]
    yield from stage_records(job, f"{recipe}, one process", stages)


def start(request: Request) -> Iterator[Record]:
    """What passes before a search: the interpreter, imports, help, kernels from the cache."""
    python = sys.executable
    for what, command in (
        ("python -c pass", [python, "-c", "pass"]),
        ("moseg --help", [MOSEG, "--help"]),
        ("import moseg_core", [python, "-c", "import moseg_core"]),
        ("from moseg_core import load, segment", [python, "-c", _IMPORTS]),
    ):
        run(command, request)
        walls = tuple(run(command, request).wall for _ in range(request.repeat))
        yield Record(job="start", what=what, unit="s", runs=walls)
    smallest = min(map(moseg.sample_path, SAMPLES), key=lambda path: path.stat().st_size)
    command = segmenting(smallest, "hammer", request)
    run_by_stage([command], request)
    runs = [run_by_stage([command], request) for _ in range(request.repeat)]
    title = f"moseg segment, {smallest.stem}, one process"
    searches = tuple(sum(stages.get(name, 0.0) for name in SEARCH) for _, stages in runs)
    walls = tuple(used.wall for used, _ in runs)
    yield Record(job="start", what=title, unit="s", runs=walls)
    what = f"{title}: its search, {'; '.join(SEARCH)}"
    yield Record(job="start", what=what, unit="s", runs=searches)
    less = tuple(wall - search for wall, search in zip(walls, searches, strict=True))
    yield Record(job="start", what=f"{title}: less its search", unit="s", runs=less)
    yield cold(command, request)


def cold(command: list[str], request: Request) -> Record:
    """The first run after an installation, once: no kernel is compiled yet.

    Of a copy of all bundles, since kernels are found beside the source as well.

    Raises
    ------
    AssertionError
        No kernel was compiled: the copy was not used.
    """
    copy = request.folder / "installed"
    for package in sorted({each.module.partition(".")[0] for each in entry_points(group="moseg")}):
        found = find_spec(package)
        (source,) = found.submodule_search_locations
        shutil.copytree(source, copy / package, ignore=shutil.ignore_patterns("__pycache__"))
    # Byte code there is, as after an installation by pip.
    run([sys.executable, "-m", "compileall", "-q", str(copy)], request)
    before = kept(copy)
    first = run([MOSEG, *command], request, environment={"PYTHONPATH": str(copy)})
    if kept(copy) == before:
        raise AssertionError("no kernel was compiled by what should be the first run")
    what = f"moseg segment, {Path(command[1]).stem}, no kernel compiled yet"
    return Record(job="start", what=what, unit="s", runs=(first.wall,))


def kept(folder: Path) -> int:
    """How many files there are in caches of a folder."""
    return sum(1 for _ in folder.glob("**/__pycache__/*"))


_IMPORTS = "from moseg_core import load, segment"


def small(request: Request) -> Iterator[Record]:
    """100 small shapes one after the other in one process, recipe hammer, short searches."""
    rng, commands = np.random.default_rng(0), []
    for k in range(SMALL_SHAPES):
        shape, path = small_hammer(rng), request.folder / f"small{k}.ply"
        write_mesh(shape, path)
        # What a search takes is not the question here: a short one is enough.
        short = ("--restarts", "1", "--seeder", "kmeans")
        commands.append(segmenting(path, "hammer", request, *short))
    run_by_stage(commands[:1], request)
    runs = [run_by_stage(commands, request) for _ in range(request.repeat)]
    title = f"a shape of {shape.n_elements} faces"
    each = tuple(used.wall / SMALL_SHAPES for used, _ in runs)
    yield Record(job="small", what=f"{title}: seconds", unit="s", runs=each)
    less = tuple(
        (used.wall - sum(stages.get(name, 0.0) for name in SEARCH)) / SMALL_SHAPES
        for used, stages in runs
    )
    yield Record(job="small", what=f"{title}: over its search", unit="s", runs=less)
    alone = [run([MOSEG, *commands[0]], request) for _ in range(request.repeat)]
    walls = tuple(used.wall for used in alone)
    yield Record(job="small", what=f"{title}: alone in a process", unit="s", runs=walls)
