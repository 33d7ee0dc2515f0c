"""The child that runs the checks for ``moseg plugin check``: it may hang or die, and be replaced.

Started by :mod:`moseg_core.testing.processes.watching_parent` as ``python -m
moseg_core.testing.processes.reporting_child``. The child reports what happens line by line, as
JSON, through a pipe of its own, since what a component prints must not get in between::

    {"event": "cases", "cases": [["bundle:name", "check-id"], ...],
     "distribution": "moseg-vessels 0.1.0"}
    {"event": "start", "case": 0}
    {"event": "outcome", "case": 0, "status": "passed", "message": "", "fix": ""}
    {"event": "refused", "message": "unknown bundle ...", "code": 2}

On the signal SIGUSR1 the child writes to stderr which function is running.
"""

from __future__ import annotations

import argparse
import faulthandler
import json
import os
import signal
from collections.abc import Callable, Collection, Sequence
from typing import Any

from moseg_core.components.discovery.registry import registry
from moseg_core.errors import MosegError
from moseg_core.testing.run import Case, cases_of


def run_and_report(
    cases: Sequence[Case], write: Callable[..., None], *, leave_out: Collection[int] = ()
) -> None:
    """Run cases one by one, with a report before and after each.

    Parameters
    ----------
    cases : sequence of Case
    write : callable
        Receives ``event=`` and what belongs to it.
    leave_out : collection of int
        Cases that are not to be run.
    """
    for number, case in enumerate(cases):
        if number in leave_out:
            continue
        write(event="start", case=number)
        found = case.outcome()
        fields = {key: getattr(found, key) for key in ("status", "message", "fix")}
        write(event="outcome", case=number, **fields)


def main(arguments: Sequence[str] | None = None) -> None:
    """Check a bundle and report what happens.

    Parameters
    ----------
    arguments : sequence of str, optional
        ``BUNDLE --pipe FD --leave-out 0,1,2``.
    """
    parser = argparse.ArgumentParser()
    parser.add_argument("bundle")
    parser.add_argument("--pipe", type=int, required=True)
    parser.add_argument("--leave-out", default="")
    given = parser.parse_args(arguments)
    faulthandler.enable()
    faulthandler.register(signal.SIGUSR1, all_threads=False)
    with os.fdopen(given.pipe, "w", encoding="utf-8") as pipe:

        def write(**fields: Any) -> None:
            print(json.dumps(fields), file=pipe, flush=True)

        try:
            cases = cases_of(given.bundle)
        except MosegError as error:
            write(event="refused", message=str(error), code=error.exit_code)
            return
        known = [[case.subject.component.id, case.check.id] for case in cases]
        (found,) = (bundle for bundle in registry().bundles if bundle.name == given.bundle)
        write(event="cases", cases=known, distribution=f"{found.distribution} {found.version}")
        leave_out = {int(number) for number in given.leave_out.split(",") if number}
        run_and_report(cases, write, leave_out=leave_out)


if __name__ == "__main__":
    main()
