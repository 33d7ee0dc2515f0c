"""Warm child processes that read cases under limits, and what their deaths mean.

A child imports moseg once and reads one case after the other, each with :data:`SECONDS` of
processor time. All of it has :data:`MEMORY_LIMIT` more than it has when it is warm. A child that
dies is that case's outcome: a hang where the limit ended it, a crash else; another takes the next.
Time of the processor is what counts, so that a busy machine changes nothing.

``python -m tests.fuzz.children`` is a child: a case a line of JSON in, a verdict a line out.
"""

from __future__ import annotations

import contextlib
import faulthandler
import gc
import json
import os
import queue
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tests.fuzz.case import Case
from tests.fuzz.command_line import judge_command
from tests.fuzz.verdict import CRASH, HANG, MEMORY, TRIALS, Verdict, judge

ROOT = Path(__file__).parents[2]
SECONDS = 20
MEMORY_LIMIT = 3 << 30
_PATIENCE = 300
"""Seconds by the clock after which a child that waits for something is ended."""
_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What became of a case, and the seconds that reading it took."""

    case: Case
    verdict: Verdict
    seconds: float


def run(
    cases: Sequence[Case],
    *,
    children: int = 2,
    by_command: bool = False,
    seconds: float = SECONDS,
    told: Callable[[Outcome], None] = lambda outcome: None,
) -> list[Outcome]:
    """Read all cases, in as many children at a time; outcomes in the order of the cases.

    Parameters
    ----------
    cases : sequence of Case
    children : int
    by_command : bool
        Whether the command line reads the cases, instead of the public functions.
    seconds : float
        Of the processor, for each case.
    told : callable
        Is given each outcome as it comes.
    """
    waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
    # Large ones first, so that no child is left alone with them at the end.
    order = sorted(range(len(cases)), key=lambda k: cases[k].kind not in _LARGE)
    for k in order:
        waiting.put(k)
    found: dict[int, Outcome] = {}

    def work() -> None:
        with _Child({"by_command": by_command, "seconds": seconds}) as child:
            while not waiting.empty():
                with contextlib.suppress(queue.Empty):  # another thread may have been faster
                    k = waiting.get_nowait()
                    found[k] = child.read(cases[k])
                    told(found[k])

    with ThreadPoolExecutor(children) as threads:
        for done in [threads.submit(work) for _ in range(children)]:
            done.result()
    return [found[k] for k in range(len(cases))]


_LARGE = {"large", "expansion", "many corners", "nesting"}


class _Child:
    """A child process, made when it is needed and again when it has died."""

    def __init__(self, how: dict[str, Any]) -> None:
        self.how = how
        self.process: subprocess.Popen[bytes] | None = None
        self.folder = Path(tempfile.mkdtemp(prefix="moseg-fuzz-"))
        self.count = 0

    def __enter__(self) -> _Child:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()
        shutil.rmtree(self.folder, ignore_errors=True)

    def read(self, case: Case) -> Outcome:
        """Write the files of a case, and have it read."""
        self.count += 1
        folder = self.folder / str(self.count)
        folder.mkdir()
        path = write_files(case.files(), folder)
        start = time.perf_counter()
        verdict = self._asked(asked_of(case, path) | self.how)
        seconds = time.perf_counter() - start
        shutil.rmtree(folder)
        return Outcome(case=case, verdict=verdict, seconds=seconds)

    def _asked(self, asked: dict[str, Any]) -> Verdict:
        process = self._started()
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(json.dumps(asked).encode() + b"\n")
        process.stdin.flush()
        if not select.select([process.stdout], [], [], _PATIENCE)[0]:
            self._end()
            return Verdict(outcome=HANG, said=f"waited for {_PATIENCE} s")
        line = process.stdout.readline()
        if line:
            verdict = Verdict(**json.loads(line))
            if verdict.outcome == MEMORY:
                self._end()
            return verdict
        code = process.wait()
        said = self._last_words()
        self._end()
        if code == -signal.SIGPROF:
            return Verdict(outcome=HANG, said=f"more than {self.how['seconds']} s: {said}")
        outcome = MEMORY if code == -signal.SIGKILL or "MemoryError" in said else CRASH
        return Verdict(outcome=outcome, said=f"exit code {code}: {said}")

    def _started(self) -> subprocess.Popen[bytes]:
        if self.process is None:
            with (self.folder / "stderr").open("wb") as errors:
                self.process = subprocess.Popen(
                    [sys.executable, "-m", "tests.fuzz.children"],
                    cwd=ROOT,
                    env=os.environ | dict.fromkeys(_ONE_THREAD, "1"),
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=errors,
                    start_new_session=True,
                )
        return self.process

    def _last_words(self) -> str:
        words = (self.folder / "stderr").read_text(errors="replace")
        return " ".join(words.split())[-600:]

    def _end(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            for stream in (self.process.stdin, self.process.stdout):
                if stream is not None:
                    stream.close()
        self.process = None


def asked_of(case: Case, path: Path) -> dict[str, Any]:
    """What a child is asked: see :func:`tests.fuzz.verdict.judge`."""
    return {
        "path": str(path),
        "task": case.task,
        "expected": case.expected,
        "elements": case.elements,
        "area": case.area,
    }


def write_files(files: dict[str, bytes], folder: Path) -> Path:
    """Write the files of a case into a folder; the path of the first."""
    for name, data in files.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data)
    return folder / next(iter(files))


def _serve(lines: Iterable[bytes]) -> None:
    """Answer each line; what moseg prints goes to stderr."""
    answers = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    faulthandler.enable()
    faulthandler.register(signal.SIGPROF, chain=True)  # says where a hang hangs, then it dies
    warm = False
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for line in lines:
        asked = json.loads(line)
        if not warm and asked["task"] not in TRIALS:
            _warm_up()
            warm = True
        # What is there now is neither looked through by each collection nor counted.
        gc.freeze()
        limit = _size() + MEMORY_LIMIT
        resource.setrlimit(resource.RLIMIT_AS, (limit, resource.RLIM_INFINITY))
        signal.setitimer(signal.ITIMER_PROF, asked["seconds"])
        verdict = (judge_command if asked["by_command"] else judge)(asked)
        signal.setitimer(signal.ITIMER_PROF, 0)
        resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY,) * 2)
        answers.write(json.dumps(asdict(verdict)).encode() + b"\n")
        gc.collect()


def _warm_up() -> None:
    """Import what reading needs: a sound file of each format is read."""
    from tests.fuzz.damage import ALL_SEEDS

    with tempfile.TemporaryDirectory() as folder:
        for k, seed in enumerate(ALL_SEEDS):
            made = seed.with_data(seed.data())
            named = {"": made} if isinstance(made, bytes) else dict(made)
            inner = Path(folder) / str(k)
            inner.mkdir()
            path = write_files({n or f"case{seed.suffix}": b for n, b in named.items()}, inner)
            judge({"path": str(path), "task": seed.task, "expected": "either",
                   "elements": (0, 1 << 62), "area": None})  # fmt: skip


def _size() -> int:
    """Bytes of address space that this process has."""
    return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()


if __name__ == "__main__":
    _serve(sys.stdin.buffer)
