from __future__ import annotations

import pytest
from moseg_objectives_basic.fields.height import DIRECTIONS

from moseg_core import Problem, Shape, UsageError


def value(term, labels=(0, 0, 0, 1)):
    """On a wall of four rows, each 1 high."""
    vertices = [[x, 0, z] for z in range(5) for x in (0, 1)]
    wall = Shape.from_mesh(vertices, [[2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2] for k in range(4)])
    return Problem(["a", "b"], term).evaluate(wall, list(labels)).cost.value


def test_by_how_much():
    """Centroids are at 3/8 and 7/8."""
    assert value("above(b, a)") == 0
    assert value("above(a, b)") == pytest.approx((0.1 + 0.5) / 1.1)
    assert value("above(b, a, margin=0.5)") == 0
    assert value("above(b, a, margin=0.75)") == pytest.approx(0.25 / 1.75)
    assert value("above(a, b, margin=0)") == pytest.approx(0.5)


def test_level_parts():
    assert value("above(a, b)", (0, 1, 1, 0)) == pytest.approx(0.1 / 1.1)


def test_another_way_up():
    assert value('above(a, b, up="-z")') == 0
    assert value('above(b, a, up="-z")') == pytest.approx(0.6 / 1.1)
    assert value('above(a, b, up="y")') == pytest.approx(0.1 / 1.1)
    with pytest.raises(UsageError, match="up is one of x, -x"):
        value('above(a, b, up="up")')


def test_all_directions_can_be_written():
    for up in DIRECTIONS:
        assert 0 <= value(f'above(a, b, up="{up}")') <= 1
