"""Printing: what goes where, and what a terminal is shown besides.

Progress bars are drawn on a terminal only, and no thread runs where worker processes are forked.
"""

from __future__ import annotations

import io
import json
import os
import pty
import re
import subprocess
import sys
from textwrap import dedent

import pytest
from numba import njit

from moseg_core.cli.console import (
    announcing_compilation,
    console,
    disagreement_lines,
    message,
    others_on_stderr,
    progress_lines,
    progress_reporter,
    terms_table,
)
from moseg_core.components.cost import Cost
from moseg_core.components.detail import Detail
from moseg_core.components.protocols import Progress
from moseg_core.language import Target
from moseg_core.problem.aggregate import CallValue, Evaluation, TermValue

#: ``moseg`` with a record of the threads that were alive at every fork, the main one left out.
WATCHED = """
    import json, os, sys, threading
    from moseg_core.cli import main

    forks = []
    os.register_at_fork(
        before=lambda: forks.append([thread.name for thread in threading.enumerate()[1:]])
    )
    try:
        main(sys.argv[2:])
    finally:
        with open(sys.argv[1], "w") as file:
            json.dump(forks, file)
"""

LEVELS = """
    labels = ["handle", "head"]
    minimize = "3*narrow(handle) + perpendicular(handle, head)"

    [parts.head]
    labels = ["face", "claw"]
    minimize = "compact(face)"
"""


def on_a_terminal(words):
    """Exit code of a program, and what it printed on a terminal."""
    ours, theirs = pty.openpty()
    with subprocess.Popen(words, stdin=theirs, stdout=theirs, stderr=theirs) as process:
        os.close(theirs)
        printed = b""
        while True:
            try:
                piece = os.read(ours, 65536)
            except OSError:  # Linux's way to say that nobody holds the other end any more
                break
            if not piece:
                break
            printed += piece
        os.close(ours)
    return process.returncode, printed.decode()


def test_no_thread_runs_where_workers_are_forked_on_a_terminal(mallet, tmp_path):
    recipe, forks = tmp_path / "levels.toml", tmp_path / "forks.json"
    recipe.write_text(dedent(LEVELS), encoding="utf-8")
    out = tmp_path / "mallet.json"
    words = ("segment", mallet, "--recipe", recipe, "--restarts", 2, "--workers", 2, "-o", out)
    code, printed = on_a_terminal(
        [sys.executable, "-c", dedent(WATCHED), forks, *(str(word) for word in words)]
    )
    assert code == 0, printed
    # Two processes for each of two levels; by the second, terms were evaluated in this process.
    assert json.loads(forks.read_text()) == [[]] * 4
    assert "\x1b[?25l" in printed  # the cursor is hidden while bars are drawn
    assert "pattern_search" in printed
    assert printed.startswith("\r\x1b[2Kmoseg: starting ...")  # before anything heavy is imported
    assert "reading mallet.off ..." in printed
    assert "preparing the search" in printed
    assert "start 1 of 2" in printed
    assert "wrote" in printed
    assert f"moseg explain {out}" in printed.splitlines()[-1]
    assert out.exists()


class Terminal(io.StringIO):
    """A stream that says that somebody looks at it."""

    def isatty(self) -> bool:
        return True


def printed(evaluation: Evaluation) -> list[list[str]]:
    """The rows of the table of terms, each as its words."""
    stream = io.StringIO()
    console(stream).print(terms_table(evaluation))
    return [line.split() for line in stream.getvalue().splitlines() if line.strip()]


def term(text, weight, *calls):
    values = tuple(CallValue(labels=labels, value=value) for labels, value in calls)
    return TermValue(text=text, objective="acme:f", weight=weight, calls=values, worst=1.0)


def test_each_call_is_a_row_with_its_share():
    terms = (
        term("narrow(leg*) @ mds", 3.0, (("leg1",), 0.5), (("leg2",), None)),
        term("convex_parts", -1.0, ((), 0.5)),
    )
    rows = printed(Evaluation(cost=Cost(0, 1.0), terms=terms))
    assert rows == [
        ["term", "parts", "value", "weight", "cost", "share"],
        ["narrow", "@", "mds", "leg1", "0.500000", "3", "1.500000", "75.0", "%"],
        ["narrow", "@", "mds", "leg2", "left", "out", "3"],
        ["convex_parts", "all", "0.500000", "-1", "-0.500000", "25.0", "%"],
        ["total", "1.000000"],
    ]


def test_shares_of_nothing_are_not_shown():
    rows = printed(Evaluation(cost=Cost(0, 0.0), terms=(term("f(a)", 1.0, (("a",), 1e-9)),)))
    assert rows[1] == ["f", "a", "0.000000", "1", "0.000000"]


def test_what_disagrees_most_in_each_part_is_named_beneath():
    def told(name, cost):
        return Detail(name=name, value=0.09, cost=cost, expected=Target(0.04, 0.01), percent=True)

    def calls(*told_of):
        return tuple(CallValue(labels=(a,), value=1.0, details=d) for a, d in told_of)

    wide = (told("area", 2.0), told("width", 3.0))
    terms = (
        TermValue(
            text="is(leg*)",
            objective="acme:is",
            weight=1.0,
            calls=calls(("leg1", (told("area", 0.0),)), ("leg2", wide)),
            worst=1.0,
        ),
        TermValue(
            text="looks(leg*)",
            objective="acme:looks",
            weight=4.0,
            calls=calls(("leg2", (told("thickness", 1.0),))),
            worst=1.0,
        ),
        TermValue(
            text="-looks",
            objective="acme:looks",
            weight=-1.0,
            calls=(CallValue(labels=(), value=1.0, details=(told("area", 5.0),)),),
            worst=1.0,
        ),
    )
    found = Evaluation(cost=Cost(0, 1.0), terms=terms)
    assert disagreement_lines(found) == [
        "",
        "what disagrees most in each part:",
        "leg2: thickness 9 %, typical 4 ± 1",
    ]
    assert disagreement_lines(Evaluation(cost=Cost(0, 1.0), terms=terms[2:])) == []


def test_lines_stay_whole_where_nobody_looks():
    assert console(io.StringIO()).width == 120
    assert console(Terminal()).width != 120 or sys.stdout.isatty()


def test_messages_go_to_stderr_unless_it_is_to_be_quiet(capsys):
    message("one")
    message("two", quiet=True)
    assert capsys.readouterr() == ("", "moseg: one\n")


@pytest.mark.parametrize("quiet", [False, True])
def test_progress_is_shown_on_a_terminal_only(monkeypatch, quiet):
    for stream in (io.StringIO(), Terminal()):
        monkeypatch.setattr(sys, "stderr", stream)
        with progress_reporter(quiet=quiet) as report:
            for done, best in ((1, None), (2, Cost(1, 0.25))):
                assert report(Progress(stage="k-means", done=done, best=best)) is False
            assert report(Progress(stage="polish", done=7, fraction=0.5)) is False
        shown = stream.getvalue()
        assert bool(shown) == (stream.isatty() and not quiet)
        if shown:
            assert "k-means 2" in shown
            assert "cost 0.25 (1 empty)" in shown
            assert "polish 7" in shown


@pytest.mark.parametrize("quiet", [False, True])
def test_compilation_is_announced_on_a_terminal_only(monkeypatch, quiet):
    for stream in (io.StringIO(), Terminal()):
        monkeypatch.setattr(sys, "stderr", stream)
        with announcing_compilation(quiet=quiet):
            njit(lambda number: number + 1)(1)
        expected = "moseg: compiling kernels once, some seconds\n"
        assert stream.getvalue() == (expected if stream.isatty() and not quiet else "")


def test_bars_of_other_numbers_of_parts_make_room(monkeypatch):
    monkeypatch.setattr("moseg_core.cli.console._REDRAWN_EVERY", 0.0)
    monkeypatch.setattr(sys, "stderr", stream := Terminal())
    with progress_reporter(quiet=False) as report:
        for n in range(2, 9):
            for stage in ("kmeans", "pattern_search", "polish"):
                report(Progress(stage=f"{n} parts: {stage}", done=n))
    shown = stream.getvalue()
    assert "2 parts: kmeans" in shown
    assert "8 parts: polish" in shown
    up = "\x1b[1A\x1b[2K"  # what wipes a line before it is drawn anew
    assert max(len(run) for run in re.findall(f"(?:{re.escape(up)})+", shown)) <= 3 * len(up)


def test_the_best_cost_that_is_shown_never_rises(capsys, monkeypatch):
    """Each start tells of its own best alone; a polish, on more elements, of another cost."""
    monkeypatch.setattr("moseg_core.cli.console._LINE_EVERY", 0.0)
    report = progress_lines()
    for stage, best in (
        ("search", Cost(1, 0.1)),
        ("search", Cost(0, 0.3)),
        ("k-means", None),
        ("search", Cost(0, 0.5)),
        ("search", None),
        ("polish", Cost(0, 0.31)),
    ):
        report(Progress(stage=stage, done=1, best=best))
    told = [
        line.partition("best cost ")[2].partition(" ")[0]
        for line in capsys.readouterr().err.split("\n")
    ]
    assert told[:-1] == ["0.1", "0.3", "", "0.3", "0.3", "0.31"]


def test_off_a_terminal_progress_is_a_line_every_half_minute(capsys):
    seconds = [0.0]
    report = progress_lines(lambda: seconds[0])
    for now in (1.0, 29.0, 31.0, 40.0, 60.0, 62.0):
        seconds[0] = now
        best = Cost(1, 0.5) if now < 60 else Cost(0, 0.25)
        fraction = None if now < 60 else 0.5
        told = Progress(
            stage="search", done=int(now), best=best, fraction=fraction, place="start 2 of 8"
        )
        assert report(told) is False
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.splitlines() == [
        "moseg: search 31, start 2 of 8, best cost 0.5 (1 empty) (31 s so far)",
        "moseg: search 62, start 2 of 8, 50 %, best cost 0.25 (62 s so far)",
    ]


def test_quiet_means_no_lines_either(capsys, monkeypatch):
    monkeypatch.setattr("moseg_core.cli.console._LINE_EVERY", 0.0)
    with progress_reporter(quiet=True) as report:
        report(Progress(stage="search", done=1))
    assert capsys.readouterr().err == ""
    with progress_reporter(quiet=False) as report:
        report(Progress(stage="search", done=1))
    assert capsys.readouterr().err.startswith("moseg: search 1 (")


def test_what_is_written_below_python_keeps_out_of_the_output(capfd):
    print("before")
    with others_on_stderr():
        os.write(1, b"a library speaks\n")
    print("after")
    assert capfd.readouterr() == ("before\nafter\n", "a library speaks\n")
