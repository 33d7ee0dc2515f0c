from __future__ import annotations

import pytest
import trimesh
from moseg_objectives_basic.middle import central, remote

from moseg_core import Segmentation, Shape, coarsen


def thirds(n=None):
    """A rod in three equal lengths; of groups of elements, if that many are given."""
    box = trimesh.creation.box((9, 0.3, 0.3))
    shape = Shape.from_mesh(*trimesh.remesh.subdivide_to_size(box.vertices, box.faces, 0.3))
    level = shape if n is None else coarsen(shape, n)
    labels = ((level.points[:, 0] + 4.5) // 3).clip(0, 2).astype(int)
    return Segmentation.from_labels(level, labels, 3).parts


@pytest.mark.parametrize("n", [None, 300])
def test_thirds_of_a_rod(n):
    """The mean of 1 + x^2 over a third: 1 + 1/27 in the middle, 1 + 13/27 at the ends."""
    first, middle, last = thirds(n)
    for part, mean in ((first, 40 / 27), (middle, 28 / 27), (last, 40 / 27)):
        assert remote(part) == pytest.approx(1 / mean, rel=0.05)
        assert central(part) == pytest.approx(1 - 1 / mean, abs=0.04)
        assert central(part) + remote(part) == pytest.approx(1)


def test_a_limb_that_is_bent_is_as_remote():
    box = trimesh.creation.box((9, 0.3, 0.3))
    vertices, faces = trimesh.remesh.subdivide_to_size(box.vertices, box.faces, 0.3)
    bent = vertices.copy()
    end = vertices[:, 0] > 1.5
    bent[end, 2] += vertices[end, 0] - 1.5
    bent[end, 0] = 1.5
    bent[end, 0] += vertices[end, 2]
    labels = (vertices[faces].mean(axis=1)[:, 0] > 1.5).astype(int)
    values = [
        remote(Segmentation.from_labels(Shape.from_mesh(v, faces), labels, 2).parts[1])
        for v in (vertices, bent)
    ]
    assert values[1] == pytest.approx(values[0], rel=0.08)


def test_nasty_parts_stay_in_range(nasty):
    for name, part in nasty.items():
        assert 0 <= central(part) < 1, name
        assert 0 < remote(part) <= 1, name
