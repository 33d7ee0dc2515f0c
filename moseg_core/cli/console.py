"""Printing: tables on stdout, messages and progress on stderr.

Whatever is printed goes through :mod:`moseg_core.untrusted.terminal`, so that no text from a file
steers the terminal, and none is read as rich's markup: the other modules of the command line take
their tables and cells from here and make no consoles of their own.

Colour and progress bars appear on a terminal only, elsewhere a line every 30 s; rich honours
``NO_COLOR``. Both come from whoever reports, not from a thread: a search forks worker processes,
and a fork copies locks that other threads hold, but not the threads that would let go of them.
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO

from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bars
from rich.table import Table
from rich.text import Text

from moseg_core.cli.waiting import wipe
from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Progress, Report
from moseg_core.problem.aggregate import Evaluation
from moseg_core.shape.compiled import telling_of_compilation
from moseg_core.untrusted.terminal import printable, printable_json, printable_message

_WIDTH_OFF_TERMINAL = 120
#: Seconds between two drawings of the progress bars.
_REDRAWN_EVERY = 0.1
#: Seconds between two lines of progress off a terminal.
_LINE_EVERY = 30.0


class _PlainConsole(Console):
    """A console that shows texts as they are: no markup, no emoji by name, nothing to obey."""

    def render_str(self, text: str, **options: Any) -> Text:
        """A text given as such, also as a cell or heading of a table: one line, as any is here."""
        return super().render_str(printable(text), **{**options, "markup": False, "emoji": False})


def console(stream: TextIO) -> Console:
    """A console on stdout or stderr that keeps lines whole off a terminal."""
    width = None if stream.isatty() else _WIDTH_OFF_TERMINAL
    return _PlainConsole(
        file=stream, width=width, highlight=False, markup=False, emoji=False, soft_wrap=False
    )


def cell(text: object, style: str = "") -> Text:
    r"""A text for a table or a line with a style of its own; safe to print.

    Examples
    --------
    >>> cell("[/x]").plain, cell("leg\x1b[2J").plain
    ('[/x]', 'leg\\x1b[2J')
    """
    return Text(printable(str(text)), style)


def lines_of(text: str) -> Text:
    """A text of several lines, such as a docstring or a heading; safe to print."""
    return Text("\n".join(map(printable, text.split("\n"))))


def print_line(text: str = "") -> None:
    """Print a line on stdout."""
    print(printable(text))


def print_text(text: str) -> None:
    """Write a document that may be meant for a file: as it is, but for a terminal safe."""
    sys.stdout.write(lines_of(text.expandtabs()).plain if sys.stdout.isatty() else text)


@contextmanager
def others_on_stderr() -> Iterator[None]:
    """While this lasts, what is written on standard output below Python goes to standard error.

    Libraries in other languages print there, and programs that components start; a command that
    prints nothing itself meanwhile keeps its output free of that.
    """
    if sys.stdout is not None:
        sys.stdout.flush()
    try:
        kept = os.dup(1)
        os.dup2(2, 1)
    except OSError:  # one of the two is closed
        yield
        return
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def print_json(document: Any) -> None:
    """Print a JSON document on stdout."""
    print(json_text(document))


def json_text(document: Any) -> str:
    """A JSON document for stdout, in which a terminal finds nothing to obey."""
    # What cannot be said in the terminal's letters is escaped by JSON, not by the stream.
    wide = (sys.stdout.encoding or "utf-8").lower().startswith("utf")
    return printable_json(json.dumps(document, indent=2, ensure_ascii=not wide, allow_nan=False))


def message(text: str, *, quiet: bool = False) -> None:
    """Print a line on stderr, with the two of a caret where the text ends with them."""
    if not quiet:
        wipe()
        print(f"moseg: {printable_message(text)}", file=sys.stderr)


def terms_table(evaluation: Evaluation) -> Table:
    """What each term adds to the cost, with a row for every part that it looks at."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("term", overflow="fold")
    table.add_column("parts", overflow="fold")
    table.add_column("value", justify="right")
    table.add_column("weight", justify="right")
    table.add_column("cost", justify="right")
    table.add_column("share", justify="right")
    total = sum(abs(term.weighted) for term in evaluation.terms)
    for term in evaluation.terms:
        name = term.text.partition("(")[0]
        if "(" in term.text:
            name += term.text.rpartition(")")[2]  # where it is evaluated
        for call in term.calls:
            labels = ", ".join(call.labels) if call.labels else "all"
            if call.value is None:
                table.add_row(name, labels, "left out", f"{term.weight:g}", "", "")
                continue
            cost = term.weight * call.value
            share = (
                f"{100 * abs(cost) / total:.1f} %" if total >= 5e-7 else ""
            )  # else all print as 0
            table.add_row(
                name, labels, f"{call.value:.6f}", f"{term.weight:g}", f"{cost:.6f}", share
            )
    table.add_section()
    table.add_row("total", "", "", "", f"{evaluation.cost.value:.6f}", "", style="bold")
    return table


def print_terms(evaluation: Evaluation) -> None:
    """Print what each term adds to the cost, and what disagrees most in each part."""
    console(sys.stdout).print(terms_table(evaluation))
    for line in disagreement_lines(evaluation):
        print_line(line)


def disagreement_lines(evaluation: Evaluation) -> list[str]:
    """A heading, and a line for each part; nothing where no objective tells what disagrees."""
    found = evaluation.disagreements
    lines = [f"{', '.join(labels) or 'all'}: {detail}" for labels, detail in found.items()]
    return ["", "what disagrees most in each part:", *lines] if lines else []


class _BestByStage:
    """The best cost that was reported in each stage: each start tells of its own alone.

    Costs of different stages do not compare: a search is on super-elements, a polish on more.
    """

    def __init__(self) -> None:
        self._best: dict[str, Cost] = {}

    def cost_text(self, progress: Progress) -> str:
        """The best so far in words, with what is reported now; empty where there is none."""
        stage = progress.stage
        if progress.best is not None:
            self._best[stage] = min(self._best.get(stage, progress.best), progress.best)
        if stage not in self._best:
            return ""
        best = self._best[stage]
        return f"best cost {best.value:.5g}" + (f" ({best.empty} empty)" if best.empty else "")


def progress_lines(clock: Callable[[], float] = time.monotonic) -> Report:
    """A function to report progress to, which prints a line on stderr now and then.

    For logs: a run that says nothing for an hour cannot be told from one that hangs, and an
    optimizer that never ends is seen by its count.

    Parameters
    ----------
    clock : callable
        The time in seconds.
    """
    began = spoke = clock()
    best = _BestByStage()

    def report(progress: Progress) -> bool:
        nonlocal spoke
        now, cost = clock(), best.cost_text(progress)
        if now - spoke < _LINE_EVERY:
            return False
        spoke = now
        share = "" if progress.fraction is None else f"{100 * progress.fraction:.0f} %"
        said = [f"{progress.stage} {progress.done}", progress.place, share, cost]
        message(f"{', '.join(part for part in said if part)} ({now - began:.0f} s so far)")
        return False

    return report


@contextmanager
def announcing_compilation(*, quiet: bool) -> Iterator[None]:
    """Within this context, whoever waits at a terminal is told when kernels are compiled.

    Logs are not: what they hold would depend on what ran before.
    """
    if quiet or not sys.stderr.isatty():
        yield
        return
    with telling_of_compilation(lambda: message("compiling kernels once, some seconds")):
        yield


@contextmanager
def progress_reporter(*, quiet: bool) -> Iterator[Report]:
    """A function to report progress to: bars on a terminal, a line now and then elsewhere."""
    if quiet or not sys.stderr.isatty():
        yield (lambda progress: False) if quiet else progress_lines()
        return
    bars = Bars(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.fields[cost]}", markup=False),
        TimeElapsedColumn(),
        console=console(sys.stderr),
        transient=True,
        auto_refresh=False,
    )
    tasks: dict[str, Any] = {}
    drawn = -math.inf
    best = _BestByStage()
    # What comes before the first report, such as super-elements, takes seconds on a large shape.
    preparing = bars.add_task("preparing the search", total=None, cost="")

    def report(progress: Progress) -> bool:
        nonlocal drawn
        bars.update(preparing, visible=False)
        is_new = progress.stage not in tasks
        if is_new:
            before = progress.stage.rpartition(": ")[0]
            for stage, earlier in tasks.items():  # a new stage: those before it are done
                # Of other levels, or other numbers of parts, there may be more than lines.
                shown = stage.rpartition(": ")[0] == before
                bars.update(earlier, total=1.0, completed=1.0, visible=shown)
                bars.stop_task(earlier)
            tasks[progress.stage] = bars.add_task("", total=None, cost="")
        fraction, words = progress.fraction, f"{progress.stage} {progress.done}"
        bars.update(
            tasks[progress.stage],
            description=printable(", ".join(said for said in (words, progress.place) if said)),
            total=None if fraction is None else 1.0,
            completed=fraction or 0.0,
            cost=best.cost_text(progress),
        )
        if is_new or time.monotonic() - drawn >= _REDRAWN_EVERY:  # short stages are seen too
            bars.refresh()
            drawn = time.monotonic()
        return False

    with bars:
        bars.refresh()
        yield report
