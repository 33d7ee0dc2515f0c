from __future__ import annotations

import pytest
from moseg_objectives_basic.size import large, small

from moseg_core import Problem, Shape


def test_shares():
    vertices = [[x, y, 0] for x in range(9) for y in (0, 1)]
    faces = [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(8)]
    shape, labels = Shape.from_mesh(vertices, faces), [0, 0] + [1] * 6
    found = Problem(["a", "b"], "small(*) + large(*)").evaluate(shape, labels)
    values = [call.value for term in found.terms for call in term.calls]
    assert values == pytest.approx([0.25, 0.75, 0.75, 0.25])


def test_nasty_parts_stay_in_range(nasty):
    for name, part in nasty.items():
        assert 0 <= small(part) <= 1, name
        assert small(part) + large(part) == pytest.approx(1), name
