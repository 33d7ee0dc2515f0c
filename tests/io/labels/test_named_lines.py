"""Names and lines of face ids in turn."""

from __future__ import annotations

import pytest

from moseg_core.io.labels import encode_named_labels, read_labels
from moseg_core.io.labels.named_lines import are_named_lines

NAMED = "body\n1 3 4 \nupper arm\n5 2 \n"


@pytest.mark.parametrize(
    "text",
    [
        NAMED,
        NAMED.replace("\n", "\r\n"),
        "\n\n" + NAMED.replace("\nupper", "\n\n  \nupper") + "\n\n",
        NAMED.rstrip(),
        "\ufeff" + NAMED,
        "body\n4\nupper arm\n2 5\n  body\n3\nbody \n1\n",
        "body\n1 3 4\nupper arm\n2\nbody\n\nupper arm\n5",
    ],
)
def test_variants_of_named_labels_read_alike(text, as_file):
    found = read_labels(as_file("x.txt", text), 5)
    assert found.labels.tolist() == [0, 1, 0, 0, 1]
    assert found.names == ("body", "upper arm")


def test_a_name_that_no_face_bears_keeps_its_place(as_file):
    contents = encode_named_labels([0, 2], ["a", "b", "c"])
    assert contents == b"a\n1\nb\n\nc\n2\n"
    assert read_labels(as_file("x.txt", contents), 2).names == ("a", "b", "c")


@pytest.mark.parametrize(
    ("text", "whether"),
    [
        (NAMED, True),
        ("body\n1\n", True),
        ("body\n\narm\n1 2\n", True),
        ("body\n1 2\narm\n", True),  # cut off, and refused as such
        ("", False),
        ("body\n", False),
        ("0\n1\n", False),
        ("body\nbody\narm\n", False),
        ("label\n0\n1\n0\n", False),
        ("body\n1 2x\n", False),
    ],
)
def test_which_texts_have_the_form(text, whether):
    assert are_named_lines(text) is whether


def test_faces_that_stand_nowhere_have_no_label(as_file):
    found = read_labels(as_file("x.txt", "a\n1 4\nb\n2\n"), 5)
    assert found.labels.tolist() == [0, 1, -1, 0, -1]
    assert found.notes == ("x.txt: 2 of 5 elements are unlabelled and left out",)


def test_a_long_number_behind_a_name_is_looked_at_once():
    """Whether a line is one of ids took twice as long with each digit, where it is none."""
    assert not are_named_lines("face,label\n" + 5000 * "9" + ",a\n1,b\n")
    assert are_named_lines("face\n" + 5000 * "9" + " +1 -2\n")
