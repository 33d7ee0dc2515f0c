"""MJCF, read back as XML: bodies, assets that are used and files that are there."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import pytest
from moseg_robotics.mjcf import write_mjcf


def test_a_body_for_each_part_within_one(mallet):
    files = write_mjcf(mallet, name="m.mjcf")
    assert files == write_mjcf(mallet, name="m.mjcf")
    model = ElementTree.fromstring(files["m.mjcf"])
    (whole,) = model.findall("worldbody/body")
    bodies = whole.findall("body")
    assert [whole.get("name"), *(body.get("name") for body in bodies)] == ["m", "handle", "head"]
    folder = model.find("compiler").get("meshdir")
    assets = {mesh.get("name"): mesh.get("file") for mesh in model.iter("mesh")}
    assert {f"{folder}/{file}" for file in assets.values()} == set(files) - {"m.mjcf"}
    used = [geom.get("mesh") for geom in model.iter("geom")]
    assert sorted(used) == sorted(assets)
    names = [geom.get("name") for geom in model.iter("geom")]
    assert len(set(names)) == len(names)


def test_what_is_seen_collides_with_nothing(mallet):
    model = ElementTree.fromstring(write_mjcf(mallet, name="m.mjcf")["m.mjcf"])
    for body in model.findall("worldbody/body/body"):
        seen, hull = body.findall("geom")
        assert (seen.get("contype"), seen.get("conaffinity"), seen.get("group")) == ("0", "0", "2")
        assert (hull.get("contype"), hull.get("group")) == (None, "3")
    head = model.findall("worldbody/body/body")[1]
    assert float(head.find("inertial").get("mass")) == pytest.approx(3.0)
    moments = list(map(float, head.find("inertial").get("fullinertia").split()))
    assert moments == pytest.approx([2.5, 2.5, 0.5, 0, 0, 0], abs=1e-6)
    assert list(map(float, head.get("pos").split())) == pytest.approx([1000, 0, 50])


def test_a_shape_with_y_up_is_turned_as_a_whole(mallet):
    lying = replace(mallet, shape=mallet.shape.with_up("y"))
    for result, turn in ((mallet, None), (lying, "1.57079632679 0 0")):
        model = ElementTree.fromstring(write_mjcf(result, name="m.mjcf")["m.mjcf"])
        assert model.find("worldbody/body").get("euler") == turn
