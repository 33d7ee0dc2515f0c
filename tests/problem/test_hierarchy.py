"""Hierarchies: paths, which problem goes to which part, and costs that add up over the levels."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import ShapeError, UsageError
from moseg_core.problem.hierarchy import Hierarchy, expand_parts
from moseg_core.problem.problem import Problem
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from tests.shapes import tee

TOP = Problem(["stem", "bar"], "narrow(stem) + perpendicular(stem, bar)")
ENDS = Problem(["low", "high"], "2*compact(low, high) + convex_parts")
HALVES = Problem(["a", "b"], "flat(b)")
SHAPE = Shape.from_mesh(*tee(6, 5), name="tee")
STEM = SHAPE.points[:, 2] < 6


def task() -> Hierarchy:
    return Hierarchy(TOP, {"stem": Hierarchy(ENDS, {"high": HALVES})})


def named(where: dict[str, np.ndarray], hierarchy: Hierarchy) -> np.ndarray:
    labels = np.full(SHAPE.n_elements, -1)
    for name, mask in where.items():
        labels[mask] = hierarchy.labels.index(name)
    return labels


Z = SHAPE.points[:, 2]
WHERE = {
    "stem/low": STEM & (Z < 2),
    "stem/high/a": STEM & (Z > 2) & (Z < 4),
    "stem/high/b": STEM & (Z > 4),
    "bar": ~STEM,
}


def test_leaves_are_paths_in_the_order_of_the_labels():
    assert task().labels == ("stem/low", "stem/high/a", "stem/high/b", "bar")
    assert task().owners.tolist() == [0, 0, 0, 1]
    assert [path for path, _ in task().levels()] == ["", "stem", "stem/high"]


def test_without_parts_it_is_the_problem():
    alone = Hierarchy(TOP)
    labels = np.where(STEM, 0, 1)
    assert alone.labels == TOP.labels
    assert alone.evaluate(SHAPE, labels) == TOP.evaluate(SHAPE, labels)


def test_a_label_goes_before_a_glob_and_an_earlier_glob_before_a_later_one():
    labels = ["head", "leg1", "leg2", "tail"]
    given_ = [("*l*", "l"), ("leg2", "second"), ("leg*", "leg")]
    assert expand_parts(given_, labels) == {"leg1": "l", "leg2": "second", "tail": "l"}
    assert list(expand_parts([("tail", 1), ("head", 2)], labels)) == ["head", "tail"]


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("stm", r"parts: unknown label 'stm'; did you mean 'stem'\?"),
        ("leg*", r"parts: 'leg\*' matches none of the labels stem, bar"),
    ],
)
def test_parts_that_there_are_not(key, message):
    with pytest.raises(UsageError, match=message):
        Hierarchy(TOP, {key: ENDS})


def test_only_problems_nest():
    with pytest.raises(UsageError, match="'stem' is divided by a Problem or a Hierarchy, not by"):
        Hierarchy(TOP, {"stem": "narrow(a)"})
    with pytest.raises(UsageError, match="made of problems"):
        Hierarchy("narrow(a)")


def test_costs_add_up_over_the_levels_each_on_its_own_part():
    found = task().evaluate(SHAPE, named(WHERE, task()))
    stem = np.flatnonzero(STEM)
    high = np.flatnonzero(STEM & (Z > 2))
    levels = [
        TOP.evaluate(SHAPE, np.where(STEM, 0, 1)),
        ENDS.evaluate(subshape(SHAPE, stem), (Z[stem] > 2).astype(int)),
        HALVES.evaluate(subshape(SHAPE, high), (Z[high] > 4).astype(int)),
    ]
    assert found.cost.value == pytest.approx(sum(level.cost.value for level in levels), rel=1e-12)
    assert [term.weighted for term in found.terms] == pytest.approx(
        [term.weighted for level in levels for term in level.terms], rel=1e-12
    )


def test_terms_tell_where_they_belong():
    found = task().evaluate(SHAPE, named(WHERE, task()))
    assert [term.text for term in found.terms] == [
        "narrow(stem)",
        "perpendicular(stem, bar)",
        "stem: compact(low, high)",
        "stem: convex_parts",
        "stem/high: flat(b)",
    ]
    assert [call.labels for call in found.terms[2].calls] == [("stem/low",), ("stem/high",)]
    assert found.terms[3].calls[0].labels == ()
    assert found.terms[4].calls[0].labels == ("stem/high/b",)
    assert found.empty == ()


def test_the_stem_cut_across_is_two_convex_pieces():
    """Its caps are its cuts: 2 and 4 of the 6 cubes."""
    found = task().evaluate(SHAPE, named(WHERE, task()))
    assert found.terms[3].value == pytest.approx(0.0, abs=1e-9)


def test_a_missing_part_leaves_out_all_that_is_about_it():
    labels = np.full(SHAPE.n_elements, task().labels.index("bar"))
    found = task().evaluate(SHAPE, labels)
    assert found.empty == ("stem", "stem/low", "stem/high", "stem/high/a", "stem/high/b")
    assert found.cost.empty == 5
    assert all(call.value is None for term in found.terms for call in term.calls if call.labels)


def test_labels_that_do_not_fit():
    with pytest.raises(ShapeError, match="allowed are 0 to 3"):
        task().evaluate(SHAPE, np.full(SHAPE.n_elements, 4))


def test_names_of_whole_parts_are_understood():
    assert task().fitted(["stem", "bar"]).labels == ("stem", "bar")
    assert task().fitted(["stem/high", "bar"]).labels == ("stem/low", "stem/high", "bar")
    assert task().fitted(["stem/high/a", "elsewhere"]).labels == task().labels
    assert task().without("stem").labels == ("stem", "bar")


@given(names=st.sets(st.sampled_from(["stem", "stem/low", "stem/high", "stem/high/a", "bar"])))
def test_fitting_only_ever_closes_what_is_named(names):
    whole, fitted = task().labels, task().fitted(names).labels
    for leaf in fitted:
        assert leaf in whole or leaf in names
    for leaf in whole:
        assert sum(leaf == name or leaf.startswith(name + "/") for name in fitted) == 1


def test_the_first_leaf_of_a_path():
    assert [task().first_leaf(p) for p in ("stem", "stem/high", "stem/high/b", "bar")] == [
        0,
        1,
        2,
        3,
    ]
    with pytest.raises(UsageError, match="unknown label 'bat'; did you mean 'bar'"):
        task().first_leaf("bat")
