"""URDF, read back as XML: a tree of links, with what each needs, and files that are there."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from moseg_robotics.urdf import write_urdf

from moseg_core import save


def test_a_link_for_each_part_is_fixed_to_the_root(mallet):
    files = write_urdf(mallet, name="big hammer.urdf")
    assert files == write_urdf(mallet, name="big hammer.urdf")
    robot = ElementTree.fromstring(files["big hammer.urdf"])
    assert (robot.tag, robot.get("name")) == ("robot", "big_hammer")
    assert [link.get("name") for link in robot.iter("link")] == ["big_hammer", "handle", "head"]
    ties = [
        (j.find("parent").get("link"), j.find("child").get("link")) for j in robot.iter("joint")
    ]
    assert ties == [("big_hammer", "handle"), ("big_hammer", "head")]
    assert {joint.get("type") for joint in robot.iter("joint")} == {"fixed"}
    named = [mesh.get("filename") for mesh in robot.iter("mesh")]
    assert sorted(named) == sorted(set(files) - {"big hammer.urdf"})


def test_a_link_has_mass_inertia_and_place(mallet):
    robot = ElementTree.fromstring(write_urdf(mallet, name="m.urdf")["m.urdf"])
    head = robot.findall("link")[2]
    assert float(head.find("inertial/mass").get("value")) == pytest.approx(3.0)
    inertia = {key: float(x) for key, x in head.find("inertial/inertia").attrib.items()}
    assert inertia["ixx"] == pytest.approx(10 / 4)
    assert inertia["izz"] == pytest.approx(2 / 4)
    assert inertia["ixy"] == pytest.approx(0.0, abs=1e-6)
    place = robot.findall("joint")[1].find("origin").get("xyz").split()
    assert list(map(float, place)) == pytest.approx([1000, 0, 50])
    assert head.find("visual/geometry/mesh").get("filename") == "m_meshes/head.obj"
    assert head.find("collision/geometry/mesh").get("filename") == "m_meshes/head_hull.stl"


def test_it_is_saved_with_its_meshes(mallet, tmp_path):
    save(mallet, tmp_path / "m.urdf")
    assert len(list((tmp_path / "m_meshes").iterdir())) == 4


def test_a_shape_with_y_up_is_turned(mallet):
    lying = replace(mallet, shape=mallet.shape.with_up("y"))
    robot = ElementTree.fromstring(write_urdf(lying, name="m.urdf")["m.urdf"])
    origin = robot.findall("joint")[1].find("origin")
    assert list(map(float, origin.get("xyz").split())) == pytest.approx([1000, -50, 0])
    assert list(map(float, origin.get("rpy").split())) == pytest.approx([np.pi / 2, 0, 0])


def test_hulls_have_as_few_vertices_as_was_asked(tmp_path, mallet):
    save(mallet, tmp_path / "m.urdf", hull_vertices=5)
    hulls = [trimesh.load(file) for file in (tmp_path / "m_meshes").glob("*_hull.stl")]
    assert [len(hull.vertices) for hull in hulls] == [5, 5]
