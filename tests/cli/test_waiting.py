"""The line that a terminal shows while nothing else is there to show."""

from __future__ import annotations

import io
import sys

from moseg_core.cli.console import message
from moseg_core.cli.waiting import waiting


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def screen(written: str) -> list[str]:
    """What of a text stands on a screen: each line after its last wipe."""
    return [line.rpartition("\x1b[2K")[2] for line in written.split("\n")]


def test_it_is_there_as_long_as_it_takes(monkeypatch):
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    with waiting("starting"):
        assert screen(terminal.getvalue()) == ["moseg: starting ..."]
        with waiting("reading a\nb\x1b[31m"):  # of a name that would draw over the screen
            assert screen(terminal.getvalue()) == [r"moseg: reading a\nb\x1b[31m ..."]
        assert screen(terminal.getvalue()) == ["moseg: starting ..."]
    assert screen(terminal.getvalue()) == [""]


def test_what_is_printed_takes_its_place(monkeypatch):
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    monkeypatch.setenv("COLUMNS", "30")
    with waiting("reading " + "x" * 99):
        assert len(screen(terminal.getvalue())[0]) == 29
        message("hole")
    assert screen(terminal.getvalue()) == ["moseg: hole", ""]


def test_nobody_else_sees_it(monkeypatch):
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    with waiting("starting", quiet=True):
        pass
    assert terminal.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", stream := io.StringIO())
    with waiting("starting"):
        pass
    assert stream.getvalue() == ""
