"""Which of the forms of text a file has."""

from __future__ import annotations

import pytest

from moseg_core.io.labels.listing import Wanted
from moseg_core.io.labels.text import read_text

THREE = Wanted(n_elements=3)


@pytest.mark.parametrize("name", ["x.txt", "x.seg", "x.csv"])
@pytest.mark.parametrize(
    ("text", "labels", "names"),
    [
        ("a\n1 3\nb\n2\n", [0, 1, 0], ("a", "b")),
        ("0\n1\n0\n", [0, 1, 0], None),
        ("a\nb\na\n", [0, 1, 0], ("a", "b")),
        ("label\n0\n1\n0\n", [0, 1, 0], None),
        ("face label\n0 0\n1 1\n2 0\n", [0, 1, 0], None),
        (" [0, 1, 0]", [0, 1, 0], None),
        ('{"0": 0, "1": 1, "2": 0}', [0, 1, 0], None),
        ("[left]\n1 3\n[right]\n2\n", [0, 1, 0], ("[left]", "[right]")),
    ],
)
def test_forms_are_told_apart_whatever_the_suffix(name, text, labels, names, as_file):
    found = read_text(as_file(name, text), THREE)
    assert (found.labels.tolist(), found.names) == (labels, names)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"a\n1\nb\xff\n2 3\n", ", line 3: 'b\ufffd' is not UTF-8; save the file as such"),
        ("a\n1 2\nb 3\n", " ends behind the name 'b 3', without its faces"),
        ("a\n1 x\n", ", line 2: 'x' is not an integer"),
        ("a\n1 2\n3\n", ", line 3: expected the name of a label, found '3'"),
        ("[0, 1", " is not JSON ("),
        ("\n", " is empty"),
    ],
)
def test_what_has_none_of_them_is_refused(text, message, refusal):
    assert refusal(lambda path: read_text(path, THREE), "x.txt", text).startswith(message)
