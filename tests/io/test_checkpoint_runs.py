"""Runs that were stopped and gone on with: the same bytes as if they never were."""

from __future__ import annotations

import functools
import multiprocessing
import os
import random
import signal
import subprocess
import sys
import time

import pytest

from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.errors import MosegError, UsageError
from moseg_core.io.checkpoint import checkpointing
from moseg_core.io.result_json import write_json
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import Recipe
from moseg_core.problem.statement import Statement
from moseg_core.samples import sample_path
from moseg_core.search.levels import refine, segment_hierarchy
from moseg_core.search.number_of_parts import segment_parts
from moseg_core.search.segment import segment
from moseg_core.search.variants import segment_variants
from moseg_core.shape.shape import Shape
from tests.shapes import solid

# A stem of six cubes with a bar of seven across its top and a foot of three across its bottom.
CUBES = (
    [(3, 0, z) for z in range(1, 7)]
    + [(x, 0, 7) for x in range(7)]
    + [(x, 0, 0) for x in (2, 3, 4)]
)
BEAM = Shape.from_mesh(*solid(CUBES), name="beam")
WHOLE = Problem(["bar", "rest"], "10*convex_parts + narrow(bar)")
THREE = Problem(["bar", "stem", "foot"], "convex_parts + narrow(stem) + perpendicular(bar, stem)")
TASK = Hierarchy(WHOLE, {"rest": Problem(["stem", "foot"], "10*convex_parts + narrow(stem)")})
COUNTED = Statement(labels=("box{2..4}",), minimize="compact(box*) + 3*convex(box*)")
OPEN = Recipe(
    name="open",
    statement=Statement(labels=("part*",), minimize="0.1*compact(part*) + convex_parts"),
)
SHORT = {"optimizer": "pattern_search(threshold=0.02)"}
FEW = {"seeder": "kmeans", "optimizer": "pattern_search(max_evaluations=20)", "restarts": 1}


RUNS = {
    "starts": lambda **more: segment(BEAM, WHOLE, restarts=3, finalists=1, **SHORT, **more),
    "super-elements": lambda **more: segment(
        BEAM, THREE, restarts=2, resolution=20, refiner="graph_cut", **SHORT, **more
    ),
    "evolution": lambda **more: segment(
        BEAM,
        THREE,
        seeder="evolution(population=6, iterations=2)",
        labeler="exhaustive",
        pins={"foot": [0, 1]},
        restarts=2,
        **SHORT,
        **more,
    ),
    "sized evolution": lambda **more: segment(
        BEAM,
        Problem(["bar", "rest"], "is(bar, area=0.4+-0.1) + convex_parts"),
        seeder="sized_evolution(population=6, generations=2)",
        restarts=1,
        **SHORT,
        **more,
    ),
    "method as published": lambda **more: segment(
        BEAM, THREE, settings="paper", optimizer="pattern_search(max_evaluations=60)", **more
    ),
    "levels": lambda **more: segment_hierarchy(BEAM, TASK, restarts=2, **SHORT, **more),
    "label sets": lambda **more: segment_variants(BEAM, COUNTED, **FEW, **more),
    "numbers of parts": lambda **more: segment_parts(BEAM, recipe=OPEN, **FEW, **more),
}


def stopping_at(number):
    """A report that asks to stop from a certain one on."""
    seen = []

    def report(progress):
        seen.append(progress)
        return len(seen) >= number

    report.seen = seen
    return report


@functools.cache
def whole_run(name):
    """The bytes of a run that is never stopped, and how often it reports."""
    report = stopping_at(10**9)
    return write_json(RUNS[name](report=report)), len(report.seen)


#: Those that take longest, and go the same ways as others.
LONG = ("sized evolution", "numbers of parts")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in LONG)) for name in RUNS]
)
def test_stopped_and_gone_on_with_a_run_gives_the_same_bytes(name, tmp_path):
    sound, reports = whole_run(name)
    file = tmp_path / "c"
    for part in (0.3, 0.8):  # each goes on from where the one before was stopped
        with checkpointing(file, resume=file):
            cut = RUNS[name](report=stopping_at(int(part * reports) + 1))
        assert cut.reason == "interrupted"
    with checkpointing(file, resume=file) as checkpoint:
        assert write_json(RUNS[name](workers=2)) == sound
    assert checkpoint.known > 0


def killed_at(number, file, name):
    """Run in another process, which is killed (-9) at a certain report."""

    def run():
        def report(progress):
            seen.append(progress)
            if len(seen) >= number:
                os.kill(os.getpid(), signal.SIGKILL)
            return False

        seen = []
        with checkpointing(file, resume=file, every=0.01):
            RUNS[name](report=report)

    process = multiprocessing.get_context("fork").Process(target=run)
    process.start()
    process.join()
    return process.exitcode


@pytest.mark.parametrize("points", [4, pytest.param(20, marks=pytest.mark.slow)])
def test_random_stopping_points(points, tmp_path):
    """Half of them kills (-9), half of them interrupts, with one worker or two."""
    name, rng = "starts", random.Random(17)
    sound, reports = whole_run(name)
    for k in range(points):
        file, number = tmp_path / f"{k}", rng.randint(1, reports)
        if k % 2:
            assert killed_at(number, file, name) == -signal.SIGKILL
        else:
            with checkpointing(file, resume=file):
                RUNS[name](report=stopping_at(number), workers=1 + k // 2 % 2)
        with checkpointing(file, resume=file):
            assert write_json(RUNS[name]()) == sound


def test_of_a_finished_run_nothing_is_computed_again(tmp_path):
    calls = []

    @objective(range=(0, 9))
    def size(part: Part) -> float:
        calls.append(1)
        return part.area / BEAM.area

    problem = Problem(["a", "b"], "size(a) + compact(b)", objectives={"size": size})
    found = []
    for _ in range(2):
        calls.clear()
        with checkpointing(tmp_path / "c", resume=tmp_path / "c"):
            found.append((segment(BEAM, problem, restarts=2, **SHORT).cost, len(calls)))
    assert found[0][0] == found[1][0]
    assert found[0][1] > 50
    assert found[1][1] <= 4  # of the labels that came out, and their exchange


def test_refined_parts_are_gone_on_with_too(tmp_path):
    whole = segment(BEAM, WHOLE, **FEW)
    sound = write_json(refine(whole, dict(TASK.parts), **SHORT))
    for number in (3, 10**9):
        with checkpointing(tmp_path / "c", resume=tmp_path / "c") as checkpoint:
            found = refine(whole, dict(TASK.parts), report=stopping_at(number), **SHORT)
    assert checkpoint.known > 0
    assert write_json(found) == sound
    other = segment(BEAM, WHOLE, seeder="kmeans", optimizer="pattern_search(max_evaluations=1)")
    with (
        checkpointing(tmp_path / "c", resume=tmp_path / "c"),
        pytest.raises(UsageError, match="checkpoint of another run"),
    ):
        refine(other, dict(TASK.parts), seed=0, **SHORT)


def test_a_limit_on_time_is_for_each_sitting(tmp_path):
    """So a run that it has ended is gone on with by another, or without."""
    sound, _ = whole_run("starts")
    with checkpointing(tmp_path / "c"):
        cut = RUNS["starts"](max_seconds=0.05)
    assert cut.reason == "seconds"
    with checkpointing(tmp_path / "c", resume=tmp_path / "c"):
        assert write_json(RUNS["starts"]()) == sound


def test_a_component_that_fails_leaves_what_was_computed(tmp_path):
    broken = [True]

    @objective(range=(0, 9))
    def size(part: Part) -> float:
        calls.append(1)
        if broken and len(calls) == 40:
            raise ValueError("not today")
        return part.area / BEAM.area

    calls = []
    problem = Problem(["a", "b"], "size(a) + compact(b)", objectives={"size": size})
    with checkpointing(tmp_path / "c"), pytest.raises(MosegError, match="not today"):
        segment(BEAM, problem, restarts=2, **SHORT)
    broken.clear()
    calls.clear()
    with checkpointing(tmp_path / "c", resume=tmp_path / "c") as checkpoint:
        found = segment(BEAM, problem, restarts=2, **SHORT)
    assert checkpoint.known > 5
    assert write_json(found) == write_json(segment(BEAM, problem, restarts=2, **SHORT))


def test_another_run_is_refused_by_what_differs(tmp_path):
    with checkpointing(tmp_path / "c"):
        segment(BEAM, WHOLE, **FEW)
    with (
        checkpointing(tmp_path / "c", resume=tmp_path / "c"),
        pytest.raises(UsageError, match="of another run: search seed was 0 and is 7"),
    ):
        segment(BEAM, WHOLE, seed=7, **FEW)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_killed_at_random_moments_on_the_command_line(seed, tmp_path):
    """Ctrl-C, SIGTERM and kill -9 with two workers, five times in a run."""
    rng = random.Random(seed)
    command = [sys.executable, "-m", "moseg_core", "segment", str(sample_path("hammer"))]
    command += ["--recipe", "paper_hammer", "--seed", str(seed), "--workers", "2", "--quiet"]
    began = time.monotonic()
    subprocess.run([*command, "-o", tmp_path / "sound.json"], check=True)
    took = time.monotonic() - began
    kept = ["--checkpoint", tmp_path / "c", "--resume", tmp_path / "c", "--checkpoint-every", "0.2"]
    for _ in range(5):
        # In a group of its own, since a terminal's Ctrl-C is for all processes of a run.
        process = subprocess.Popen(
            [*command, *kept, "-o", tmp_path / "cut.json"], start_new_session=True
        )
        time.sleep(rng.uniform(0.2, 1.0) * took)
        number = rng.choice([signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
        if number == signal.SIGKILL:
            process.kill()
        elif process.poll() is None:
            os.killpg(process.pid, number)
        process.wait()
    subprocess.run([*command, *kept, "-o", tmp_path / "resumed.json"], check=True)
    assert (tmp_path / "resumed.json").read_bytes() == (tmp_path / "sound.json").read_bytes()
