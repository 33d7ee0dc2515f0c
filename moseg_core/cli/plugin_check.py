"""``moseg plugin check``: the contract checks on an installed bundle, failures first.

Nothing of the bundle is imported here; it runs in a process of its own
(:mod:`moseg_core.testing.processes.watching_parent`).
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, get_args

from rich.console import Console
from rich.padding import Padding
from rich.table import Table

from moseg_core.cli.console import cell, console, lines_of, print_json
from moseg_core.errors import PluginError
from moseg_core.testing import CHECKS
from moseg_core.testing.processes.watching_parent import Announce, BundleReport, watch_checks
from moseg_core.testing.run import Outcome, Status, load_checks


def run_check(bundle: str, *, as_json: bool, timeout: float, timed: bool = False) -> None:
    """Print what became of each check, and how long components take where that is asked.

    Raises
    ------
    PluginError
        Some failed.
    """
    with _status() as announce:
        report = watch_checks(bundle, timeout=timeout, report=announce)
    load_checks()
    seconds = timeout * max(1, len({found.component for found in report.outcomes}))
    if as_json:
        more = {"times": _times(bundle, seconds)} if timed else {}
        print_json(_document(report) | more)
    else:
        _print(report, console(sys.stdout))
        if timed:
            times = _times(bundle, seconds)
            print()
            console(sys.stdout).print(_times_table(times))
    failed = sum(found.status == "failed" for found in report.outcomes)
    if failed:
        raise PluginError(
            f"bundle '{bundle}' of {report.distribution} does not pass the contract checks:"
            f" {_counted(failed, 'check')} failed"
        )


@contextmanager
def _status() -> Iterator[Announce]:
    """Show which check is being made, on a terminal only."""
    if not sys.stderr.isatty():
        yield lambda done, count, which: None
        return
    with console(sys.stderr).status(cell("starting")) as shown:
        yield lambda done, count, which: shown.update(cell(f"{done} of {count} done; {which}"))


def _print(report: BundleReport, out: Console) -> None:
    """Failures one by one, then everything else in short."""
    by_status = {
        status: [found for found in report.outcomes if found.status == status]
        for status in get_args(Status)
    }
    for status, headline in (("failed", "failed"), ("warned", "newer than the bundle, and failed")):
        if by_status[status]:
            out.print(headline, style="bold red" if status == "failed" else "bold yellow")
        for found in by_status[status]:
            out.print(_failure(found))
            out.print()
    for status, headline in (
        ("expected", "failed, as expected"),
        ("skipped", "skipped"),
    ):
        if by_status[status]:
            out.print(headline, style="bold")
            out.print(_reasons(by_status[status]))
            out.print()
    if by_status["passed"]:
        out.print("passed", style="bold green")
        out.print(_by_component(by_status["passed"]))
        out.print()
    counts = ", ".join(f"{len(found)} {status}" for status, found in by_status.items() if found)
    components = len({found.component for found in report.outcomes})
    out.print(
        f"{report.bundle} ({report.distribution}): {_counted(len(report.outcomes), 'check')} on"
        f" {_counted(components, 'component')}: {counts or 'none apply'}",
        style="bold",
    )


def _failure(found: Outcome) -> Padding:
    """A failure with all that helps to mend it."""
    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    table.add_row("check", cell(f"{found.check} on {found.component}", "bold"))
    table.add_row("what", lines_of(found.message))
    table.add_row("why", lines_of(CHECKS[found.check].why))
    if found.fix:
        table.add_row("fix", lines_of(found.fix))
    return Padding(table, (0, 0, 0, 2))


def _reasons(outcomes: Sequence[Outcome]) -> Padding:
    """A line for each reason, with the checks that it is given for."""
    reasons: dict[tuple[str, str], list[str]] = {}
    for found in outcomes:
        reasons.setdefault((found.component, found.message), []).append(found.check)
    table = Table(box=None, pad_edge=False, show_header=False)
    for (component, message), checks in reasons.items():
        table.add_row(component, ", ".join(checks), lines_of(message))
    return Padding(table, (0, 0, 0, 2))


def _by_component(outcomes: Sequence[Outcome]) -> Padding:
    table = Table(box=None, pad_edge=False, show_header=False)
    for component, count in Counter(found.component for found in outcomes).items():
        table.add_row(component, _counted(count, "check"))
    return Padding(table, (0, 0, 0, 2))


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _times(bundle: str, seconds: float) -> list[dict[str, Any]]:
    """What :mod:`moseg_core.testing.timing` says of a bundle, in a process of its own."""
    command = [sys.executable, "-m", "moseg_core.testing.timing", bundle]
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
            timeout=seconds,
        )
    except subprocess.TimeoutExpired:
        raise PluginError(
            f"the components of '{bundle}' could not be timed in {seconds:g} s; give more by"
            " --timeout"
        ) from None
    lines = done.stdout.splitlines()
    if done.returncode or not lines:
        words = (done.stderr.strip().splitlines() or ["the process ended"])[-1]
        raise PluginError(f"the components of '{bundle}' could not be timed: {words}")
    # Components may print; the report is the last line.
    found: list[dict[str, Any]] = json.loads(lines[-1])
    return found


def _times_table(times: Sequence[Mapping[str, Any]]) -> Table:
    """Microseconds of a call, by component."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("us per call", overflow="fold")
    table.add_column("declared")
    for heading in ("zoo", "samples", "calls"):
        table.add_column(heading, justify="right")
    table.add_column("")
    for timing in times:
        zoo, samples = (
            "" if timing[group] is None else f"{timing[group]:.0f}" for group in ("zoo", "samples")
        )
        table.add_row(
            f"{timing['kind']} {timing['component']}",
            timing["declared"],
            zoo,
            samples,
            str(timing["calls"]),
            timing["note"],
        )
    return table


def _document(report: BundleReport) -> dict[str, Any]:
    return {
        "bundle": report.bundle,
        "distribution": report.distribution,
        "passed": report.passed,
        "counts": Counter(found.status for found in report.outcomes),
        "outcomes": [
            {
                "component": found.component,
                "check": found.check,
                "status": found.status,
                "message": found.message,
                "why": CHECKS[found.check].why,
                "fix": found.fix,
            }
            for found in report.outcomes
        ],
    }
