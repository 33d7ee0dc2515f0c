"""A result as the page shows it: of this key, or made anew; what goes wrong is an answer."""

from __future__ import annotations

import pytest

from moseg_core.batching.instructions import Instructions
from moseg_core.batching.report.describing import (
    Description,
    describe_result,
    description_files,
    read_description,
)
from moseg_core.batching.solving import do_job
from tests.batching.planted import OPTIONS, write_shape
from tests.batching.report.test_making import PLAIN

TEXT = Instructions(statement=PLAIN, options=OPTIONS).text()


def test_a_result_is_described_under_its_key(shape_folder, tmp_path):
    shape = str(write_shape(shape_folder, "a"))
    result = tmp_path / "a.json"
    assert do_job(shape, [str(result)], TEXT)["kind"] == "ok"
    picture, measures = description_files(tmp_path, "a")
    given = [str(result), str(picture), str(measures), "key"]
    assert describe_result(shape, given, TEXT)["kind"] == "ok"
    found = read_description(measures, "key")
    assert [row["part"] for row in found.rows] == ["a", "b"]
    assert found.rows[0]["shape_cost"] > 0
    assert read_description(measures, "other") is None
    first = picture.read_bytes(), measures.read_bytes()
    describe_result(shape, given, TEXT)
    assert (picture.read_bytes(), measures.read_bytes()) == first

    other = str(write_shape(shape_folder, "other"))
    answer = describe_result(other, given, TEXT)
    assert answer["kind"] == "failed"
    assert "a.json" in answer["message"]


@pytest.mark.parametrize(
    "text", ["", "{", "[]", '{"key": "k"}', '{"key": "k", "rows": [1]}', "[" * 100_000, '"k"']
)
def test_what_is_no_description_is_none(tmp_path, text):
    path = tmp_path / "x.json"
    path.write_text(text)
    assert read_description(path, "k") is None
    assert read_description(tmp_path / "none.json", "k") is None
    path.write_text('{"key": "k", "rows": [{"part": "a"}]}')
    assert read_description(path, "k") == Description(key="k", rows=({"part": "a"},))
