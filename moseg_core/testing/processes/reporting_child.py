"""The process in which ``moseg plugin check`` runs a bundle: it may hang or die, and be replaced.

Started by :mod:`moseg_core.testing.processes.watching_parent` as ``python -m
moseg_core.testing.processes.reporting_child``. What happens is told line by line, as JSON, through
a pipe of its own, since what a component prints must not get in between::

    {"event": "cases", "cases": [["bundle:name", "check-id"], ...],
     "distribution": "moseg-vessels 0.1.0"}
    {"event": "start", "case": 0}
    {"event": "outcome", "case": 0, "status": "passed", "message": "", "fix": ""}
    {"event": "refused", "message": "unknown bundle ...", "code": 2}

Asked by the signal SIGUSR1 it writes on stderr where it is.
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

Tell = Callable[..., None]


def run_cases_aloud(cases: Sequence[Case], tell: Tell, *, leave_out: Collection[int] = ()) -> None:
    """Run cases one by one, telling before and after each.

    Parameters
    ----------
    cases : sequence of Case
    tell : callable
        Receives ``event=`` and what belongs to it.
    leave_out : collection of int
        Cases that are not to be run.
    """
    for number, case in enumerate(cases):
        if number in leave_out:
            continue
        tell(event="start", case=number)
        found = case.outcome()
        tell(
            event="outcome",
            case=number,
            status=found.status,
            message=found.message,
            fix=found.fix,
        )


def main(arguments: Sequence[str] | None = None) -> None:
    """Check a bundle and tell what happens.

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

        def tell(**said: Any) -> None:
            print(json.dumps(said), file=pipe, flush=True)

        try:
            cases = cases_of(given.bundle)
        except MosegError as error:
            tell(event="refused", message=str(error), code=error.exit_code)
            return
        known = [[case.subject.component.id, case.check.id] for case in cases]
        (found,) = (bundle for bundle in registry().bundles if bundle.name == given.bundle)
        tell(event="cases", cases=known, distribution=f"{found.distribution} {found.version}")
        leave_out = {int(number) for number in given.leave_out.split(",") if number}
        run_cases_aloud(cases, tell, leave_out=leave_out)


if __name__ == "__main__":
    main()
