"""Results as JSON: what is written is what is read back, and damage is named."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from moseg_core.components.cost import Cost
from moseg_core.components.detail import Detail
from moseg_core.components.protocols import Centers
from moseg_core.errors import UsageError
from moseg_core.io.result_json import FORMAT, evaluation_document, read_result, write_json
from moseg_core.language import Target
from moseg_core.search.incumbents import Incumbent
from tests.results import result_on


@pytest.fixture
def written(box, tmp_path):
    path = tmp_path / "x.json"
    path.write_bytes(write_json(result_on(box, warnings=("watch out",), dimension=(6, 8))))
    return path


def test_what_is_written_is_read_back(written, box):
    result, saved = result_on(box), read_result(written)
    assert saved.labels.tolist() == result.labels.tolist()
    assert saved.names == ("first", "second")
    assert saved.statement.minimize == "2*area(first)"
    assert saved.evaluation == result.evaluation
    np.testing.assert_array_equal(saved.centers.positions, result.centers.positions)
    np.testing.assert_array_equal(saved.centers.weights, [1.0, 2.0])
    assert (saved.seed, saved.reason, saved.warnings) == (3, "converged", ("watch out",))
    assert saved.shape["fingerprint"] == box.fingerprint
    assert {stage: tuple(records) for stage, records in saved.history.items()} == result.history


def test_several_centres_of_a_part_are_read_back(box, tmp_path):
    centers = Centers(
        positions=box.points[[0, -1, 3]],
        weights=np.array([1.0, 2.0, 0.5]),
        parts=np.array([0, 1, 1]),
    )
    path = tmp_path / "x.json"
    path.write_bytes(write_json(result_on(box, centers=centers)))
    first, second = json.loads(path.read_text())["parts"]
    assert "more" not in first
    assert [row["weight"] for row in second["more"]] == [0.5]
    saved = read_result(path).centers
    np.testing.assert_array_equal(saved.positions, centers.positions)
    assert saved.weights.tolist() == [1.0, 2.0, 0.5]
    assert saved.parts.tolist() == [0, 1, 1]


def test_details_are_read_back(box, tmp_path):
    details = (
        Detail(name="width", value=0.1, cost=0.3, expected=Target(1 / 3, 0.02), percent=True),
        Detail(name="pieces", value=2, cost=1),
    )
    result = result_on(box)
    (term,) = result.evaluation.terms
    calls = tuple(replace(call, details=details) for call in term.calls)
    told = replace(result.evaluation, terms=(replace(term, calls=calls),))
    path = tmp_path / "x.json"
    path.write_bytes(write_json(replace(result, evaluation=told)))
    assert read_result(path).evaluation == told


def test_each_entry_is_one_line(written):
    lines = written.read_text().splitlines()
    document = json.loads(written.read_text())
    assert len(lines) == len(document) + 2
    assert document["dimension"] == {"free": 6, "all": 8}
    assert document["format"] == FORMAT


def test_json_has_no_word_for_infinity_and_nan(box, tmp_path):
    result = result_on(box, history={"search": ({"iteration": 0, "value": math.nan},)})
    (term,) = evaluation_document(result.evaluation)["terms"]
    assert term["worst"] is None  # there is no greatest area
    path = tmp_path / "x.json"
    path.write_bytes(write_json(result))
    assert b"NaN" not in path.read_bytes()
    assert read_result(path).history["search"] == [{"iteration": 0, "value": None}]
    assert read_result(path).evaluation.terms[0].worst == math.inf


def incumbent(stage, evaluations):
    centers = Centers(positions=np.arange(6.0).reshape(2, 3), weights=np.array([1.0, 2.5]))
    return Incumbent(stage=stage, evaluations=evaluations, cost=Cost(1, 0.25), centers=centers)


def test_how_the_search_went_is_read_back_and_may_be_missing(box, tmp_path):
    path = tmp_path / "x.json"
    path.write_bytes(write_json(result_on(box)))
    assert read_result(path).incumbents == ()
    result = result_on(box, incumbents=(incumbent("start", 1), incumbent("end", 40)))
    path.write_bytes(write_json(result))
    first, last = read_result(path).incumbents
    assert (first.stage, first.evaluations, first.cost) == ("start", 1, Cost(1, 0.25))
    assert last.centers.positions.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert last.centers.weights.tolist() == [1.0, 2.5]
    line = next(line for line in path.read_text().splitlines() if line.startswith('"incumbents"'))
    assert '"centers": [[0.0, 1.0, 2.0, 1.0], [3.0, 4.0, 5.0, 2.5]]' in line


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("centers", [[0.0, 1.0, 2.0, 1.0]]),
        ("centers", [[0.0, 1.0, 2.0, 1.0], [0.0, 1.0, 2.0, -1.0]]),
        ("centers", [[0.0, math.inf, 2.0, 1.0], [0.0, 1.0, 2.0, 1.0]]),
        ("centers", None),
        ("value", math.nan),
        ("evaluations", "many"),
    ],
)
def test_a_step_of_the_search_that_is_none_is_refused(box, tmp_path, key, value):
    path = tmp_path / "x.json"
    path.write_bytes(write_json(result_on(box, incumbents=(incumbent("start", 1),))))
    document = json.loads(path.read_text())
    document["incumbents"][0][key] = value
    path.write_text(json.dumps(document))
    with pytest.raises(UsageError, match="is a damaged result"):
        read_result(path)


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (lambda document: document.pop("format"), "is not a moseg result; make one with"),
        (lambda document: document.update(format="other/9"), "has the format 'other/9'"),
        (lambda document: document.pop("labels"), r"is a damaged result \(no 'labels'\)"),
        (lambda document: document.update(terms=3), "is a damaged result"),
        (lambda document: document["cost"].update(value="low"), "is a damaged result"),
        # A label without letters would be a part of itself.
        (lambda document: document["problem"].update(labels=["", "b"]), "is a damaged result"),
    ],
)  # fmt: skip
def test_other_documents_are_refused(written, edit, says):
    document = json.loads(written.read_text())
    edit(document)
    written.write_text(json.dumps(document))
    with pytest.raises(UsageError, match=says):
        read_result(written)


@pytest.mark.parametrize("contents", [b"", b"{", b"\xff\xfe", b"[]", b"3"])
def test_other_files_are_refused(tmp_path, contents):
    path = tmp_path / "x.json"
    path.write_bytes(contents)
    with pytest.raises(UsageError, match=r"cannot be read as a result|is not a moseg result"):
        read_result(path)
