"""Text that is safe to print: what a terminal would obey is shown, and how much is bounded."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from moseg_core.untrusted.terminal import (
    LONGEST,
    escaped,
    printable,
    printable_json,
    printable_message,
)

ROOT = Path(__file__).parents[2]

#: By what it would do to a terminal, or to who reads it.
OBEYED = {
    "clears the screen": "\x1b[2J",
    "sets the title": "\x1b]0;owned\x07",
    "sets the title, eight bits": "\x9d0;owned\x9c",
    "moves the cursor, eight bits": "\x9b1A",
    "rings": "\x07",
    "writes over what was said": "all is well\rnothing",
    "deletes": "abc\x08\x08\x08",
    "DEL": "\x7f",
    "a line": "a\nmoseg: wrote r.json",
    "a line, NEL": "a\x85b",
    "a line, LS": "a\u2028b",
    "a paragraph, PS": "a\u2029b",
    "form feed": "\x0c",
    "vertical tab": "\x0b",
    "a tab": "\t",
    "NUL": "\x00",
    "turns around": "\u202egnp.exe",
    "isolates": "\u2066\u2067\u2068\u2069",
    "marks of direction": "\u200e\u200f\u061c",
    "nothing to see": "\u200b\u2060\ufeff\u00ad",
    "tags": "\U000e0041",
    "no letter": "\ufffe",
    "half a pair": "\ud800",
    "a byte of a file name": "\udcf6",
}


@pytest.mark.parametrize("text", OBEYED.values(), ids=OBEYED)
def test_what_a_terminal_obeys_is_shown(text):
    for shown in (printable(text), printable_message(text), escaped(text)):
        assert shown.isprintable()
        assert shown.encode("ascii").decode("unicode_escape") == text


@pytest.mark.parametrize("text", ["", "a b", "größe", "手", "🐎", "é", "[/x] :smile: %s {}"])
def test_what_can_be_read_is_left_alone(text):
    assert printable(text) == printable_message(text) == text


@pytest.mark.parametrize("text", ["x" * 100_000, "\x1b" * 100_000, "é\n" * 50_000])
@pytest.mark.parametrize("longest", [100, LONGEST])
def test_of_a_long_text_the_middle_is_left_out(text, longest):
    shown = printable(text, longest=longest)
    assert len(shown) < longest + 50
    assert "100000 characters" in shown or "characters ...]" in shown
    assert shown[:4] == escaped(text)[:4]
    assert shown[-4:] == escaped(text)[-4:]


def test_a_message_keeps_the_lines_of_its_caret_and_no_others():
    said = "recipe 'a': 'x' in \"x(a)\"\n  x(a)\n  ^"
    assert printable_message(said) == said
    assert printable_message("one\n" + said).count("\n") == 2
    assert printable_message(said + "\n").count("\n") == 0
    assert printable_message("a\n  \x1b\n  ^") == "a\n  \\x1b\n  ^"
    assert printable_message(f"a\n  {'x' * LONGEST}\n  ^").count("\n") == 0


@pytest.mark.parametrize("text", OBEYED.values(), ids=OBEYED)
def test_a_json_document_stays_one(text):
    document = {text: [text, 1]}
    shown = printable_json(json.dumps(document, indent=2, ensure_ascii=False))
    assert shown.replace("\n", "").isprintable()
    assert json.loads(shown) == document


#: What makes text or consoles of rich by itself, and why its text is safe.
OWN_RICH = {
    "moseg_core/cli/console.py": "what all others take it from",
    "moseg_core/cli/plugin.py": "imports no numpy; each line goes through printable",
    "plugins/moseg_benchmark/moseg_benchmark/command.py": "cells go through moseg_core.printable",
    "plugins/moseg_learn/moseg_learn/command.py": "cells go through moseg_core.printable",
}


def test_text_and_consoles_of_rich_are_made_in_one_place():
    sources = [*ROOT.glob("moseg_core/**/*.py"), *ROOT.glob("plugins/*/moseg_*/**/*.py")]
    made = re.compile(r"\b(Text|Console|Markdown|Panel)\(|from_markup|\binput\(")
    found = {
        file.relative_to(ROOT).as_posix()
        for file in sources
        if "import rich" in (text := file.read_text(encoding="utf-8")) or "from rich" in text
        if made.search(text)
    }
    assert found == set(OWN_RICH)
    for file in OWN_RICH:
        consoles = re.findall(r"Console\((?:[^()]|\n)*\)", (ROOT / file).read_text("utf-8"))
        assert all("markup=False" in made for made in consoles if "file=" in made)
