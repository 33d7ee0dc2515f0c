"""A result as the page shows it: of this key, or made anew; what goes wrong is an answer."""

from __future__ import annotations

import hashlib
import json

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


def test_a_result_is_described_as_it_is_now(shape_folder, tmp_path):
    shape = str(write_shape(shape_folder, "a"))
    result = tmp_path / "a.json"
    assert do_job(shape, [str(result)], TEXT)["kind"] == "ok"
    picture, measures = description_files(tmp_path, "a")
    given = [str(result), str(picture), str(measures)]
    assert describe_result(shape, given, TEXT)["kind"] == "ok"
    found = read_description(measures, result)
    assert [row["part"] for row in found.rows] == ["a", "b"]
    assert found.rows[0]["shape_cost"] > 0
    first = picture.read_bytes(), measures.read_bytes()
    describe_result(shape, given, TEXT)
    assert (picture.read_bytes(), measures.read_bytes()) == first

    other = str(write_shape(shape_folder, "other"))
    answer = describe_result(other, given, TEXT)
    assert answer["kind"] == "failed"
    assert "a.json" in answer["message"]
    result.write_bytes(result.read_bytes() + b" ")
    assert read_description(measures, result) is None


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", '{"digest": "k"}', '{"digest": "k", "rows": [1]}', "[" * 100_000, '"k"'],
)
def test_what_is_no_description_is_none(tmp_path, text):
    path, result = tmp_path / "x.json", tmp_path / "result.json"
    result.write_text("{}")
    path.write_text(text)
    assert read_description(path, result) is None
    assert read_description(tmp_path / "none.json", result) is None
    digest = hashlib.sha256(b"{}").hexdigest()
    path.write_text(json.dumps({"digest": digest, "rows": [{"part": "a"}]}))
    assert read_description(path, result) == Description(digest=digest, rows=({"part": "a"},))
    assert read_description(path, tmp_path / "none.json") is None
