"""3MF files as archives of XML: objects, materials, assembly, and equal bytes."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import pytest

from moseg_core.errors import UsageError
from moseg_core.io.write.threemf import Solid, check_solids, encode_3mf
from moseg_core.shape.shape import Shape
from tests.io.threemf_files import CORE, model_of, objects_of

CORNERS = np.array([[0.1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1e-7], [9, 9, 9]])
TENT = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
COLORS = [[255, 0, 1], [0, 128, 2]]


def solid(name, triangles=TENT):
    return Solid(name=name, vertices=CORNERS, triangles=triangles)


def test_each_part_is_an_object_of_its_color_in_one_assembly():
    data = encode_3mf([solid("left arm"), solid("body", TENT[:, ::-1])], COLORS, name="horse")
    (one, red, places, triangles), (other, green, _, turned) = objects_of(data)
    assert (one, red, other, green) == ("left arm", "#FF0001FF", "body", "#008002FF")
    assert places == CORNERS[:4].tolist()  # the fifth is no corner of a triangle
    assert triangles == TENT.tolist()
    assert turned == TENT[:, ::-1].tolist()
    model = model_of(data)
    assert model.get("unit") == "millimeter"
    (item,) = model.iter(f"{CORE}item")
    (assembly,) = [o for o in model.iter(f"{CORE}object") if o.get("id") == item.get("objectid")]
    assert assembly.get("name") == "horse"
    ids = [part.get("objectid") for part in assembly.iter(f"{CORE}component")]
    assert ids == [o.get("id") for o in model.iter(f"{CORE}object") if o is not assembly]


def test_triangles_without_extent_and_empty_parts_are_left_out():
    needle = np.concatenate([TENT, [[1, 1, 2]]])
    data = encode_3mf([solid("nothing", needle[4:]), solid("tent", needle)], COLORS, name="x")
    ((name, color, _, triangles),) = objects_of(data)
    assert (name, color, triangles) == ("tent", "#008002FF", TENT.tolist())


@pytest.mark.parametrize("name", ["../../x", "<script>&\"'", "a\nb", "", "\ud800", "x" * 10_000])
def test_any_name_leaves_the_file_whole(name):
    (found, *_), (other, *_) = objects_of(encode_3mf([solid(name), solid("b")], COLORS, name=name))
    assert other == "b"
    if name.isprintable() and name:
        # The assembly, named alike, is the one that gets a number.
        assert found in (name, f"{name}_2")


def test_nothing_tells_when_it_was_made():
    data = encode_3mf([solid("a")], COLORS[:1], name="x")
    assert data == encode_3mf([solid("a")], COLORS[:1], name="x")
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


def test_what_is_refused():
    with pytest.raises(UsageError, match="1 parts need as many colours"):
        encode_3mf([solid("a")], COLORS, name="x")
    cloud = Shape.from_points(CORNERS, name="cloud")
    with pytest.raises(UsageError, match=r"'cloud' is a point cloud, and a \.3mf file holds solid"):
        check_solids(cloud)
