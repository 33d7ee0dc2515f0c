"""Batches: what is planted fails and nothing else; what was done is done once."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from moseg_core.batching.driver import Limits, batch
from moseg_core.batching.ledger import NAME, read_ledger
from moseg_core.batching.outcome import Outcome
from moseg_core.cli import main
from moseg_core.errors import UsageError
from tests.batching import planted
from tests.batching.planted import OPTIONS, STATEMENT, WORDS, expected, write_shape


def run(*words, **more):
    return batch(*words, **{"options": OPTIONS, "workers": 1, **more})


def single_run(path: Path, output: Path) -> bytes:
    """The result of a run alone, as if in a fresh process."""
    here, output = Path.cwd(), output.absolute()
    if "planted_objective" in sys.modules:
        sys.modules["planted_objective"].SEEN.clear()
    with pytest.raises(SystemExit) as ended:
        main(["segment", str(path), *WORDS, "-o", str(output), "--quiet", "--workers", "1"])
    os.chdir(here)  # a planted component may have left it
    assert ended.value.code == 0
    return output.read_bytes()


def children_of(process: int) -> list[str]:
    """Command lines of guarded children whose guard is, or was, a process."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            words = (entry / "cmdline").read_bytes().split(b"\0")[:-1]
        except OSError:
            continue
        if b"moseg_core.batching.child" in words and words[-1] == str(process).encode():
            found.append(entry.name)
    return found


def gone(process: int, patience: float = 20.0) -> bool:
    """Whether all children are gone, at once or soon."""
    deadline = time.monotonic() + patience
    while children_of(process):
        if time.monotonic() > deadline:
            return False
        time.sleep(0.05)
    return True


def test_what_is_planted_fails_and_nothing_else(planted_bundle, shape_folder):
    names = ["a1", "a2", "aged", "broken", "noise", "segfault"]
    for name in names:
        write_shape(shape_folder, name)
    seen = []
    done = run(
        ["models/*.off"], STATEMENT, "out", outputs=["out/{shape}/{part}.ply"], report=seen.append
    )
    assert {Path(shape).stem: o.kind for shape, o in done.outcomes.items()} == {
        name: expected(name) for name in names
    }
    crash = done.outcomes["models/segfault.off"]
    assert "SIGSEGV while objective 'planted:planted'" in crash.message
    assert "planted_objective.py:" in crash.message
    assert crash.component.startswith("objective 'planted:planted'")
    # The same bytes as of a run alone, written where they belong whatever a component does.
    for name in ("a2", "aged", "noise"):
        alone = single_run(Path("models") / f"{name}.off", Path("alone.json"))
        assert Path("out", f"{name}.json").read_bytes() == alone
        assert sorted(p.name for p in Path("out", name).iterdir()) == ["a.ply", "b.ply"]
    assert done.counts == {"ok": 4, "bad shape": 1, "crashed": 1}
    assert seen[-1].done == seen[-1].total == 6
    assert sum((progress.news for progress in seen), ()) == tuple(read_ledger(Path("out")))
    assert gone(os.getpid())

    # Nothing is left to do; then only what failed; then what is lost and what has changed.
    with pytest.raises(UsageError, match="has the ledger of a batch"):
        run(["models/*.off"], STATEMENT, "out")
    again = {"outputs": ["out/{shape}/{part}.ply"], "resume": True}
    before = read_ledger(Path("out"))
    assert run(["models/*.off"], STATEMENT, "out", **again).outcomes == done.outcomes
    assert read_ledger(Path("out")) == before
    write_shape(shape_folder, "a3").replace(shape_folder / "broken.off")
    Path("out/a1.json").unlink()
    aside = Path("out/.a1.json.abc_0123")
    aside.write_text("torn")
    mended = run(["models/*.off"], STATEMENT, "out", **again)
    assert mended.counts == {"ok": 5, "crashed": 1}
    assert Path("out/a1.json").exists()
    assert not aside.exists()
    rows = read_ledger(Path("out"))
    assert [row.shape for row in rows[len(before) :]] == ["models/broken.off"]
    keys = Counter(row.key for row in rows)
    assert set(keys.values()) == {1}
    run(["models/segfault.off"], STATEMENT, "out", retry_failed=True, outputs=again["outputs"])
    assert [row.kind for row in read_ledger(Path("out"))[len(rows) :]] == ["crashed"]


class Unreliable(ThreadPoolExecutor):
    """Loses its first jobs, as a machine does that is switched off."""

    def __init__(self, outcome, lost):
        super().__init__(1)
        self.outcome, self.lost, self.jobs = outcome, lost, []

    def submit(self, function, job):
        self.jobs.append(job)
        future = Future()
        if len(self.jobs) <= self.lost:
            future.set_exception(RuntimeError("the worker is gone"))
        else:
            future.set_result(self.outcome(job))
        return future


def sound(job):
    Path(job.outputs[0]).write_text("{}")
    return Outcome(shape=job.shape, key=job.key, kind="ok", files=(Path(job.outputs[0]).name,))


def plain(*words, **more):
    return batch(*words, **{"workers": 1, "options": OPTIONS, **more})


PLAIN = planted.Statement(labels=("a", "b"), minimize="narrow(a)")


def test_a_job_whose_worker_is_lost_is_handed_out_again(shape_folder):
    for name in "ab":
        write_shape(shape_folder, name)
    with Unreliable(sound, 2) as pool:
        done = plain(["models/*.off"], PLAIN, "out", executor=pool)
    assert done.counts == {"ok": 2}
    assert len(read_ledger(Path("out"))) == 2
    with Unreliable(sound, 99) as pool:
        done = plain(["models/*.off"], PLAIN, "other", executor=pool)
    assert done.counts == {"crashed": 2}
    assert "lost 4 times (RuntimeError: the worker is gone)" in done.failed[0].message
    job = pool.jobs[0]
    assert json.loads(job.instructions)["statement"]["labels"] == ["a", "b"]
    assert job.versions["moseg-core"]


def test_a_result_that_nobody_sees_is_none(shape_folder):
    write_shape(shape_folder, "a")

    def elsewhere(job):
        outcome = sound(job)
        Path(job.outputs[0]).unlink()
        return outcome

    with Unreliable(elsewhere, 0) as pool:
        done = plain(["models/*.off"], PLAIN, "out", executor=pool)
    assert done.counts == {"failed": 1}
    assert "all workers of a batch have to see the same files" in done.failed[0].message


def test_other_versions_over_there_end_the_batch(shape_folder):
    write_shape(shape_folder, "a")

    def refuse(job):
        raise UsageError("numpy is 2.1 here and 2.0 there")

    class Other(Unreliable):
        def submit(self, function, job):
            future = Future()
            future.set_exception(UsageError("numpy is 2.1 here and 2.0 there"))
            return future

    with Other(refuse, 0) as pool, pytest.raises(UsageError, match=r"numpy is 2\.1 here"):
        plain(["models/*.off"], PLAIN, "out", executor=pool)
    assert read_ledger(Path("out")) == []


def test_who_is_told_to_stop_before_the_first_shape_begins_none(shape_folder):
    write_shape(shape_folder, "a")
    done = plain(["models/*.off"], PLAIN, "out", report=lambda progress: True)
    assert (done.stopped, done.total, dict(done.outcomes)) == (True, 1, {})
    assert read_ledger(Path("out")) == []


def test_few_jobs_are_under_way_and_stopping_begins_no_others(shape_folder):
    for number in range(20):
        write_shape(shape_folder, f"s{number:02}")
    most, seen = [], []

    class Slow(Unreliable):
        def submit(self, function, job):
            future = super().submit(function, job)
            most.append(len(self.jobs) - sum(len(progress.news) for progress in seen))
            return future

    def report(progress):
        seen.append(progress)
        return progress.done >= 5

    with Slow(sound, 0) as pool:
        done = plain(["models/*.off"], PLAIN, "out", executor=pool, workers=2, report=report)
    assert max(most) <= 4
    assert done.stopped
    assert 5 <= len(done.outcomes) < 20
    with Slow(sound, 0) as pool:
        whole = plain(["models/*.off"], PLAIN, "out", executor=pool, resume=True)
    assert len(whole.outcomes) == 20
    assert len(pool.jobs) == 20 - len(done.outcomes)


def test_those_at_work_are_finished_where_an_executor_does_not_know_them(shape_folder):
    for name in "abcdef":
        write_shape(shape_folder, name)

    class Unaware(Unreliable):
        """Its futures can be cancelled until they are done, as those of Dask."""

        def submit(self, function, job):
            self.jobs.append((job, Future()))
            return self.jobs[-1][1]

    def report(progress):
        if len(progress.at_work) == 2:  # of four that were handed out
            for job, future in pool.jobs:
                if not future.done():
                    future.set_result(sound(job))
        return len(progress.at_work) > 0

    with Unaware(sound, 0) as pool:
        done = plain(["models/*.off"], PLAIN, "out", executor=pool, workers=2, report=report)
    assert [Path(shape).name for shape in done.outcomes] == ["a.off", "b.off"]
    assert len(pool.jobs) == 4


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"timeout": 0}, "the timeout must be a positive number, not 0"),
        ({"memory": float("nan")}, "the memory must be a positive number"),
        ({"memory": 0.1}, r"a memory of 0\.1 GB is too little"),
    ],
)
def test_limits_without_a_sense_are_refused(given, said):
    with pytest.raises(UsageError, match=said):
        Limits(**given)


def test_what_is_wrong_with_every_shape_is_refused_before_any_is_begun(shape_folder):
    write_shape(shape_folder, "a")
    with pytest.raises(UsageError, match="did you mean 'narrow'"):
        plain(["models/*.off"], planted.Statement(labels=("a",), minimize="narow(a)"), "out")
    assert not Path("out").exists()
    with pytest.raises(UsageError, match="whole number from 1 on"):
        plain(["models/*.off"], PLAIN, "out", workers=0)
    with pytest.raises(UsageError, match="there is no folder 'no'"):
        plain(["models/*.off"], PLAIN, "no/where")
    with pytest.raises(UsageError, match=r"cannot write files '\.xyz'"):
        plain(["models/*.off"], PLAIN, "out", outputs=["out/{shape}.xyz"])
    assert not Path("out").exists()
    Path("out").write_text("")
    with pytest.raises(UsageError, match="'out' is a file"):
        plain(["models/*.off"], PLAIN, "out")


class Driver:
    """``moseg batch`` in a process of its own."""

    def __init__(self, *more: str) -> None:
        words = ["batch", "models/*.off", *WORDS, "-o", "out", "--quiet", "--workers", "2", *more]
        self.process = subprocess.Popen(
            [sys.executable, "-m", "moseg_core", *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def wait_for_rows(self, count: int) -> None:
        while self.process.poll() is None and rows_of(Path("out")) < count:
            time.sleep(0.02)


def rows_of(folder: Path) -> int:
    path = folder / NAME
    return path.read_bytes().count(b"\n") - 1 if path.exists() else 0


@pytest.mark.parametrize(
    "number", [signal.SIGKILL, pytest.param(signal.SIGINT, marks=pytest.mark.slow)]
)
def test_a_driver_that_is_ended_leaves_no_orphan_and_can_be_gone_on_with(
    planted_bundle, shape_folder, number
):
    for k in range(3):
        write_shape(shape_folder, f"s{k}")
    write_shape(shape_folder, "hang")
    first = Driver()
    first.wait_for_rows(1)
    first.process.send_signal(number)
    if number == signal.SIGINT:  # once more, since one of the shapes is never done
        time.sleep(0.5)
        first.process.send_signal(number)
    assert first.process.wait(60) == (-9 if number == signal.SIGKILL else 130)
    assert gone(first.process.pid)
    (shape_folder / "hang.off").unlink()
    done = run(["models/*.off"], STATEMENT, "out", resume=True)
    assert done.counts == {"ok": 3}
    rows = Counter(row.key for row in read_ledger(Path("out")))
    assert set(rows.values()) == {1}
    assert len(rows) == 3


@pytest.mark.slow
def test_two_hundred_shapes_with_planted_harm(planted_bundle, shape_folder):
    rng = np.random.default_rng(1)
    often = {"hang": 2, "spin": 2, "hog": 3, "killed": 2}
    names = [f"{harm}{k}" for harm in planted.HARM for k in range(often.get(harm, 4))]
    names += [f"noise{k}" for k in range(4)] + [f"aged{k}" for k in range(4)]
    names += [f"sound{k}" for k in range(200 - len(names))]
    for name in names:
        write_shape(shape_folder, name)
    paths = [f"models/{name}.off" for name in rng.permutation(names)]
    done = run(paths, STATEMENT, "out", workers=2, timeout=15, memory=1.0)
    assert {Path(shape).stem: o.kind for shape, o in done.outcomes.items()} == {
        name: expected(name) for name in names
    }
    for name in names:
        if expected(name) == "ok":
            alone = single_run(Path("models") / f"{name}.off", Path("alone.json"))
            assert Path("out", f"{name}.json").read_bytes() == alone
    assert gone(os.getpid())


def kill_somebody(driver: Driver, rng: np.random.Generator) -> bool:
    """Kill the driver or one of its children without warning; whether there was one to kill."""
    children = children_of(driver.process.pid)
    if children and rng.random() < 0.6:
        try:
            os.kill(int(rng.choice(children)), signal.SIGKILL)
        except ProcessLookupError:
            return False
    else:
        driver.process.kill()
        driver.process.wait()
        assert gone(driver.process.pid)
    return True


@pytest.mark.slow
def test_kills_at_random_moments_lose_nothing(planted_bundle, shape_folder):
    rng = np.random.default_rng(0)
    names = [f"s{k:03}" for k in range(60)]
    for name in names:
        write_shape(shape_folder, name)
    whole = run(["models/*.off"], STATEMENT, "whole", workers=2)
    assert whole.counts == {"ok": len(names)}
    kills = 0
    # A fast machine ends a batch after few kills; batches are begun until there were enough.
    while kills < 50:
        driver = Driver()
        while driver.process.poll() is None or rows_of(Path("out")) < len(names):
            if driver.process.poll() is not None:
                driver = Driver("--resume")
            time.sleep(rng.uniform(0.2, 2.5))
            if kills < 50 and driver.process.poll() is None:
                kills += kill_somebody(driver, rng)
        done = run(["models/*.off"], STATEMENT, "out", resume=True, retry_failed=True)
        assert done.counts == {"ok": len(names)}
        for name in names:
            undisturbed = Path("whole", f"{name}.json").read_bytes()
            assert Path("out", f"{name}.json").read_bytes() == undisturbed
        ok = Counter(row.key for row in read_ledger(Path("out")) if row.ok)
        assert set(ok.values()) == {1}
        assert sorted(p.name for p in Path("out").iterdir()) == sorted(
            [NAME, *(f"{name}.json" for name in names)]
        )
        shutil.rmtree("out")
    assert kills == 50
