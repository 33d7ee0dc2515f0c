"""Results as solids in one file: closed, and together the whole."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from moseg_core.errors import UsageError
from moseg_core.io.solid_files import write_3mf
from moseg_core.io.write.formats import check_writable
from moseg_core.shape.shape import Shape
from tests.io.threemf_files import objects_of
from tests.results import result_on


@pytest.mark.parametrize("kind", ["ball", "grid"])
def test_parts_are_closed_and_fill_the_whole(kind):
    if kind == "ball":
        ball = trimesh.creation.icosphere(subdivisions=2)
        shape = Shape.from_mesh(ball.vertices, ball.faces[np.argsort(ball.triangles_center[:, 2])])
    else:
        shape = Shape.from_voxels(np.ones((2, 3, 4), bool))
    found = objects_of(write_3mf(result_on(shape)))
    assert [name for name, *_ in found] == ["first", "second"]
    parts = [trimesh.Trimesh(places, faces, process=False) for _, _, places, faces in found]
    assert all(part.is_watertight and part.is_winding_consistent for part in parts)
    # Caps of the halves of a ball do not meet exactly.
    tolerance = 0.05 if kind == "ball" else 1e-9
    assert sum(part.volume for part in parts) == pytest.approx(shape.volume, rel=tolerance)


def test_clouds_are_refused_before_the_search_and_after_it():
    cloud = Shape.from_points(np.random.default_rng(0).random((20, 3)), name="cloud")
    with pytest.raises(UsageError, match="'cloud' is a point cloud"):
        check_writable(".3MF", cloud)
    with pytest.raises(UsageError, match="'cloud' is a point cloud"):
        write_3mf(result_on(cloud))
