from __future__ import annotations

import pytest
from moseg_objectives_basic.fields.height import DIRECTIONS, height

from moseg_core import Shape, UsageError


@pytest.mark.parametrize("up", DIRECTIONS)
def test_from_the_lowest_to_the_highest(make, up):
    vertices, faces = make.moved(make.box(2, 4, 8), shift=[5, 6, 7])
    values = height(Shape.from_mesh(vertices, faces), up=up)
    low, high = 2 * "xyz".index(up[-1]), 2 * "xyz".index(up[-1]) + 1
    if up.startswith("-"):
        low, high = high, low
    assert (values[low], values[high]) == (0, 1)
    assert sorted(values.tolist())[1:-1] == pytest.approx([0.5] * 4)


def test_a_flat_shape_is_half_way_up(make):
    assert height(Shape.from_mesh(*make.rectangle(2, 1))).tolist() == [0.5]


def test_vertices_of_no_face_do_not_count():
    shape = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 0, 3], [0, 0, 99]], [[0, 1, 2]])
    assert height(shape).tolist() == pytest.approx([1 / 3])


def test_another_direction_is_refused(make):
    with pytest.raises(UsageError, match="up is one of x, -x, y, -y, z, -z, not 'up'"):
        height(Shape.from_mesh(*make.box(1, 1, 1)), up="up")
