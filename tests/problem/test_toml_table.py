"""TOML from anybody: nothing too long, too deep or too large, and no time that grows by squares."""

from __future__ import annotations

import tomllib

import pytest

from moseg_core.errors import UsageError
from moseg_core.problem.toml_table import MOST_BYTES, read_table

GOOD = (
    "# A comment with [[[ and a.b.c\n"
    """labels = ["a", 'b', "[[["]   # "\n"""
    "more = ['''\n[[[''']\n"
    'a.b.c = { d = [1, 2.5, { e = "}" }] }\n'
    'text = """\n[[[ "two" \\" "" ]] """\n'
    '[parts."leg*".parts.x]\n'
    "when = 1979-05-27T07:32:00Z\n"
    "most = 9223372036854775807\n"
    "least = -9223372036854775808\n"
)


def test_a_table_is_that_of_the_standard_library():
    assert read_table(GOOD, "mine") == tomllib.loads(GOOD)


@pytest.mark.parametrize(
    ("text", "says"),
    {
        "lists": ("a = " + "[" * 50_000, "nested more than 64 deep"),
        "closed lists": ("a = " + "[" * 2000 + "]" * 2000, "nested more than 64 deep"),
        "tables": ("a = " + "{a = " * 50_000, "nested more than 64 deep"),
        "both": ("a = " + "[{b = " * 40, "nested more than 64 deep"),
        "points": (".".join("a" * 100_000) + " = 1", "a key has more than 64 points"),
        "heading": ("[" + ".".join("a" * 100_000) + "]", "a key has more than 64 points"),
        "quoted": (".".join(100_000 * ['"a"']) + " = 1", "a key has more than 64 points"),
        "within": ("a = {" + ".".join("a" * 100_000) + " = 1}", "a key has more than 64 points"),
        "headings": (
            "[" + ".".join("a" * 60) + "]\n" + ".".join("b" * 60) + " = 1",
            "nested more than 64 deep",
        ),
        "digits": ("a = " + "9" * 5000, "too large"),
        "65 bits": ("a = 9223372036854775808", "they have 64 bits"),
        "hexadecimal": ("a = [{b = 0x" + "f" * 5000 + "}]", "they have 64 bits"),
        "long": ("#" * (MOST_BYTES + 1), "more than 1048576 characters"),
        "open": ('a = """' + '\\"' * 100_000, "is not valid TOML"),
        "quotes": ('"' * 100_000, "is not valid TOML"),
        "control": ("a = '\x1b'", "is not valid TOML"),
        "pair": ('a = "\\ud800"', "is not valid TOML"),
    }.values(),
)
def test_what_nobody_could_mean_is_refused_in_one_line(text, says):
    with pytest.raises(UsageError, match=says) as caught:
        read_table(text, "mine")
    assert str(caught.value).startswith("recipe 'mine'")
    assert len(str(caught.value).splitlines()) == 1
