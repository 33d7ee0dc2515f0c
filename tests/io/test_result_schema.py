"""The schema of results: whatever stands in a file in place of a value, it is refused or passed."""

from __future__ import annotations

import copy
import json
import random

import numpy as np
import pytest

from moseg_core.errors import UsageError
from moseg_core.io.result_json import read_result, write_json
from moseg_core.io.result_schema import check_schema, number, term, text
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.search.levels import segment_hierarchy
from moseg_core.shape.shape import Shape

#: What may stand in place of a value.
OTHERS = [
    *(None, True, -1, 0.5, 1e308, float("inf"), float("nan"), 10**30, 2**63, 3),
    *("", "x", "a" * 10_000, "../../x", "con", "\x1b[2J", "\u202e", "\ud800", "a\nb", "[/x]"),
    *([], {}, [[]], [None], {"a": None}, {"": []}, [[0, 1, 2]], ["a", "b"]),
]


@pytest.fixture(scope="module")
def document():
    strip = Shape.from_mesh(
        [[x, y, 0] for x in range(7) for y in (0, 1)],
        [[2 * x, 2 * x + 2, 2 * x + 3, 2 * x + 1] for x in range(6)],
    )
    task = Hierarchy(
        Problem(["a", "b"], "narrow(a)"), {"b": Problem(["c", "d"], "2*flat(d) + separate_parts")}
    )
    found = segment_hierarchy(strip, task, optimizer="pattern_search(max_evaluations=5)")
    return json.loads(write_json(found))


def places(value, at=()):
    """The paths to all values; of lists to the first and the last item."""
    yield at
    if isinstance(value, dict):
        for key in value:
            yield from places(value[key], (*at, key))
    elif isinstance(value, list) and value:
        for k in {0, len(value) - 1}:
            yield from places(value[k], (*at, k))


def put(document, at, value):
    changed = copy.deepcopy(document)
    within = changed
    for key in at[:-1]:
        within = within[key]
    within[at[-1]] = value
    return changed


def test_what_moseg_writes_is_read(document, tmp_path):
    path = tmp_path / "r.json"
    path.write_text(json.dumps(document))
    assert read_result(path).names == ("a", "b/c", "b/d")


def test_a_value_of_another_kind_is_refused_or_of_no_matter(document, tmp_path):
    path, refusals, rng = tmp_path / "r.json", [], random.Random(1)
    for at in list(places(document))[1:]:
        for value in rng.sample(OTHERS, 6):
            path.write_text(json.dumps(put(document, at, value)))
            try:
                found = read_result(path)
            except UsageError as error:
                refusals.append(str(error))
                continue
            assert len(found.names) == len(found.centers.weights)
            assert np.isfinite(found.centers.positions).all()
            said = [*found.names, *found.warnings, found.reason]
            said += [one.text for one in found.evaluation.terms]
            assert all(one.isprintable() for one in said)
    assert len(refusals) > 500
    assert max(map(len, refusals)) < 1000


def test_a_missing_value_is_named(document, tmp_path):
    path = tmp_path / "r.json"
    for key in ("shape", "terms", "labels", "history", "problem", "parts"):
        path.write_text(json.dumps({k: v for k, v in document.items() if k != key}))
        with pytest.raises(UsageError, match=f"is a damaged result \\(no '{key}'\\)"):
            read_result(path)


@pytest.mark.parametrize(
    "good", ["narrow(a)", "basic:is(leg*, area=0.06+-0.02)", "a/b: convex_parts", "f(a) @ mds"]
)
def test_terms(good):
    term(good, "x")


@pytest.mark.parametrize(
    "bad", ["[/x]narrow(a)", "a + b", "", "narrow(", "../x: f(a)", ": ", "f(a)\x1b", 3, "é(a)"]
)
def test_what_is_no_term(bad):
    with pytest.raises(ValueError, match="'x' must be"):
        term(bad, "x")


def test_the_place_of_a_fault_is_named():
    schema = {"a": [{"b": number}], "c?": text}
    check_schema({"a": [{"b": 1}, {"b": 2.5}], "d": object()}, schema)
    for value, says in (
        ({"a": [{"b": 1}, {"b": "x"}]}, r"'a\[1\].b' must be a finite number, not 'x'"),
        ({"a": [{}]}, r"'a\[0\].b' is missing"),
        ({"a": {}}, "'a' must be a list, not {}"),
        ({"a": [], "c": "\x07"}, r"'c' must be a printable text, not '\\x07'"),
        ([], "'' must be an object"),
    ):
        with pytest.raises(ValueError, match=says):
            check_schema(value, schema)
