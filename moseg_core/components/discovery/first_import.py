"""The first import of a bundle, in a child process: a bundle may take its process along.

Whoever asks what is installed imports all bundles, and a bundle can do anything then: end the
process, crash it, hang, change the working directory or the handlers of signals. So a bundle that
is new, or whose files have changed, is first imported by a child
(:mod:`moseg_core.components.discovery.trial`), whose fate decides: the bundle is *set aside* with
the reason, and never imported here, or it is imported as ever. One child tries all that are new;
where one ends it, another goes on with the rest. What was found is remembered
(:mod:`moseg_core.components.discovery.known_bundles`), so that bundles that are known cost a look
at their files; where nothing can be remembered, every process tries them anew, which takes some
tenths of a second.

Where no child can be started (on Windows, and in programs that have Python in them) bundles are
imported as they are.
"""

from __future__ import annotations

import json
import os
import select
import signal
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import IO, Any

from moseg_core.components.discovery.distributions import Claim
from moseg_core.components.discovery.known_bundles import (
    Verdict,
    files_of_package,
    folders_of_packages,
    identity,
    read_known,
    remember,
    stamps,
)

IN_TRIAL = "MOSEG_IN_TRIAL"
"""Environment variable of the child: what is imported there starts no child of its own."""

SOUND = 86
"""The exit code of a child that came to its end; any other was a bundle's wish."""

TIMEOUT = 20.0
"""Seconds that a bundle may take to be imported; light ones take some hundredths."""

_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv.pop());"
    " from moseg_core.components.discovery.trial import main; main(sys.argv[1:])"
)


def verdicts(claims: Sequence[Claim], *, timeout: float = TIMEOUT) -> list[Verdict]:
    """What the first import of bundles came to, remembered or found out now.

    Parameters
    ----------
    claims : sequence of Claim
        Of bundles that are to be imported, found on this process's ``sys.path``.
    timeout : float
        Seconds that the import of each may take.

    Returns
    -------
    list of Verdict
        In the order of claims; nothing is said against any where no child can be started.
    """
    if not claims or not can_try():
        return [Verdict()] * len(claims)
    names = [identity(claim) for claim in claims]
    known = read_known(names)
    new = {name: claim for name, claim in zip(names, claims, strict=True) if name not in known}
    if new:
        tried = try_bundles(list(new.values()), timeout=timeout)
        found = dict(zip(new, tried, strict=True))
        remember(found)
        known |= found
    return [known[name] for name in names]


def can_try() -> bool:
    """Whether a child can be started: there is a Python, and this is no such child itself."""
    program = os.path.basename(sys.executable or "").lower()
    return (
        os.name == "posix"
        and program.startswith(("python", "pypy"))
        and not os.environ.get(IN_TRIAL)
    )


def try_bundles(claims: Sequence[Claim], *, timeout: float = TIMEOUT) -> list[Verdict]:
    """Have children import bundles: one child, and one more for each bundle that ends one.

    Parameters
    ----------
    claims : sequence of Claim
    timeout : float
        Seconds that the import of each may take.
    """
    found: dict[int, Verdict] = {}
    while left := [k for k in range(len(claims)) if k not in found]:
        tried = _tried([claims[k] for k in left], timeout)
        found |= {left[k]: verdict for k, verdict in tried.items()}
    return [_with_surroundings(claims[k], found[k]) for k in range(len(claims))]


def _with_surroundings(claim: Claim, verdict: Verdict) -> Verdict:
    """A verdict with the stamps of all that it hangs on."""
    files = {*verdict.files}
    if verdict.problem:
        files |= {*files_of_package(claim), *folders_of_packages()}
    return replace(verdict, files=stamps(files))


def _tried(claims: Sequence[Claim], timeout: float) -> dict[int, Verdict]:
    """What one child finds, by the number of the bundle: of all, or up to the one that ends it."""
    import tempfile

    found: dict[int, Verdict] = {}
    running: int | None = None
    with tempfile.TemporaryFile() as output:
        child = _Child(claims, output, timeout)
        try:
            for event in child.events():
                if event["event"] == "copied":
                    return {**found, event["index"]: _blamed(claims, event, "copies the process")}
                running = event["index"] if event["event"] == "begin" else None
                if running is None:
                    doing = event["problem"]
                    found[event["index"]] = Verdict(
                        problem=f"importing '{claims[event['index']].point.value}' {doing}"
                        if doing
                        else "",
                        printed=event["printed"],
                        files=dict.fromkeys(event["files"], (0, 0)),
                    )
                    if doing:
                        return found
            ending = child.ending()
        finally:
            child.kill()
        if running is not None:
            return {**found, running: _blamed(claims, {"index": running}, ending)}
        if ending and len(claims) == 1:
            return {0: _blamed(claims, {"index": 0}, f"{ending}, as the process came to its end")}
    if ending:  # somebody's doing at exit: whose is seen when each is tried alone
        for k, claim in enumerate(claims):
            found[k] = _tried([claim], timeout)[0]
    # What the child did not find is gone meanwhile.
    return {k: found.get(k, Verdict()) for k in range(len(claims))}


def _blamed(claims: Sequence[Claim], event: Mapping[str, Any], doing: str) -> Verdict:
    return Verdict(problem=f"importing '{claims[event['index']].point.value}' {doing}")


class _Child:
    """A process that imports bundles."""

    def __init__(self, claims: Sequence[Claim], output: IO[bytes], timeout: float) -> None:
        import subprocess

        self._timeout, self._output, self._late = timeout, output, False
        self._pipe, theirs = os.pipe()
        names = json.dumps([identity(claim) for claim in claims])
        path = json.dumps([path or os.getcwd() for path in sys.path])
        arguments = [str(theirs), str(timeout), names, path]
        self._process = subprocess.Popen(
            [sys.executable, "-c", _START, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=output,
            pass_fds=(theirs,),
            env={**os.environ, IN_TRIAL: "1"},
            start_new_session=True,  # Ctrl-C is for this process, and what it started ends with it
        )
        os.close(theirs)

    def events(self) -> Iterator[dict[str, Any]]:
        """What the child reports, until it ends or is silent for too long."""
        waiting = b""
        while True:
            if not select.select([self._pipe], [], [], self._timeout)[0]:
                self._late = True
                return
            read = os.read(self._pipe, 1 << 16)
            if not read:
                return
            *whole, waiting = (waiting + read).split(b"\n")
            for line in whole:
                yield json.loads(line)

    def ending(self) -> str:
        """What ended the child, in words that follow on "importing it"; empty where all is well."""
        from moseg_core.components.crash_dump import crash_place

        if not self._late:
            import subprocess

            try:
                code = self._process.wait(self._timeout)
            except subprocess.TimeoutExpired:
                self._late = True
        self._output.seek(0)
        place = crash_place(self._output.read().decode("utf-8", "replace"))
        where = f" ({place})" if place else ""
        if self._late:
            return f"took more than {self._timeout:g} s{where}"
        if code < 0:
            return f"died of {_signal_name(-code)}{where}"
        return "" if code == SOUND else f"ended the process with exit code {code}{where}"

    def kill(self) -> None:
        """End it, and whatever it has started."""
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        os.close(self._pipe)


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:  # a real-time signal
        return f"signal {number}"
