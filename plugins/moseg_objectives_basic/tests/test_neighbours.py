from __future__ import annotations

import numpy as np
import pytest
from moseg_objectives_basic.neighbours import apart, touching

from moseg_core import ExpressionError, Problem, Segmentation, Shape, coarsen


def strip(n=8):
    vertices = [[x, y, 0] for x in range(n + 1) for y in (0, 6)]
    return Shape.from_mesh(vertices, [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(n)])


def value(expression, labels):
    names = ["a", "b", "c", "d"][: max(labels) + 1]
    return Problem(names, expression).evaluate(strip(len(labels)), labels).cost.value


def test_parts_that_touch():
    assert value("touching(a, b)", [0, 0, 0, 1, 1, 1, 1, 1]) == 0
    assert value("touching(b, a)", [0, 0, 0, 1, 1, 1, 1, 1]) == 0


@pytest.mark.parametrize("gap", [2, 3, 5])
def test_a_gap_leads_parts_to_each_other(gap):
    labels = [0, 2, 2, 2, 2, 2, 2, 2]
    labels[gap] = 1
    assert value("touching(a, b)", labels) == pytest.approx(gap / 10)
    assert value("touching(b, a)", labels) == pytest.approx(gap / 10)


def test_the_first_touches_each_of_the_others():
    labels = [1, 0, 0, 2, 2, 3, 3, 3]
    assert value("touching(a, b, c)", labels) == 0
    assert value("touching(a, b, c, d)", labels) == pytest.approx(3 / 10 / 3)
    assert value("touching(b, c, d)", labels) == pytest.approx((3 + 5) / 10 / 2)


def test_the_nearest_elements_count():
    shape = Shape.from_mesh(*_ball())
    rng = np.random.default_rng(0)
    coarse = coarsen(shape, 150)
    for level in (shape, coarse):
        labels = rng.integers(0, 3, level.n_elements) // 2 * 2
        labels[level.points[:, 0] > 0.7] = 1
        labels[(level.points[:, 0] > 0.4) & (labels != 1)] = 2
        labels[level.points[:, 0] < 0] = np.minimum(labels[level.points[:, 0] < 0], 2)
        parts = Segmentation.from_labels(level, labels, 3).parts
        assert not parts[0].boundary_with(parts[1]).length
        between = level.points[labels == 0][:, None] - level.points[labels == 1]
        expected = np.linalg.norm(between, axis=2).min() / shape.box_diagonal
        assert touching(parts[:2]) == pytest.approx(expected)


def _ball():
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=3)
    return np.array(mesh.vertices), np.array(mesh.faces)


def test_apart_is_the_share_of_the_shorter_boundary():
    assert value("apart(a, b)", [0, 0, 2, 2, 2, 2, 1, 1]) == 0
    assert value("apart(a, b)", [0, 1, 1, 1, 2, 2, 2, 2]) == 1
    # Two pieces of b beside one of a and one of c: half of its boundary is with a.
    assert value("apart(a, b)", [2, 0, 1, 2, 2, 2, 0, 2]) == pytest.approx(0.5)


def test_no_two_of_several():
    labels = [1, 0, 0, 2, 2, 3, 3, 3]
    assert value("apart(b, c, d)", labels) == pytest.approx(1 / 3)
    assert value("apart(b, c, d)", labels) == value("apart(d, b, c)", labels)
    assert value("apart(b, d)", labels) == 0


def test_one_part_alone_is_refused():
    for word in ("touching", "apart"):
        with pytest.raises(ExpressionError, match="2 labels or more"):
            Problem(["a", "b"], f"{word}(a)")


def test_in_range_on_nasty_parts(nasty):
    cells = [nasty[name] for name in ("all but a little", "one triangle", "two far triangles")]
    for first in cells:
        for second in cells:
            if first is not second:
                assert 0 <= touching((first, second)) <= 1
                assert 0 <= apart((first, second)) <= 1
