"""Tables as text: what other programs read is what was in the cells."""

from __future__ import annotations

import csv
import io
import json
import math

import pytest

from moseg_core.search.part_table import PartTable, shown

HOSTILE = [
    "=1+1",
    "+1",
    "-leg",
    "@x",
    "\tx",
    'a,"b"',
    "two\nlines",
    "<script>",
    "bö\u202eg",
    "x" * 999,
]


def table_of(*texts):
    return PartTable(columns=("part", "area"), cells=tuple((text, 0.1) for text in texts))


def read(text, delimiter=","):
    return list(csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True))


@pytest.mark.parametrize("delimiter", [",", "\t"])
def test_every_text_comes_back_whole_and_none_is_a_formula(delimiter):
    head, *rows = read(table_of(*HOSTILE).to_csv(delimiter=delimiter), delimiter)
    assert head == ["part", "area"]
    for (found, area), text in zip(rows, HOSTILE, strict=True):
        assert found.removeprefix("'") == text
        assert (found[0] == "'") == (text[0] in "=+-@\t")
        assert area == "0.1"


def test_lines_end_as_the_rfc_says():
    assert table_of("leg").to_csv() == "part,area\r\nleg,0.1\r\n"


def test_numbers_keep_their_digits_and_what_is_not_known_is_empty():
    cells = ((0.1 + 0.2, 3, None, math.nan, -1e-300),)
    table = PartTable(columns=tuple("abcde"), cells=cells)
    assert read(table.to_csv())[1] == ["0.30000000000000004", "3", "", "", "-1e-300"]
    assert json.loads(table.to_json()) == [
        {"a": 0.1 + 0.2, "b": 3, "c": None, "d": None, "e": -1e-300}
    ]


def test_json_is_one_array_with_a_row_on_a_line():
    text = table_of(*HOSTILE).to_json()
    assert [row["part"] for row in json.loads(text)] == HOSTILE
    assert len(text.splitlines()) >= len(HOSTILE) + 2
    assert json.loads(PartTable(columns=("a",), cells=()).to_json()) == []


def test_tables_with_other_columns_are_joined():
    first = PartTable.of_rows([{"part": "a", "term_x": 1.0, "shape_cost": 2.0}])
    second = PartTable.of_rows([{"part": "b", "area": 3.0, "term_y": 4.0}]).with_column("file", "f")
    table = PartTable.joined([first.with_column("file", "e"), second])
    assert table.columns == ("file", "part", "area", "term_x", "term_y", "shape_cost")
    assert table.cells == (("e", "a", None, 1.0, None, 2.0), ("f", "b", 3.0, None, 4.0, None))
    assert [row["part"] for row in table] == ["a", "b"]
    assert len(table) == 2


def test_rows_are_dicts_of_their_own():
    table = table_of("leg")
    table.rows[0]["area"] = 9.0
    assert table.rows == [{"part": "leg", "area": 0.1}]


def test_a_notebook_shows_text_as_text():
    page = table_of("<script>alert(1)</script>")._repr_html_()
    assert "<script>" not in page
    assert "&lt;script&gt;" in page
    assert page.count("<tr>") == 2


def test_cells_for_people():
    assert [shown(cell) for cell in (1 / 3, 12, None, "leg")] == ["0.333333", "12", "", "leg"]
