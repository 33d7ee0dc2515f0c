"""The page of commands is what the parser says; commands on other pages are understood by it."""

from __future__ import annotations

import re
import shlex
from functools import cache
from pathlib import Path

import pytest
from cyclopts import App, CycloptsError

from tools.make_cli_docs import PAGE, commands, page

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("plugins/*/README.md")])
PAGES = [page for page in PAGES if "generated" not in page.parts]  # what the site is made of


def test_the_page_is_up_to_date():
    assert PAGE.read_text() == page(), "run: python tools/make_cli_docs.py"


def commands_of(text: str) -> list[str]:
    """What is asked of moseg in indented lines and blocks of shell, without redirections."""
    text = re.sub(r" \\\n\s+", " ", text)
    blocks = re.findall(r"^```(?:sh|bash|shell|console)\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    lines = re.findall(r"^ {4}(?:\$ )?moseg +(.*)$", text, re.MULTILINE)
    for block in blocks:
        lines += re.findall(r"^(?:\$ )?moseg +(.*)$", block, re.MULTILINE)
    return [re.split(r"\s+#\s|\s+[>|]\s", line)[0].strip() for line in lines]


def test_commands_are_told_from_what_stands_around_them():
    text = (
        "    moseg recipes a > b.toml  # c\n```sh\n$ moseg plot x \\\n    -o y.svg\n```\nmoseg is\n"
    )
    assert commands_of(text) == ["recipes a", "plot x -o y.svg"]


@cache
def parser() -> App:
    return commands()


def complaint(command: str) -> str | None:
    """What the parser says against a command line."""
    try:
        parser().parse_args(shlex.split(command), exit_on_error=False, print_error=False)
    except CycloptsError as error:
        return f"moseg {command}: {error}"
    return None


@pytest.mark.parametrize("command", ["segment a.ply --recipy b", "segmen a.ply", "plot"])
def test_a_command_that_is_wrong_is_found(command):
    assert complaint(command)


def test_commands_in_the_documentation_are_understood():
    shown = {c for path in PAGES for c in commands_of(path.read_text()) if path != PAGE}
    assert len(shown) > 60
    assert [said for command in sorted(shown) if (said := complaint(command))] == []
