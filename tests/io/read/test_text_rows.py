from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import ShapeError
from moseg_core.io.read.text_rows import floats, integers, leading_floats, line_of_item, text_rows

PATH = Path("a.off")


def slow_rows(text: str, continuation: bool) -> list[tuple[list[bytes], int]]:
    """Character by character: words, and the line on which each row begins."""
    rows, row, token, line, first, comment = [], [], "", 1, 1, False
    for index, character in enumerate(text + "\n"):
        if character == "\n":
            joined = continuation and token.endswith("\\") and index < len(text)
            token = token[:-1] if continuation and token.endswith("\\") else token
            row += [token.encode()] if token else []
            if not joined:
                if row:
                    rows.append((row, first))
                row, first = [], line + 1
            token, line, comment = "", line + 1, False
        elif character == "#" or comment:
            comment = True
        elif character == " ":
            row += [token.encode()] if token else []
            token = ""
        else:
            token += character
    return rows


@given(text=st.text("ab #\\\n", max_size=40), continuation=st.booleans())
def test_rows_against_reading_character_by_character(text, continuation):
    # A backslash followed by a blank or a comment also continues; the reference knows neither.
    while "\\ " in text or "\\#" in text:
        text = text.replace("\\ ", " ").replace("\\#", "#")
    text = text.rstrip("\\ \n")
    rows, lines = text_rows(text.encode(), continuation=continuation)
    assert list(zip(rows, lines, strict=True)) == slow_rows(text, continuation)


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_lines_end_in_any_of_three_ways(end):
    assert text_rows(b"a b" + end + end + b"c") == ([[b"a", b"b"], [b"c"]], [1, 3])


def test_a_comment_mark_may_be_part_of_the_text():
    assert text_rows(b"a #b", comment=None) == ([[b"a", b"#b"]], [1])


@given(values=st.lists(st.floats(), max_size=20))
def test_floats_come_back(values):
    tokens = [repr(value).encode() for value in values]
    np.testing.assert_array_equal(floats(PATH, tokens, lambda i: i), values)


@given(values=st.lists(st.integers(-(2**63), 2**63 - 1), max_size=20))
def test_integers_come_back(values):
    tokens = [str(value).encode() for value in values]
    assert integers(PATH, tokens, lambda i: i).tolist() == values


@pytest.mark.parametrize("bad", [b"", b"x", b"1_0", b"1,5", b"0x10", b"\xff", b"1\0", b"--1"])
@pytest.mark.parametrize("convert", [floats, integers])
def test_the_first_word_that_is_no_number_is_named(convert, bad):
    with pytest.raises(ShapeError, match=r"^a\.off, line 12: .* is not an? (number|integer)"):
        convert(PATH, [b"1", b"2", bad, b"y"], lambda i: 10 + i)


@pytest.mark.parametrize("bad", [b"1.0", b"1e3", b"9223372036854775808", b"1" * 5000])
def test_integers_must_fit(bad):
    with pytest.raises(ShapeError, match=r"^a\.off, line 1: '.*' is not an integer"):
        integers(PATH, [b"0", bad], lambda i: i)


@given(sizes=st.lists(st.integers(1, 4), min_size=1, max_size=10))
def test_the_line_of_a_word(sizes):
    lines = [7 * r + 3 for r in range(len(sizes))]
    line_of = line_of_item(np.concatenate([[0], np.cumsum(sizes)]), lines)
    assert [line_of(i) for i in range(sum(sizes))] == np.repeat(lines, sizes).tolist()


def test_leading_floats_name_the_line_of_what_is_wrong():
    rows = [[b"v", b"1", b"2", b"3", b"x"], [b"v", b"4", b"5", b"6"]]
    assert leading_floats(PATH, rows, [3, 5], start=1).tolist() == [[1, 2, 3], [4, 5, 6]]
    rows[1][3] = b"six"
    with pytest.raises(ShapeError, match=r"^a\.off, line 5: 'six' is not a number"):
        leading_floats(PATH, rows, [3, 5], start=1)
    del rows[1][2:]
    with pytest.raises(ShapeError, match=r"line 5: a corner needs 3 coordinates, this one has 1"):
        leading_floats(PATH, rows, [3, 5], start=1, what="corner")


def test_what_stands_behind_the_end_is_no_word():
    assert text_rows(b"1 2\n\x1a") == text_rows(b"1 2\n" + bytes(9)) == ([[b"1", b"2"]], [1])
