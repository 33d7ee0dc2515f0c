"""Names of labels from files: nothing in them does anything, and different ones stay different."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.labels.reading import read_labels
from moseg_core.io.labels.safe_names import safe_names
from moseg_core.problem.statement import LONGEST_LABEL


@pytest.mark.parametrize(
    "name",
    [
        "leg 1",
        "head/ear",
        "../../x",
        "con",
        "größe",
        "手",
        "\u0646\u200c\u062e",
        "a\u00a0b",
        "",
        "[/x]",
    ],
)
def test_names_that_can_be_read_stay(name):
    assert safe_names([name]) == (name,)


@pytest.mark.parametrize(
    ("name", "safe"),
    [
        ("a\nb", r"a\nb"),
        ("\x1b]0;x\x07", r"\x1b]0;x\x07"),
        ("\u202egnp", r"\u202egnp"),
        ("\ud800", r"\ud800"),
        ("\x9b1A", r"\x9b1A"),
        ("\u200b", r"\u200b"),
    ],
)
def test_what_does_something_is_shown(name, safe):
    assert safe_names([name]) == (safe,)


def test_names_that_come_to_the_same_are_numbered():
    long = [300 * "a" + end + 300 * "a" for end in "bcd"]
    found = safe_names(["a\nb", r"a\nb", *long])
    assert found[:2] == (r"a\nb (2)", r"a\nb")
    assert len(set(found)) == 5
    assert max(map(len, found)) == LONGEST_LABEL
    assert safe_names([3 * "\n", 3 * "\n"]) == (3 * r"\n", 3 * r"\n")


@given(st.lists(st.text(max_size=400) | st.text("\x1b\u202eab", max_size=300)))
def test_any_names(names):
    safe = safe_names(names)
    assert len(set(safe)) == len(set(names))
    for name, new in zip(names, safe, strict=True):
        assert len(new) <= LONGEST_LABEL
        assert not set(new) & set("\x1b\n\r\x07\x9b\u202e\u2028")
        assert (new == name) == (safe_names([name]) == (name,))


def test_a_file_of_labels_says_how_many_were_changed(as_file):
    path = as_file("x.txt", "leg\x1b[2J\n1 2\nbody\n3\n")
    found = read_labels(path, 3)
    assert found.names == (r"leg\x1b[2J", "body")
    assert found.notes == (
        r"x.txt: names of labels that are too long, or hold what cannot be seen: 1, such as"
        r" 'leg\x1b[2J'",
    )
