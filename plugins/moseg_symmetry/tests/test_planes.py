from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from moseg_symmetry.planes import Plane, read_plane, refuse_in

from moseg_core import ShapeError, UsageError

numbers = st.floats(-10, 10, allow_subnormal=False)
vectors = st.tuples(numbers, numbers, numbers)


@st.composite
def planes(draw):
    normal = draw(vectors.filter(lambda v: np.linalg.norm(v) > 1e-3))
    return Plane.through(draw(vectors), normal)


@given(plane=planes(), point=vectors)
def test_reflection_and_projection(plane, point):
    x = np.array([point])
    image, foot = plane.reflect(x), plane.project(x)
    tight = {"atol": 1e-13, "rtol": 0}
    np.testing.assert_allclose(plane.reflect(image), x, **tight)
    np.testing.assert_allclose((x + image) / 2, foot, **tight)
    np.testing.assert_allclose(plane.heights(foot), 0, **tight)
    np.testing.assert_allclose(plane.heights(image), -plane.heights(x), **tight)
    # The literal reflection: I - 2 n n^T about the point.
    matrix = np.eye(3) - 2 * np.outer(plane.normal, plane.normal)
    np.testing.assert_allclose(image[0], plane.point + matrix @ (x[0] - plane.point), **tight)


@given(plane=planes())
def test_axes_span_the_plane(plane):
    basis = np.vstack([plane.axes(), plane.normal])
    np.testing.assert_allclose(basis @ basis.T, np.eye(3), atol=1e-15)


@given(plane=planes())
def test_both_normals_mean_one_plane(plane):
    other = Plane.through(plane.point, -7.5 * plane.normal)
    np.testing.assert_allclose(other.normal, plane.normal, atol=1e-15)
    np.testing.assert_allclose(other.axes(), plane.axes(), atol=1e-14)


@given(plane=planes(), point=vectors)
def test_text_is_read_back(plane, point):
    again = read_plane(str(plane), center=np.zeros(3))
    x = np.array([point])
    np.testing.assert_allclose(again.reflect(x), plane.reflect(x), atol=1e-6)


@given(plane=planes(), point=vectors)
def test_unit_coordinates(plane, point):
    center, scale = np.array([3.0, -1.0, 2.0]), 40.0
    x = np.array([point])
    unit = plane.to_unit(center, scale).reflect((x - center) / scale)
    np.testing.assert_allclose(unit * scale + center, plane.reflect(x), atol=1e-12)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_axes_of_the_file(axis):
    center = np.array([1.0, 2.0, 3.0])
    plane = read_plane(" xyz"[axis + 1], center=center)
    assert plane.point.tolist() == center.tolist()
    assert plane.normal.tolist() == np.eye(3)[axis].tolist()


@pytest.mark.parametrize("length", [1e-200, 1.0, 1e200])
def test_normals_of_any_length(length):
    plane = read_plane(f"1,2,3,0,{-3 * length!r},{4 * length!r}", center=np.zeros(3))
    np.testing.assert_allclose(plane.normal, [0, -0.6, 0.8], atol=1e-15)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("w", "not understood"),
        ("X", "not understood"),
        ("", "not understood"),
        ("1,2,3,a,b,c", "not understood"),
        ("1", "1 number instead of 6"),
        ("0,0,0,1,0", "5 numbers instead of 6"),
        ("0,0,0,1,0,0,0", "7 numbers instead of 6"),
        ("0,0,0,0,0,0", "normal of length 0"),
        ("0,0,0,-0.0,0,0", "normal of length 0"),
        ("0,0,inf,1,0,0", "not finite"),
        ("0,0,0,nan,0,0", "not finite"),
    ],
)
def test_malformed(text, reason):
    with pytest.raises(UsageError, match=reason) as error:
        read_plane(text, center=np.zeros(3))
    assert f"plane '{text}'" in str(error.value)
    for allowed in ("'auto'", "'x'", "px,py,pz,nx,ny,nz"):
        assert allowed in str(error.value)


def test_planes_of_the_file_mean_nothing_elsewhere():
    refuse_in("original", "x")
    with pytest.raises(ShapeError, match=r"plane 'x' .*space 'mds'"):
        refuse_in("mds", "x")
