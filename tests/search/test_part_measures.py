"""What is measured of parts: against boxes, of which everything is known."""

from __future__ import annotations

import sys
import types
from typing import NamedTuple

import numpy as np
import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import MeasureSpec
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.problem import Problem
from moseg_core.search.part_measures import THICKNESS, measure_parts
from moseg_core.shape.shape import Shape

NONE = Registry([])


def halves(shape, *, source=NONE, **more):
    """The table of the parts below and above the middle along x."""
    labels = (shape.points[:, 0] > shape.frame.center[0]).astype(int)
    segmentation = Segmentation.from_labels(shape, labels, 2)
    return measure_parts(segmentation, ["low", "high"], source=source, **more)


def test_halves_of_a_block_measure_as_blocks():
    block = Shape.from_voxels(np.ones((8, 3, 2), bool), pitch=(0.5, 1.0, 4.0), origin=(1, 2, 3))
    low, high = halves(block)
    assert (low["shape"], low["part"], low["elements"], low["pieces"]) == ("shape", "low", 24, 1)
    # 2 x 3 x 8, the long side along z; one of its sides is cut and not exposed.
    assert [low[name] for name in ("length", "width", "height")] == [8.0, 3.0, 2.0]
    assert (low["closed_volume"], low["share"], low["boundary"]) == (48.0, 0.5, 24.0)
    assert low["area"] == pytest.approx(2 * (2 * 3 + 2 * 8) + 3 * 8)
    assert [high[f"centroid_{i}"] for i in "xyz"] == pytest.approx([4.0, 3.5, 7.0])
    axes = np.array([[low[f"axis{k}_{i}"] for i in "xyz"] for k in (1, 2, 3)])
    np.testing.assert_allclose(np.abs(axes), [[0, 0, 1], [0, 1, 0], [1, 0, 0]], atol=1e-12)
    assert low["thickness"] is None


def test_a_mesh_is_measured_with_its_cuts_capped(box):
    low, high = halves(box)
    assert low["closed_volume"] + high["closed_volume"] == pytest.approx(box.volume)
    assert low["area"] + high["area"] == pytest.approx(box.area)
    assert low["boundary"] == high["boundary"] > 0


def test_what_a_shape_does_not_tell_is_not_known():
    cloud = Shape.from_points(np.random.default_rng(0).random((40, 3)))
    low, _ = halves(cloud, source=registry())
    assert (low["closed_volume"], low["boundary"], low["thickness"]) == (None, None, None)
    assert low["length"] > low["height"] > 0
    assert low["likeness_length"] > 0
    shell = Shape.from_voxels(np.ones((4, 3, 3), bool), elements="surface")
    assert halves(shell).rows[0]["closed_volume"] is None


def test_an_empty_part_has_a_row(box):
    segmentation = Segmentation.from_labels(box, np.zeros(box.n_elements, int), 2)
    table = measure_parts(segmentation, ["all", "none"], source=registry())
    assert len(table) == 2
    last = table.rows[1]
    assert (last["part"], last["elements"], last["area"], last["pieces"]) == ("none", 0, 0.0, 0)
    assert (last["length"], last["likeness_area"], last["hull_volume"]) == (None, None, None)


def test_centres_are_columns(box):
    centers = Centers(
        positions=np.array([[1.0, 2, 3], [4, 5, 6], [7, 8, 9]]),
        weights=np.array([1.0, 2.0, 3.0]),
        parts=np.array([0, 0, 1]),
    )
    low, high = halves(box, centers=centers)
    assert [low[f"center_{i}"] for i in "xyz"] == [1.0, 2.0, 3.0]
    assert (low["center_weight"], high["center_weight"]) == (1.0, 3.0)


@objective(range=(0, 100))
def area(part: Part, *, least: float = 0.0) -> float:
    return max(part.area, least)


@objective(range=(0, 100))
def both(first: Part, second: Part) -> float:
    return first.area + second.area


def test_terms_about_a_part_stand_in_its_row_and_others_in_all(box):
    problem = Problem(
        ["low", "high"],
        "2*area(*) + area(high, least=90) + both(low, high) + both(high, l*)",
        objectives={"area": area, "both": both},
    )
    labels = (box.points[:, 0] > box.frame.center[0]).astype(int)
    evaluation = problem.evaluate(box, labels)
    low, high = halves(box, evaluation=evaluation)
    assert low["term_area"] == pytest.approx(low["area"])
    assert high["term_area"] == pytest.approx(high["area"])
    assert (low["term_area_2"], high["term_area_2"]) == (None, 90.0)
    for row in (low, high):
        assert row["shape_cost"] == evaluation.cost.value
        assert row["shape_diagonal"] == pytest.approx(
            np.linalg.norm(np.ptp(box.geometry.vertices, axis=0))
        )
        assert row["shape_both_low_high"] == row["shape_both_high_l"] == pytest.approx(box.area)
    assert list(low)[-6:] == [
        "term_area",
        "term_area_2",
        "shape_diagonal",
        "shape_cost",
        "shape_both_low_high",
        "shape_both_high_l",
    ]


class Seen(NamedTuple):
    wide: float
    word: str


def test_measures_of_bundles_are_columns(box, monkeypatch):
    made = types.ModuleType("measures_of_acme")
    made.reach = lambda part: part.area
    made.seen = lambda part: Seen(2.0, "no number")
    made.tree = lambda part: object()
    made.asked = lambda part, *, power: 1.0
    monkeypatch.setitem(sys.modules, "measures_of_acme", made)
    specs = [
        MeasureSpec(name="reach", target="measures_of_acme:reach"),
        MeasureSpec(name="seen", target="measures_of_acme:seen"),
        MeasureSpec(name="tree", target="measures_of_acme:tree", keep=False),
        MeasureSpec(name="asked", target="measures_of_acme:asked"),
        MeasureSpec(name="volume", target="measures_of_acme:reach", requires=("volume",)),
    ]
    components = tuple(Component("acme", "acme 1", spec) for spec in specs)
    other = Component("rival", "rival 1", specs[1])
    source = Registry(
        [
            Bundle("acme", "acme", "1", "", components),
            Bundle("rival", "rival", "1", "", (other,)),
        ]
    )
    labels = np.zeros(box.n_elements, int)
    from moseg_core.components.discovery.lookup import Lookup

    whole = Segmentation.from_labels(box, labels, 1, lookup=Lookup(source))
    (row,) = measure_parts(whole, ["all"], source=source)
    assert row["reach"] == row["volume"] == pytest.approx(box.area)
    assert (row["acme_seen_wide"], row["rival_seen_wide"]) == (2.0, 2.0)
    assert not [name for name in row if name.startswith(("tree", "asked", "acme_seen_word"))]


def test_thickness_is_in_units_of_the_shape(box):
    assert any(c.id == THICKNESS for c in registry().components("field"))
    one = measure_parts(
        Segmentation.from_labels(box, np.zeros(box.n_elements, int), 1), ["a"], source=registry()
    ).rows[0]
    ten = Shape.from_polygon_mesh(box.geometry)
    assert one["thickness"] == pytest.approx(one["likeness_thickness"] * box.box_diagonal, rel=1e-9)
    assert ten.n_elements == box.n_elements
    # Between the shortest side and the longest, with what rays at an angle see.
    assert 0.5 < one["thickness"] < 4.0
