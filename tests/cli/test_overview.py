"""What ``moseg`` says of itself without its parser."""

from __future__ import annotations

import io
import os
import subprocess
import sys

import pytest

from moseg_core.cli.app import app
from moseg_core.cli.overview import ENTRIES, FROM_BUNDLES, draw_overview, overview_of
from moseg_core.components.discovery.registry import registry

COMPLETION = "--install-completion"


def words(text: str) -> list[str]:
    return [word for word in text.split() if word.strip("╭╮╰╯─│+-|")]


@pytest.mark.parametrize("width", [40, 57, 80, 200])
def test_it_says_what_the_parser_would_have_said(width, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", str(width))
    for name in FROM_BUNDLES:  # which other tests may have asked for in this process
        if name in app:
            del app[name]
    own = {name: ENTRIES[name] for name in ENTRIES if name not in (*FROM_BUNDLES, COMPLETION)}
    monkeypatch.setattr("moseg_core.cli.overview.ENTRIES", own)
    app.help_print([])
    assert words(draw_overview(width)) == words(capsys.readouterr().out)
    assert overview_of(["--version"], sys.stdout) == app.version


def test_it_says_of_bundles_what_they_say():
    summaries = {c.spec.name: c.spec.summary for c in registry().components("command")}
    for name, package in FROM_BUNDLES.items():
        if name in summaries:
            assert ENTRIES[name] == summaries[name]
            assert registry().find("command", name).spec.target.startswith(f"{package}.")
            assert f" {name} " in draw_overview(80)


@pytest.mark.parametrize("width", [10, 40, 80])
@pytest.mark.parametrize("unicode", [True, False])
def test_the_frame_is_as_wide_as_asked(width, unicode):
    lines = draw_overview(width, unicode=unicode).splitlines()
    framed = [line for line in lines if line[:1] in "╭│╰+|" and line]
    assert len(framed) >= 12
    assert {len(line) for line in framed} == {max(width, 40)}
    assert all(map(str.isascii, lines)) is not unicode


@pytest.mark.parametrize(
    ("arguments", "answered"),
    [
        ([], True),
        (["-h"], True),
        (["--help"], True),
        (["--version"], True),
        (["segment"], False),
        (["--help", "segment"], False),
        (["segment", "--help"], False),
    ],
)
def test_whatever_names_a_command_is_the_parsers(arguments, answered):
    assert (overview_of(arguments, io.StringIO()) is not None) is answered


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_only_a_terminal_gets_colours_and_only_where_it_wants_them(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b[36msegment" in overview_of([], Terminal())
    assert "\x1b" not in overview_of([], io.StringIO())
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in overview_of([], Terminal())


def test_the_command_line_answers_without_its_parser():
    code = (
        "import sys, moseg_core.cli\ntry:\n    moseg_core.cli.main(['--help'])\n"
        "finally:\n    print({'cyclopts', 'rich'} & set(sys.modules))\n"
    )
    environment = os.environ | {"PYTHONIOENCODING": "ascii", "COLUMNS": "80"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0
    assert done.stdout == draw_overview(80, unicode=False) + "\nset()\n"
