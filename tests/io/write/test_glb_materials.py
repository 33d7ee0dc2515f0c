"""Parts of several materials in GLB files: runs of triangles, and what readers find."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from moseg_core.io.labels import read_labels
from moseg_core.io.read.glb_scene import read_glb
from moseg_core.io.write.glb import encode_glb
from moseg_core.io.write.glb_materials import material_order
from moseg_core.shape.appearance import Appearance
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape

BALL = trimesh.creation.icosphere(subdivisions=1)
MATERIALS = np.arange(len(BALL.faces)) % 3 - 1
LOOKS = Appearance(materials=("skin", "eye"), polygon_materials=MATERIALS)
MESH = replace(PolygonMesh.from_faces(BALL.vertices, np.array(BALL.faces)), appearance=LOOKS)
LABELS = (BALL.triangles_center[:, 2] > 0).astype(int)
NAMES, COLORS = ["low", "high"], [[255, 0, 0], [0, 0, 255]]


def test_each_triangle_keeps_its_part_and_material(tmp_path):
    path = tmp_path / "x.glb"
    path.write_bytes(encode_glb(MESH, LABELS, NAMES, COLORS))
    found = read_labels(path, Shape.from_polygon_mesh(MESH))
    assert [found.names[k] for k in found.labels] == [NAMES[k] for k in LABELS]
    found = read_labels(path, Shape.from_polygon_mesh(MESH), label_property="material")
    suffix = [".skin", ".eye", ""]
    wanted = [f"{NAMES[a]}{suffix[b]}" for a, b in zip(LABELS, MATERIALS, strict=True)]
    assert [found.names[k] for k in found.labels] == wanted
    shape = read_glb(path)
    assert shape.area == pytest.approx(BALL.area, rel=1e-6)
    assert len(shape.geometry.appearance.materials) == 6


def test_trimesh_reads_all_of_it():
    scene = trimesh.load_scene(
        io.BytesIO(encode_glb(MESH, LABELS, NAMES, COLORS)), file_type="glb", process=False
    )
    assert sum(part.area for part in scene.dump()) == pytest.approx(BALL.area, rel=1e-6)
    shades = {part.visual.material.name for part in scene.geometry.values()}
    assert len(shades) == 6


def test_one_material_for_all_divides_nothing():
    plain = replace(MESH, appearance=None)
    one = replace(LOOKS, materials=("skin",), polygon_materials=np.zeros_like(MATERIALS))
    alike = encode_glb(replace(MESH, appearance=one), LABELS, NAMES, COLORS)
    assert alike == encode_glb(plain, LABELS, NAMES, COLORS)
    for looks in (None, Appearance(), one):
        order, runs = material_order("a", looks, np.array([2, 0]))
        assert (order.tolist(), runs) == ([0, 1], [])
