from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

from moseg_core.errors import UsageError
from moseg_core.segmentation import Segmentation
from moseg_core.shape import Shape
from moseg_core.testing.zoo import ZOO, faces_of, labellings, shapes, specimen

CLOSED = {"tetrahedron", "cube", "sphere", "two_components", "duplicate_vertices"}
CLOSED |= {"voxels", "sample", "twin", "lump"}


@pytest.mark.parametrize("name", ZOO)
def test_every_specimen_is_what_it_is_called(name):
    shape = specimen(name)
    assert shape.name == name
    assert (shape.volume is not None) == (name in CLOSED)
    assert (shape.adjacency is None) == (name == "cloud")
    assert shape.has_surface == (name not in ("cloud", "voxels"))
    assert any("no area" in note for note in shape.notes) == (name == "zero_area_face")
    assert any("duplicate" in note for note in shape.notes) == (name == "duplicate_vertices")
    assert any("2 connected" in note for note in shape.notes) == (name == "two_components")


def test_a_specimen_that_was_spoilt_comes_new():
    first = specimen("lump")
    first.geometry.vertices.flags.writeable = True
    first.geometry.vertices[:] = 0.0
    assert specimen("lump").fingerprint != first.fingerprint
    assert specimen("lump").fingerprint == specimen("lump").fingerprint


def test_an_edge_of_three_faces():
    faces = faces_of(specimen("nonmanifold_edge"))
    assert sum({0, 1} <= set(face) for face in faces) == 3


def test_unknown_names_are_refused_with_the_nearest():
    with pytest.raises(UsageError, match="did you mean 'tetrahedron'"):
        specimen("tetraeder")


@pytest.mark.parametrize("name", ZOO)
def test_every_part_has_an_element(name):
    shape = specimen(name)
    found = labellings(shape)
    assert [f.n_parts for f in found] == [n for n in (1, 2, 3, 2) if n <= shape.n_elements]
    for labelling in found:
        assert set(labelling.labels.tolist()) == set(range(labelling.n_parts))


def test_the_lump_is_in_generic_position():
    lump = specimen("lump")
    for labelling in labellings(lump):
        for part in Segmentation.from_labels(lump, labelling.labels, labelling.n_parts).parts:
            values = part.scales**2
            assert (-np.diff(values) / values[0]).min() > 1e-3
    apart = np.linalg.norm(lump.points[:, None] - lump.points[None], axis=2)
    apart = np.sort(apart[np.triu_indices(len(apart), 1)])
    assert np.diff(apart).min() > 0


def test_the_twin_is_its_own_mirror_image_in_one_plane():
    vertices = specimen("twin").geometry.vertices

    def mirrored(axis):
        signs = np.ones(3)
        signs[axis] = -1.0
        images = vertices * signs
        return np.abs(images[:, None] - vertices[None]).sum(axis=2).min(axis=1).max() < 1e-9

    assert [mirrored(axis) for axis in range(3)] == [True, False, False]


@settings(max_examples=20)
@given(shapes(among=["cube", "disc", "cloud", "sample"]))
def test_drawn_shapes_keep_their_elements(shape):
    assert isinstance(shape, Shape)
    assert shape.n_elements == specimen(shape.name).n_elements
    assert (shape.volume is None) == (shape.name in ("disc", "cloud"))
