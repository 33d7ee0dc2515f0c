"""From which sides a shape is looked at."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from moseg_core.errors import UsageError
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.view.views import read_views, rotations_of

UP = np.array([0.0, 0.0, 1.0])


def box(extents):
    """A box with a nose at the middle of its side in the direction x."""
    body = trimesh.creation.box(extents).subdivide().subdivide()
    nose = trimesh.creation.box([2, 0.3, 0.3]).apply_translation([extents[0] / 2 + 1, 0, 0])
    both = trimesh.util.concatenate([body, nose])
    return PolygonMesh.from_faces(np.array(both.vertices), np.array(both.faces))


def test_views_are_read_by_name_or_number():
    assert read_views(" Front,TOP ") == ("front", "top")
    assert read_views("5") == 5
    with pytest.raises(UsageError, match="unknown view 'frnt'; did you mean 'front'"):
        read_views("top,frnt")
    for many in ("0", "37"):
        with pytest.raises(UsageError, match="allowed are 1 to 36"):
            read_views(many)


@pytest.mark.parametrize("extents", [[3, 1, 1], [1, 5, 1]], ids=["along", "across"])
def test_the_front_is_where_left_and_right_are_alike(extents):
    names = ("front", "back", "left", "right", "top", "bottom")
    found = rotations_of(box(extents), names, UP)
    toward = {name: rotation[2].round(6) for name, rotation in zip(names, found, strict=True)}
    assert toward["front"].tolist() == [1, 0, 0]  # where the nose is, however long the box
    assert (toward["back"] == -toward["front"]).all()
    assert toward["right"].tolist() == [0, 1, 0]
    assert (toward["left"] == -toward["right"]).all()
    assert toward["top"].tolist() == [0, 0, 1]
    assert toward["bottom"].tolist() == [0, 0, -1]
    for name, rotation in zip(names, found, strict=True):
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(rotation) > 0
        assert name in ("top", "bottom") or rotation[1] @ UP == pytest.approx(1)
    assert found[4][1].round(6).tolist() == [-1, 0, 0]  # from above the front is below


def test_a_number_of_views_goes_all_around():
    found = rotations_of(box([3, 1, 1]), 4, UP)
    toward = np.array([rotation[2] for rotation in found])
    np.testing.assert_allclose(toward[:, 2], np.sin(np.radians(20)))
    np.testing.assert_allclose(toward[:, :2].sum(axis=0), 0, atol=1e-9)
    assert (found[0] == rotations_of(box([3, 1, 1]), ["main"], UP)[0]).all()
