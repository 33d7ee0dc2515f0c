from __future__ import annotations

import gc
import weakref

import moseg_symmetry.plane_detection as detection
import numpy as np
import pytest
from moseg_symmetry.constraints import Mirror, OnPlane
from moseg_symmetry.plane_of import plane_of

from moseg_core import ShapeError, coarsen


@pytest.fixture
def searches(monkeypatch):
    """The shapes on which a plane was looked for."""
    asked = []
    original = detection.require_plane

    def counted(shape):
        asked.append(weakref.ref(shape))
        return original(shape)

    monkeypatch.setattr(detection, "require_plane", counted)
    return asked


def test_found_once_for_each_shape(make, searches):
    shape = make.shape(make.moved(make.stool(), scale=9.0))
    coarse = coarsen(shape, 150)
    planes = [
        plane_of(coarse, "auto"),
        plane_of(shape, " auto "),
        Mirror(shape, [0, 1]).plane,
        OnPlane(coarse, [2]).plane,
    ]
    assert [reference() for reference in searches] == [shape]
    for plane in planes:
        assert (plane.point == planes[0].point).all()
        assert (plane.normal == planes[0].normal).all()


def test_in_unit_coordinates(make):
    shape = make.shape(make.moved(make.stool(), scale=9.0))
    plane = plane_of(shape, "auto")
    assert make.angle_between(plane.normal, make.GENERIC.apply([1, 0, 0])) < 1e-5
    assert abs(plane.heights(shape.frame.to_unit(make.SHIFT))) < 1e-5


def test_shapes_are_not_kept(make, searches):
    shape = make.shape(make.stool())
    mirror = Mirror(shape, [0, 1])
    del shape
    gc.collect()
    assert searches[0]() is None
    assert mirror.expand(np.empty(0), np.ones((2, 4))).shape == (2, 4)


def test_none_is_refused_by_name(make):
    with pytest.raises(ShapeError, match="'potato' has no plane of symmetry"):
        OnPlane(make.shape(make.blob(), name="potato"), [0])


def test_found_in_the_space_of_the_partition(make):
    """Bent straight, a crooked shape has a plane that it did not have before."""
    straight = make.stool()
    vertices = (
        straight.vertices
        + np.c_[0.5 * straight.vertices[:, 1:2] ** 2, np.zeros((len(straight.vertices), 2))]
    )
    crooked = make.shape(type(straight)(vertices, straight.faces, process=False))
    embedded = crooked.deformed(straight.vertices, space="straight")
    plane = plane_of(embedded, "auto")
    assert make.angle_between(plane.normal, [1, 0, 0]) < 1e-5
    original = plane_of(crooked, "auto") if detection.detect_planes(crooked)[0].holds else None
    assert original is None or make.angle_between(original.normal, [1, 0, 0]) > 1e-2
    with pytest.raises(ShapeError, match="space 'straight'"):
        plane_of(embedded, "x")
