"""The parent of the child that runs the checks: ends a child that hangs, and starts another.

A component may never return, or take its process with it. So the checks run in a child
(:mod:`moseg_core.testing.processes.reporting_child`), which reports when a check begins and how it
ended. A check that takes too long, or in which the child dies, has failed; the rest goes on in
another child, without the other checks of that component, since they would likely end the same
way.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import select
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Self

from moseg_core.components.crash_dump import crash_place
from moseg_core.errors import PluginError, UsageError
from moseg_core.testing.run import Outcome

_CHILD = (sys.executable, "-m", "moseg_core.testing.processes.reporting_child")

#: How long a child that is to be ended may take to write which function is running.
_LAST_WORDS = 1.0

#: How many bytes of what a child printed are looked at.
_TAIL = 1 << 16


Announce = Callable[[int, int, str], None]


@dataclass(frozen=True, kw_only=True)
class BundleReport:
    """What the checks of a bundle came to.

    Parameters
    ----------
    bundle : str
    distribution : str
        Name and version.
    outcomes : tuple of Outcome
        In the order of components and checks.
    """

    bundle: str
    distribution: str
    outcomes: tuple[Outcome, ...]

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return all(outcome.status != "failed" for outcome in self.outcomes)


def watch_checks(
    bundle: str,
    *,
    timeout: float = 60.0,
    report: Announce | None = None,
    command: Sequence[str] = _CHILD,
) -> BundleReport:
    """Run all checks on a bundle, whatever its components do.

    Parameters
    ----------
    bundle : str
        Namespace of an installed bundle.
    timeout : float, seconds
        The longest that a check may take, and that the bundle may take to be imported.
    report : callable, optional
        Called before each check with how many are done, how many there are, and which is next.
    command : sequence of str
        What runs the checks; a process that reports as
        :mod:`moseg_core.testing.processes.reporting_child` does.

    Returns
    -------
    BundleReport

    Raises
    ------
    UsageError
        No such bundle; a timeout that is not positive.
    PluginError
        The bundle is set aside, or its process does not come as far as the first check.
    """
    if not timeout > 0:
        raise UsageError(f"--timeout is {timeout:g}; it must be more than 0 seconds")
    found: dict[int, Outcome] = {}
    cases: list[list[str]] | None = None
    distribution = ""
    while cases is None or len(found) < len(cases):
        running: int | None = None
        with _Child(bundle, command, timeout, leave_out=sorted(found)) as child:
            for event in child.events():
                if event["event"] == "refused":
                    kind = UsageError if event["code"] == UsageError.exit_code else PluginError
                    raise kind(event["message"])
                if event["event"] == "cases":
                    cases, distribution = event["cases"], event["distribution"]
                elif event["event"] == "start":
                    running = event["case"]
                    if report is not None and cases is not None:
                        report(len(found), len(cases), " ".join(cases[event["case"]]))
                elif cases is not None:
                    component, check = cases[event["case"]]
                    kept = {key: event[key] for key in ("status", "message", "fix")}
                    found[event["case"]] = Outcome(component=component, check=check, **kept)
                    running = None
        if cases is None or (running is None and len(found) < len(cases)):
            raise PluginError(f"bundle '{bundle}' cannot be checked: its process {child.ending}")
        if running is not None:
            found |= _ended(cases, running, child)
    return BundleReport(
        bundle=bundle,
        distribution=distribution,
        outcomes=tuple(found[number] for number in range(len(cases))),
    )


def _ended(cases: list[list[str]], running: int, child: _Child) -> dict[int, Outcome]:
    """What becomes of a case that ended its process, and of those after it on its component."""
    component, check = cases[running]
    fix = "see that it returns, or allow it more time with --timeout" if child.late else ""
    ended = Outcome(
        component=component,
        check=check,
        status="failed",
        message=f"its process {child.ending}",
        fix=fix or "see that it raises an exception where something is wrong",
    )
    left_out = f"not run, since the process of {check} {child.ending}"
    return {running: ended} | {
        number: Outcome(component=other, check=name, status="skipped", message=left_out)
        for number, (other, name) in enumerate(cases)
        if number > running and other == component
    }


class _Child:
    """A process that runs checks and reports them.

    Attributes
    ----------
    ending : str
        How it ended: "was ended after 60 s, in ...", "died of SIGSEGV", "ended by itself".
    late : bool
        Whether it was ended because it took too long.
    """

    def __init__(
        self, bundle: str, command: Sequence[str], timeout: float, *, leave_out: Sequence[int]
    ) -> None:
        self.ending, self.late = "ended by itself", False
        self._timeout = timeout
        self._output = tempfile.TemporaryFile()  # noqa: SIM115  # closed in __exit__
        self._pipe, pipe = os.pipe()
        numbers = ",".join(map(str, leave_out))
        self._process = subprocess.Popen(
            [*command, bundle, "--pipe", str(pipe), "--leave-out", numbers],
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=subprocess.STDOUT,
            pass_fds=(pipe,),
            start_new_session=True,  # so that processes which it started end with it
        )
        os.close(pipe)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        os.close(self._pipe)
        self._output.close()

    def events(self) -> Iterator[dict[str, Any]]:
        """What the child reports, until it ends or is silent for too long."""
        waiting = b""
        while True:
            if not select.select([self._pipe], [], [], self._timeout)[0]:
                self.late = True
                self.ending = f"was ended after {self._timeout:g} s{self._where()}"
                return
            read = os.read(self._pipe, 65536)
            if not read:
                break
            *whole, waiting = (waiting + read).split(b"\n")
            for line in whole:
                yield json.loads(line)
        code = self._process.wait()
        if code < 0:
            place = crash_place(self._printed())
            words = f" {place}" if place.startswith("in ") else f" at {place}" if place else ""
            self.ending = f"died of {signal.Signals(-code).name}{words or self._last_words()}"
        elif code > 0:
            self.ending = f"ended with exit code {code}{self._last_words()}"

    def _where(self) -> str:
        """The function that is running, where the child can still say so."""
        os.kill(self._process.pid, signal.SIGUSR1)
        end = time.monotonic() + _LAST_WORDS
        while time.monotonic() < end:
            stack = self._printed().rpartition("(most recent call first):")[2]
            innermost = re.search(r'File "(.*)", line (\d+) in (\S+)\n', stack)
            if innermost:
                path, line, function = innermost.groups()
                return f", in '{function}' ({path}, line {line})"
            time.sleep(0.02)
        return ""

    def _last_words(self) -> str:
        """The last line that was printed."""
        lines = self._printed().strip().splitlines()
        return f": {lines[-1].strip()}" if lines else ""

    def _printed(self) -> str:
        """The end of what was printed; read so that the child can go on printing."""
        handle = self._output.fileno()
        length = os.fstat(handle).st_size
        return os.pread(handle, _TAIL, max(0, length - _TAIL)).decode("utf-8", "replace")
