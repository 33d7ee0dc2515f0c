"""Progress on a terminal: bars are drawn, and no thread runs where worker processes are forked."""

from __future__ import annotations

import json
import os
import pty
import subprocess
import sys
from textwrap import dedent

import pytest

from moseg_core.cli.console import progress_reporter
from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Progress

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
    assert "wrote" in printed
    assert out.exists()


@pytest.mark.parametrize("quiet", [False, True])
def test_nothing_is_drawn_off_a_terminal(capsys, quiet):
    with progress_reporter(quiet=quiet) as report:
        assert report(Progress(stage="search", done=1, best=Cost(0, 1.0))) is False
    assert capsys.readouterr().err == ""
