"""``is``: each measure against a slow reference, targets, what it reads."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.likeness import BY_RATIO, expected_share, fields_of, is_

from moseg_core import ExpressionError, Problem, Segmentation, Shape, Target, coarsen, field_values

RATIOS = {"area", "length", "width", "depth", "spread", "thickness", "boundary"}
IN_PERCENT = {"area", "length", "width", "depth", "offcenter", "thickness"}
MEASURES = [parameter.name for parameter in is_.parameters]


def measured(shape, labels, k):
    """All measures of a part, element by element."""
    own, areas, links = labels == k, shape.areas, shape.links
    thickness, remoteness, concavity = (
        field_values(shape, f"basic:{name}") for name in ("thickness", "remoteness", "concavity")
    )
    corners = shape.geometry.vertices[shape.geometry.triangles][own]
    middles = (corners + np.roll(corners, 1, axis=1)).reshape(-1, 3) / 2
    weights = np.repeat(areas[own] / 3, 3)  # the rule of midpoints is exact for squares
    centroid = np.average(middles, axis=0, weights=weights)
    scales = np.sqrt(np.linalg.eigvalsh(np.cov(middles.T, aweights=weights, bias=True))[::-1])
    area = areas[own].sum()
    mean = np.average(thickness[own], weights=areas[own])
    varied = np.sqrt(np.average((thickness[own] - mean) ** 2, weights=areas[own]))
    crossing = own[links.first] != own[links.second]
    length = links.lengths[crossing]
    between = (concavity[links.first] + concavity[links.second])[crossing] / 2
    whole = np.average(shape.points, axis=0, weights=areas)
    return {
        "area": area / areas.sum(),
        **dict(
            zip(
                ("length", "width", "depth"),
                math.sqrt(12) * scales / shape.box_diagonal,
                strict=True,
            )
        ),
        "spread": np.linalg.norm(scales) / math.sqrt(area),
        "offcenter": np.linalg.norm(centroid - whole) / shape.box_diagonal,
        "thickness": mean,
        "unevenness": varied / mean,
        "remoteness": np.average(remoteness[own], weights=areas[own]),
        "nearest": remoteness[own].min(),
        "farthest": remoteness[own].max(),
        "boundary": length.sum() / math.sqrt(area),
        "crease": np.average(between, weights=length),
    }


@pytest.fixture(scope="module")
def lump(make):
    vertices, faces = make.ball(3)
    vertices = vertices * [3, 2, 1] + 0.3 * np.sin(3 * vertices[:, [1, 2, 0]])
    shape = Shape.from_mesh(vertices, faces)
    coarse = coarsen(shape, 150)
    rough = (coarse.points @ [1.0, 0.5, 0.2] > 0.7).astype(int)
    return shape, coarse, rough


@pytest.mark.parametrize("name", MEASURES)
def test_each_measure_on_both_levels(lump, name):
    shape, coarse, rough = lump
    labels = rough[coarse.members]
    for level, of_level in ((shape, labels), (coarse, rough)):
        for k, part in enumerate(Segmentation.from_labels(level, of_level, 2).parts):
            value = measured(shape, labels, k)[name]
            at = Target(value, 0.1)
            assert is_(part, **{name: at}) == pytest.approx(0, abs=1e-9)
            off = Target(value * 1.2, value * 0.1) if name in RATIOS else Target(value + 0.3, 0.1)
            cost = off.ratio_cost(value) if name in RATIOS else off.cost(value)
            assert is_(part, **{name: off}) == pytest.approx(cost, rel=1e-5)
            assert cost > 0.5


@given(st.sets(st.sampled_from(MEASURES), min_size=1), st.integers(0, 2**32))
@settings(max_examples=20, deadline=None)
def test_the_mean_over_what_is_given(lump, names, seed):
    _, coarse, rough = lump
    rng = np.random.default_rng(seed)
    part = Segmentation.from_labels(coarse, rough, 2).parts[0]
    targets = {name: Target(rng.uniform(0.1, 1), rng.uniform(0.1, 1)) for name in names}
    alone = [is_(part, **{name: target}) for name, target in targets.items()]
    assert is_(part, **targets) == pytest.approx(np.mean(alone))


@given(st.sets(st.sampled_from(MEASURES), min_size=1), st.integers(0, 2**32))
@settings(max_examples=20, deadline=None)
def test_its_details_add_up_to_it(lump, names, seed):
    shape, coarse, rough = lump
    rng = np.random.default_rng(seed)
    targets = {name: Target(rng.uniform(0.1, 1), rng.uniform(0.1, 1)) for name in names}
    text = ", ".join(f"{name}={target}" for name, target in targets.items())
    problem = Problem(["rest", "end"], f"2*is(end, {text})")
    labels = rough[coarse.members]
    (term,) = problem.evaluate(shape, labels).terms
    (call,) = term.calls
    assert math.fsum(detail.cost for detail in call.details) == pytest.approx(call.value)
    assert {detail.name: detail.expected for detail in call.details} == targets
    assert {detail.name for detail in call.details if detail.percent} == names & IN_PERCENT
    expected = measured(shape, labels, 1)
    for detail in call.details:
        assert detail.value == pytest.approx(expected[detail.name], rel=1e-5, abs=1e-9)


def test_what_counts_by_ratio():
    assert BY_RATIO == RATIOS


def test_nothing_given_says_nothing(lump):
    _, coarse, rough = lump
    assert is_(Segmentation.from_labels(coarse, rough, 2).parts[0]) == 0


def test_extents_of_what_is_known_by_heart(make):
    box = trimesh.creation.box((4, 2, 1e-9))
    plate = make.part((np.array(box.vertices), np.array(box.faces)))
    diagonal = math.hypot(4, 2)
    exact = {"length": 4 / diagonal, "width": 2 / diagonal}
    ball = make.part(make.ball(4))
    across = 2 / ball.shape.box_diagonal
    for part, found in (
        (plate, exact),
        (ball, dict.fromkeys(("length", "width", "depth"), across)),
    ):
        for name, value in found.items():
            assert is_(part, **{name: Target(value, value / 10)}) < 1e-3
    assert is_(ball, spread=Target(1 / math.sqrt(4 * math.pi), 0.01)) < 0.05
    assert is_(ball, boundary=Target(1, 1), crease=Target(0, 1)) > 5  # it has no boundary
    assert is_(ball, crease=Target(0, 1)) == 0


def test_of_a_solid_volumes_and_cuts_count():
    cube = Shape.from_voxels(np.ones((8, 8, 8), bool), pitch=1 / 8)
    half = Segmentation.from_labels(cube, (cube.points[:, 0] > 0.5).astype(int), 2).parts[0]
    assert half.area == pytest.approx(0.5)
    assert is_(half, area=Target(0.5, 0.1)) == pytest.approx(0, abs=1e-12)
    assert is_(half, boundary=Target(1 / 0.5 ** (2 / 3), 0.1)) == pytest.approx(0, abs=1e-12)


def test_only_the_fields_that_are_asked_for_are_read():
    assert fields_of({}) == ()
    assert fields_of({name: Target(1, 1) for name in RATIOS}) == ("basic:thickness",)
    everything = {name: Target(1, 1) for name in MEASURES}
    assert set(fields_of(everything)) == {
        f"basic:{name}" for name in ("thickness", "remoteness", "concavity")
    }
    problem = Problem(["a", "b"], "is(a, crease=0.5+-0.2) + is(b, area=0.1+-0.1)")
    assert problem.fields == ("basic:concavity",)


def test_the_area_is_what_seeders_expect():
    assert expected_share({"area": Target(0.06, 0.02)}) == 0.06
    found = Problem(["a", "b"], "is(a, area=0.06+-0.02) + is(b, length=1+-1)").expected_shares
    np.testing.assert_array_equal(found, [0.06, np.nan])


@pytest.mark.parametrize("wrong", ["area=1.5+-0.1", "area=0+-0.1", "thickness=0+-1", "weight=1+-1"])
def test_targets_are_checked_where_they_are_written(wrong):
    with pytest.raises(ExpressionError, match=r"is"):
        Problem(["a"], f"is(a, {wrong})")


def test_nasty_parts_have_finite_values(nasty):
    targets = {name: Target(0.5, 0.2) for name in MEASURES}
    for name, part in nasty.items():
        assert math.isfinite(is_(part, **targets)), name
        assert is_(part, **targets) >= 0, name
