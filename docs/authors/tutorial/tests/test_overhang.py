"""Known answers, a property, and the example of the docstring."""

import doctest
import importlib
import math

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from moseg_core import Problem, Shape, UsageError

# The function has the name of its module.
overhang = importlib.import_module("moseg_printing.overhang")


def cost(shape, angle=45.0):
    problem = Problem(["a"], f"printing:overhang(a, angle={angle!r})")
    return problem.evaluate(shape, [0] * shape.n_elements).cost.value


def table(legs_down=True):
    """A plate of 3 x 3 x 1 on a leg of 1 x 1 x 2."""
    cells = [(x, y, 2) for x in range(3) for y in range(3)] + [(1, 1, 0), (1, 1, 1)]
    return cubes(cells if legs_down else [(x, y, 2 - z) for x, y, z in cells])


def cubes(cells):
    """The surface of unit cubes, as squares that look outwards."""
    steps = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    vertices, faces = [], []
    for cell in cells:
        for axis, step in enumerate(steps):
            u, v = steps[(axis + 1) % 3], steps[(axis + 2) % 3]
            for out in (1, -1):
                beyond = tuple(c + out * s for c, s in zip(cell, step, strict=True))
                if beyond in cells:
                    continue
                corner = [c + (s if out > 0 else 0) for c, s in zip(cell, step, strict=True)]
                ring = [(0, 0), (1, 0), (1, 1), (0, 1)][::out]
                faces.append(list(range(len(vertices), len(vertices) + 4)))
                for i, j in ring:
                    place = zip(corner, u, v, strict=True)
                    vertices.append([c + i * p + j * q for c, p, q in place])
    return Shape.from_mesh(vertices, faces)


def test_a_table_hangs_over_beside_its_leg_and_not_upside_down():
    assert cost(table()) == pytest.approx(8 * 2 / (9 * 3))  # 8 of 9 looking down, at 2 of 3
    assert cost(table(legs_down=False)) == 0


@pytest.mark.parametrize("angle", [0.0, 45.0, 89.0])
def test_a_cube_rests_on_its_underside(angle):
    assert cost(cubes([(0, 0, 0)]), angle) == 0


def test_nothing_needs_support_where_any_angle_will_do():
    assert cost(table(), 90.0) == 0


def test_what_is_flat_on_the_plate_needs_nothing():
    assert cost(Shape.from_mesh([[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]], [[0, 1, 2, 3]])) == 0


@settings(deadline=None)
@given(st.floats(1, 89), st.floats(0.01, 100), st.floats(0, 90))
def test_a_leaning_square_needs_support_beyond_the_angle(leans, size, angle):
    assume(not math.isclose(leans, angle, abs_tol=1e-6))
    x, z = size * math.sin(math.radians(leans)), size * math.cos(math.radians(leans))
    square = Shape.from_mesh([[0, 0, 0], [x, 0, z], [x, size, z], [0, size, 0]], [[0, 3, 2, 1]])
    assert cost(square, angle) == pytest.approx(0.5 if leans > angle else 0.0)


def test_an_angle_out_of_bounds_is_refused():
    with pytest.raises(UsageError, match=r"'angle' is 120.*; allowed is 0 to 90"):
        cost(table(), 120.0)


def test_the_example_runs():
    assert doctest.testmod(overhang).failed == 0
