"""Batches on a cluster: the same as here, though one of its workers is killed midway."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from moseg_core.batching import cluster
from moseg_core.batching.cluster import cluster_executor
from moseg_core.batching.driver import batch
from moseg_core.batching.ledger import read_ledger
from moseg_core.cli import main
from moseg_core.errors import UsageError
from tests.batching import planted
from tests.batching.planted import OPTIONS, STATEMENT, expected, write_shape

HERE = {"moseg-core": "0.1.0", "numpy": "2.1"}


class Cluster:
    """A scheduler and workers of one thread each, on loopback."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._file = folder, folder / "scheduler.json"
        self._processes: list[subprocess.Popen[bytes]] = []
        self._start("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file")
        while not self._file.exists():
            assert self._processes[0].poll() is None
            time.sleep(0.1)
        self.address = json.loads(self._file.read_text())["address"]

    def add_worker(self) -> subprocess.Popen[bytes]:
        """Start a worker, which joins the cluster soon."""
        place = self._folder / f"worker{len(self._processes)}"
        words = ["worker", "--nthreads", "1", "--no-nanny", "--local-directory", str(place)]
        return self._start(*words, "--scheduler-file")

    def wait_for(self, count: int) -> None:
        """Wait until there are so many workers."""
        from distributed import Client

        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(count, timeout=120)

    def _start(self, *words: str) -> subprocess.Popen[bytes]:
        process = subprocess.Popen(
            [sys.executable, "-m", "dask", *words, str(self._file), "--no-dashboard"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._processes.append(process)
        return process

    def end(self) -> None:
        """End all of it."""
        for process in reversed(self._processes):
            process.kill()
            process.wait()


@pytest.fixture
def started(planted_bundle, tmp_path):
    """A cluster of two workers, which find the planted bundle; and the workers."""
    found = Cluster(tmp_path)
    try:
        workers = [found.add_worker() for _ in range(2)]
        found.wait_for(2)
        yield found, workers
    finally:
        found.end()


@pytest.mark.slow
def test_a_worker_of_the_cluster_is_killed_midway(started, shape_folder):
    network, workers = started
    names = [f"s{k:02}" for k in range(36)]
    names += [f"{harm}{k}" for harm in ("segfault", "hang", "hog", "liar") for k in range(2)]
    for name in names:
        write_shape(shape_folder, name)
    paths = [f"models/{name}.off" for name in np.random.default_rng(2).permutation(names)]
    killed: list[int] = []

    def report(progress):
        if progress.done >= 12 and not killed:
            workers[0].send_signal(signal.SIGKILL)
            killed.append(progress.done)
        return False

    limits = {"timeout": 15, "memory": 1.0, "options": OPTIONS}
    with cluster_executor(network.address) as (executor, count):
        assert count == 2
        done = batch(
            paths, STATEMENT, "out", executor=executor, workers=count, report=report, **limits
        )
    assert killed
    assert workers[0].poll() is not None
    assert workers[1].poll() is None
    assert {Path(shape).stem: outcome.kind for shape, outcome in done.outcomes.items()} == {
        name: expected(name) for name in names
    }
    rows = Counter(row.key for row in read_ledger(Path("out")))
    assert set(rows.values()) == {1}
    assert len(rows) == len(names)
    sound = [path for path in paths if expected(Path(path).stem) == "ok"]
    here = batch(sound, STATEMENT, "here", workers=2, **limits)
    assert here.counts == {"ok": len(sound)}
    for path in sound:
        file = f"{Path(path).stem}.json"
        assert Path("out", file).read_bytes() == Path("here", file).read_bytes()

    # The same on the command line: nothing is left to do but what failed.
    with pytest.raises(SystemExit) as ended:
        main(
            [
                *("batch", *paths, *planted.WORDS, "-o", "out", "--timeout", "15", "--memory", "1"),
                *("--scheduler", network.address, "--resume", "--quiet"),
            ]
        )
    assert ended.value.code == 1
    assert len(read_ledger(Path("out"))) == len(names)


def test_other_versions_are_refused_by_the_address_of_the_worker(monkeypatch):
    monkeypatch.setattr(cluster, "own_versions", lambda: HERE)
    cluster._check_versions({"tcp://a": HERE, "tcp://b": dict(HERE)})
    with pytest.raises(UsageError) as refused:
        cluster._check_versions(
            {"tcp://a": HERE, "tcp://b": {**HERE, "numpy": "2.0"}, "tcp://c": {}}
        )
    assert "on worker tcp://b numpy is 2.1 here and 2.0 there; and 1 more" in str(refused.value)
    without = ModuleNotFoundError("No module named 'moseg_core'")
    with pytest.raises(UsageError, match="tcp://a cannot say which versions it has"):
        cluster._check_versions({"tcp://a": without})


NOBODY = """
from moseg_core.batching import cluster
from moseg_core.errors import UsageError

cluster._TO_CONNECT = 0.2
for address in ("tcp://127.0.0.1:9", "nonsense://x"):
    try:
        with cluster.cluster_executor(address):
            pass
    except UsageError as error:
        print(error)
"""


def test_nobody_at_the_address():
    # In a process of its own: Dask keeps threads.
    said = subprocess.run(
        [sys.executable, "-c", NOBODY], check=True, capture_output=True, text=True
    ).stdout.splitlines()
    assert len(said) == 2
    assert said[0].startswith("no Dask scheduler answers at 'tcp://127.0.0.1:9'")
    assert said[1].startswith("no Dask scheduler answers at 'nonsense://x'")


def test_without_dask_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"pip install 'moseg-core\[cluster\]'"):
        cluster._distributed()


def test_workers_are_those_of_the_cluster(shape_folder, capsys):
    write_shape(shape_folder, "a")
    words = ["batch", "models/a.off", "--labels", "a,b", "--minimize", "narrow(a)", "-o", "out"]
    with pytest.raises(SystemExit) as ended:
        main([*words, "--scheduler", "tcp://127.0.0.1:9", "--workers", "3"])
    assert ended.value.code == 2
    assert "--workers is for this computer" in capsys.readouterr().err
