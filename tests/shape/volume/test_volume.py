"""A volume with its source, and what shapes say of theirs."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.shape.coarse import coarsen
from moseg_core.shape.shape import Shape
from moseg_core.shape.volume.volume import Volume
from tests import shapes

CLOUD = Shape.from_points(shapes.sphere(2)[0], normals=shapes.sphere(2)[0])


def test_a_volume_has_a_source_and_none_has_a_reason():
    assert Volume.exact(2.0) == Volume(value=2.0, source="exact", reason="")
    assert Volume.none("it is flat") == Volume(value=None, source=None, reason="it is flat")


@pytest.mark.parametrize(
    ("shape", "source"),
    [
        (Shape.from_mesh(*shapes.cube()), "exact"),
        (Shape.from_voxels(np.ones((2, 2, 2), bool)), "exact"),
        (Shape.from_voxels(np.ones((3, 3, 3), bool), elements="surface"), "exact"),
        (Shape.from_mesh(*shapes.cube()).with_volume("1"), "user"),
        (CLOUD.with_volume("hull"), "hull"),
        (CLOUD.with_volume("winding"), "winding"),
        (CLOUD.with_volume("hull").with_volume(3), "user"),
        (CLOUD, None),
    ],
    ids=str,
)
def test_where_the_volume_of_a_shape_came_from(shape, source):
    assert shape.volume_source == source
    assert (shape.volume is None) == (source is None) == bool(shape.volume_reason)
    for other in (shape.with_adjacency("knn"), coarsen(shape, 4)):
        assert other.enclosed == shape.enclosed


def test_the_last_word_counts_and_is_noted():
    twice = CLOUD.with_volume("hull").with_volume(3)
    assert twice.notes == ("the enclosed volume is taken to be 3, as given",)
