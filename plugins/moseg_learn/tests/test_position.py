"""Positions on shapes whose axes are known, and on those whose axes are not determined."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_learn.position import POSITIONS, positions
from scipy.spatial.transform import Rotation

from moseg_core import Shape

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])


def fine(mesh, edge):
    return Shape.from_mesh(*trimesh.remesh.subdivide_to_size(mesh.vertices, mesh.faces, edge))


def of(shape):
    return dict(zip(POSITIONS, positions(shape).T, strict=True))


def test_on_a_rod():
    shape = fine(trimesh.creation.box((10, 0.4, 0.4)), 0.8)
    found, diagonal = of(shape), shape.box_diagonal
    points = shape.points / diagonal
    assert found["from_center"] == pytest.approx(np.linalg.norm(points, axis=1))
    assert found["lengthwise"] == pytest.approx(np.abs(points[:, 0]), abs=0.01)
    assert found["from_axis"] == pytest.approx(np.linalg.norm(points[:, 1:], axis=1), abs=0.01)
    ends = np.abs(shape.points[:, 0]) > 4.999
    assert found["facing_along"][ends] == pytest.approx(1, abs=0.01)
    assert found["facing_along"][~ends].max() < 0.01
    assert found["facing_across"][~ends] == pytest.approx(0.5, abs=0.01)
    assert found["outward"].min() > 0
    assert found["outward"][ends] == pytest.approx(1, abs=0.01)


def test_literally():
    mesh = trimesh.creation.icosphere(subdivisions=2)
    bent = mesh.vertices * [1.5, 1, 0.6] + 0.2 * np.sin(3 * mesh.vertices[:, [1, 2, 0]])
    shape = Shape.from_mesh(bent, mesh.faces)
    points, share = shape.points / shape.box_diagonal, shape.areas / shape.area
    center = share @ points
    covariance = sum(
        a * np.outer(p - center, p - center) for a, p in zip(share, points, strict=True)
    )
    inverse = np.linalg.inv(covariance)
    greatest = np.linalg.eigvalsh(covariance)[-1]
    normals = np.cross(*(bent[mesh.faces[:, k]] - bent[mesh.faces[:, 0]] for k in (1, 2)))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    found = positions(shape)
    for i in range(0, shape.n_elements, 20):
        q, n = points[i] - center, normals[i]
        expected = [
            np.linalg.norm(q),
            np.sqrt(q @ covariance @ q / greatest),
            np.sqrt(q @ q - q @ covariance @ q / greatest),
            n @ q / np.linalg.norm(q),
            n @ covariance @ n / np.trace(covariance),
            n @ inverse @ n / np.trace(inverse),
        ]
        assert found[i] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("mirrored", [False, True])
def test_where_axes_are_not_determined_the_shape_may_be_turned(mirrored):
    """Two axes of a vase are alike, all three of a cube: coordinates along them would be chance."""
    for mesh in (trimesh.creation.cylinder(1, 3, sections=24), trimesh.creation.box((1, 1, 1))):
        shape = fine(mesh, 0.6)
        vertices = np.asarray(shape.geometry.vertices) * [1, 1, -1 if mirrored else 1]
        turned = Shape.from_mesh(3 * GENERIC.apply(vertices) + [5, 0, 1], shape.geometry.triangles)
        # The diagonal of a cube's box is that of its own axes, which are chance too.
        lengths = np.array([1, 1, 1, 0, 0, 0])
        expected = shape.box_diagonal**lengths * positions(shape)
        found = (turned.box_diagonal / 3) ** lengths * positions(turned)
        assert found == pytest.approx(expected, abs=1e-6)


def test_on_a_sheet_all_is_finite():
    shape = Shape.from_mesh(
        *trimesh.remesh.subdivide_to_size(
            [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], 0.2
        )
    )
    found = of(shape)
    assert found["facing_across"] == pytest.approx(1, abs=1e-3)
    assert found["facing_along"] == pytest.approx(0, abs=1e-3)
    assert np.isfinite(positions(shape)).all()


def test_a_single_face_lies_in_its_own_middle():
    found = of(Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    assert [found[name].item() for name in POSITIONS[:4]] == [0, 0, 0, 0]
    assert np.isfinite([values.item() for values in found.values()]).all()
