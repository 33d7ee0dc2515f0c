from __future__ import annotations

import math

import numpy as np
import pytest
from moseg_learn.pieces import pieces_of
from moseg_learn.profile import FLOORS, USUAL, measures_of, profiles_of

from moseg_core import Example, Problem, Shape


def test_typical_values_and_spreads_against_a_slow_reference(herd):
    pieces = [pieces_of(example) for example in herd]
    found = profiles_of(pieces, prior=6.0, floor=2.0)
    rows = {}
    for one in pieces:
        names, values, by_ratio = measures_of(one)
        for kind, row in zip(one.kinds, values, strict=True):
            rows.setdefault(kind, []).append(dict(zip(names, row.tolist(), strict=True)))
    assert {kind: len(found) for kind, found in rows.items()} == {
        "body": 3,
        "head": 3,
        "leg": 9,
        "tail": 1,
    }
    for name in names:

        def seen(row, name=name):
            return math.log(row[name]) if name in by_ratio else row[name]

        off = []
        for kind in ("body", "head", "leg"):
            mean = np.mean([seen(row) for row in rows[kind]])
            off += [(seen(row) - mean) ** 2 for row in rows[kind]]
        common = math.sqrt(np.mean(off)) + 2 * FLOORS[name]
        for kind, own in rows.items():
            values = [seen(row) for row in own]
            mean, n = np.mean(values), len(values)
            spread = math.sqrt((np.var(values) * n + 6 * common**2) / (n + 6))
            target = found[kind][name]
            # As 'is' reads it: one spread above the typical value costs 1.
            above = mean + spread
            cost = target.ratio_cost(math.exp(above)) if name in by_ratio else target.cost(above)
            assert cost == pytest.approx(1.0, abs=0.2), (kind, name)
            middle = target.ratio_cost(math.exp(mean)) if name in by_ratio else target.cost(mean)
            assert middle < 0.01, (kind, name)


def test_each_more_example_narrows_the_profile_of_what_does_not_vary(make):
    one = pieces_of(make.beast())
    alone, many = (profiles_of([one] * n, prior=6.0, floor=2.0) for n in (1, 4))
    for name, target in alone["body"].items():
        assert many["body"][name].value == pytest.approx(target.value, rel=0.05)
        assert many["body"][name].spread < target.spread, name


def test_one_example_without_limbs_has_the_usual_spreads():
    box = Shape.from_mesh(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [3, 0, 0], [3, 1, 0]],
        [[0, 1, 2, 3], [1, 4, 5, 2]],
    )
    found = profiles_of([pieces_of(Example(box, [0, 1], ("a", "b")))], prior=6.0, floor=2.0)
    prior = USUAL["offcenter"] + 2 * FLOORS["offcenter"]
    expected = math.sqrt(6 / 7) * prior
    assert found["a"]["offcenter"].spread == pytest.approx(expected, rel=0.05)


def test_a_profile_is_what_is_takes(herd):
    found = profiles_of([pieces_of(example) for example in herd], prior=6.0, floor=2.0)
    own = pieces_of(herd[0])
    said = ", ".join(f"{name}={target}" for name, target in found["leg"].items())
    problem = Problem(["body", "head", "leg1", "leg2", "leg3"], f"is(leg*, {said})")
    assert problem.evaluate(own.shape, own.labels).cost.value < 3 * 0.5


def test_what_a_shape_does_not_tell_is_left_out():
    points = np.random.default_rng(0).normal(size=(60, 3))
    cloud = Example(Shape.from_points(points), (points[:, 0] > 0).astype(int), ("a", "b"))
    found = profiles_of([pieces_of(cloud)], prior=6.0, floor=2.0)
    assert set(found["a"]) == {"area", "length", "width", "depth", "spread", "offcenter"}


def test_numbers_have_the_digits_that_mean_something(herd):
    for profile in profiles_of([pieces_of(e) for e in herd], prior=6.0, floor=2.0).values():
        for target in profile.values():
            assert len(f"{target.spread:.10f}".strip("0.").replace(".", "")) <= 3, target
            assert target.spread == float(f"{target.spread:.2g}")


def test_of_what_is_flat_no_depth_is_told():
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [3, 0, 1], [3, 1, 1], [4, 0, 0]]
    shape = Shape.from_mesh([*vertices, [4, 1, 0]], [[0, 1, 2, 3], [1, 4, 5, 2], [4, 6, 7, 5]])
    found = profiles_of(
        [pieces_of(Example(shape, [0, 1, 1], ("flat", "bent")))], prior=6.0, floor=2.0
    )
    assert "depth" not in found["flat"]
    assert "depth" in found["bent"]
