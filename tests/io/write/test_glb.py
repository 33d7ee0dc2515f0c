"""GLB files, read back by trimesh and as JSON: parts, areas, colours, normals, equal bytes."""

from __future__ import annotations

import io
import json
import os
import struct
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.labels import read_labels
from moseg_core.io.read.glb_scene import read_glb
from moseg_core.io.write.glb import encode_glb
from moseg_core.shape.appearance import Appearance, CornerValues
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.shape.up import turn_to_y
from moseg_core.view.palette import linear_light

COLORS = [[65, 112, 216], [245, 153, 43], [18, 166, 141]]
NAMES = ["body", "absent", "lid"]


def jar():
    """A closed cylinder, its lid and the rest of it; half of the polygons are quads."""
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([ring, ring + np.array([0, 0, 3]), [[0, 0, 0], [0, 0, 3]]])
    k = np.arange(24)
    n = np.roll(k, -1)
    faces = np.stack([k, n, n + 24, k + 24], axis=1).tolist()
    faces += np.stack([n, k, np.full(24, 48)], axis=1).tolist()
    faces += np.stack([k + 24, n + 24, np.full(24, 49)], axis=1).tolist()
    return PolygonMesh.from_faces(points, faces), np.repeat([0, 0, 2], 24)


def scene_of(data):
    return trimesh.load_scene(io.BytesIO(data), file_type="glb", process=False)


def tree_of(data):
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length])


def test_each_part_is_a_node_and_a_mesh():
    mesh, labels = jar()
    data = encode_glb(mesh, labels, NAMES, COLORS)
    scene = scene_of(data)
    assert sorted(scene.graph.nodes_geometry) == ["body", "lid"]
    assert {name: len(part.faces) for name, part in scene.geometry.items()} == {
        "body": 72,
        "lid": 24,
    }
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        assert geometry == node
        # Positions are those relative to the middle of the jar.
        np.testing.assert_allclose(transform[:3, 3], [0, 0, 1.5], atol=1e-15)
        np.testing.assert_array_equal(transform[:3, :3], np.eye(3))
    tree = tree_of(data)
    assert [node["name"] for node in tree["nodes"]] == ["body", "lid"]
    assert [part["name"] for part in tree["meshes"]] == ["body", "lid"]
    assert [material["name"] for material in tree["materials"]] == ["body", "lid"]


def test_the_surface_is_all_there():
    mesh, labels = jar()
    scene = scene_of(encode_glb(mesh, labels, NAMES, COLORS))
    lid = 24 * 0.5 * np.sin(2 * np.pi / 24)
    side = 24 * 2 * np.sin(np.pi / 24) * 3
    assert scene.geometry["lid"].area == pytest.approx(lid, rel=1e-6)
    assert scene.geometry["body"].area == pytest.approx(side + lid, rel=1e-6)
    np.testing.assert_allclose(scene.bounds, [[-1, -1, 0], [1, 1, 3]], atol=1e-6)
    # Outside is still outside.
    assert (scene.geometry["lid"].face_normals[:, 2] > 0.999).all()


def test_triangles_keep_their_order():
    mesh, labels = jar()
    scene = scene_of(encode_glb(mesh, labels, NAMES, COLORS))
    expected = mesh.vertices[mesh.triangles[labels[mesh.triangle_polygon] == 0]]
    found = scene.geometry["body"].triangles + np.array([0, 0, 1.5])
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_vertices_are_compact_and_doubled_along_creases_only():
    mesh, labels = jar()
    scene = scene_of(encode_glb(mesh, labels, NAMES, COLORS))
    assert len(scene.geometry["lid"].vertices) == 25
    # The wall has two rings, the bottom one of its own and a center.
    assert len(scene.geometry["body"].vertices) == 24 + 24 + 25


def test_normals_are_those_of_the_smooth_surface():
    mesh, labels = jar()
    body = scene_of(encode_glb(mesh, labels, NAMES, COLORS)).geometry["body"]
    assert "vertex_normals" in body._cache.cache
    on_wall = np.abs(body.vertex_normals[:, 2]) < 0.5
    assert on_wall.sum() == 48
    np.testing.assert_allclose(
        body.vertex_normals[on_wall][:, :2], body.vertices[on_wall][:, :2], atol=1e-6
    )
    np.testing.assert_allclose(body.vertex_normals[~on_wall], [[0, 0, -1]] * 25, atol=1e-6)


def test_materials_have_the_colors_in_linear_light():
    mesh, labels = jar()
    data = encode_glb(mesh, labels, NAMES, COLORS)
    for material, part in zip(tree_of(data)["materials"], [0, 2], strict=True):
        surface = material["pbrMetallicRoughness"]
        expected = [*linear_light(np.array(COLORS[part], np.uint8)), 1.0]
        np.testing.assert_allclose(surface["baseColorFactor"], expected, atol=0.5 / 255)
        assert surface["metallicFactor"] == 0.0
        assert material["doubleSided"] is True
    for name, part in (("body", 0), ("lid", 2)):
        material = scene_of(data).geometry[name].visual.material
        light = np.rint(linear_light(np.array(COLORS[part], np.uint8)) * 255)
        np.testing.assert_allclose(material.baseColorFactor[:3], light, atol=1)


def test_parts_of_one_color_stay_apart():
    mesh, labels = jar()
    scene = scene_of(encode_glb(mesh, labels, NAMES, [COLORS[0]] * 3))
    assert sorted(scene.geometry) == ["body", "lid"]


@pytest.mark.parametrize("names", [["world", "", "lid"], ["a", "b", "world"], ["ü/ö", "", "{}"]])
def test_any_name_makes_nodes_side_by_side(names):
    mesh, labels = jar()
    tree = tree_of(encode_glb(mesh, labels, names, COLORS))
    assert [node["name"] for node in tree["nodes"]] == [names[0], names[2]]
    assert not any("children" in node for node in tree["nodes"])
    assert tree["scenes"][0]["nodes"] == [0, 1]


def test_equal_input_gives_equal_bytes_in_every_process():
    mesh, labels = jar()
    here = encode_glb(mesh, labels, NAMES, COLORS)
    script = (
        "import sys, json, numpy as np\n"
        "from moseg_core.io.write.glb import encode_glb\n"
        "from moseg_core.shape.mesh import PolygonMesh\n"
        "points, faces, labels, names, colors = json.load(sys.stdin)\n"
        "mesh = PolygonMesh.from_faces(points, faces)\n"
        "sys.stdout.buffer.write(encode_glb(mesh, labels, names, colors))\n"
    )
    faces = np.split(mesh.corners, mesh.offsets[1:-1])
    given = json.dumps(
        [mesh.vertices.tolist(), [f.tolist() for f in faces], labels.tolist(), NAMES, COLORS]
    )
    running = []
    for seed in ("1", "2"):
        environment = {
            **os.environ,
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
        }
        running.append(
            subprocess.Popen(
                [sys.executable, "-c", script],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=environment,
            )
        )
    there = [process.communicate(given.encode())[0] for process in running]
    assert [process.returncode for process in running] == [0, 0]
    assert there == [here, here]


def test_what_is_refused():
    mesh, labels = jar()
    with pytest.raises(UsageError, match="two parts are named 'lid'"):
        encode_glb(mesh, labels, ["lid", "body", "lid"], COLORS)
    with pytest.raises(UsageError, match="3 parts need as many colours"):
        encode_glb(mesh, labels, NAMES, COLORS[:2])
    with pytest.raises(ShapeError, match="has the label 2; allowed are 0 to 1"):
        encode_glb(mesh, labels, NAMES[:2], COLORS[:2])


def test_far_from_the_origin_nothing_is_lost(tmp_path):
    mesh, labels = jar()
    far = replace(mesh, vertices=mesh.vertices + np.array([5.6e6, -6e5, 250.0]))
    path = tmp_path / "far.glb"
    path.write_bytes(encode_glb(far, labels, NAMES, COLORS))
    places = read_glb(path).geometry.vertices
    distance = np.linalg.norm(places[:, None] - far.vertices[None], axis=2).min(axis=1)
    assert distance.max() < 1e-6


def textured(mesh):
    """The same mesh with places in a texture: of the wall round and up, of the caps by x and y."""
    places = np.where(
        mesh.offsets[:-1].repeat(np.diff(mesh.offsets))[:, None] < 24 * 4,
        np.stack([np.arctan2(*mesh.vertices.T[:2]), mesh.vertices[:, 2]], axis=1)[mesh.corners],
        mesh.vertices[mesh.corners, :2],
    )
    values, row = np.unique(places, axis=0, return_inverse=True)
    looks = Appearance(texture=CornerValues(values=values, corners=row.reshape(-1)))
    return replace(mesh, appearance=looks)


def test_texture_coordinates_come_along(tmp_path):
    mesh, labels = jar()
    mesh = textured(mesh)
    data = encode_glb(mesh, labels, NAMES, COLORS)
    expected = mesh.appearance.texture.values[mesh.appearance.texture.corners]
    for part, name in enumerate(NAMES):
        if name == "absent":
            continue
        triangles = labels[mesh.triangle_polygon] == part
        found = scene_of(data).geometry[name]
        np.testing.assert_allclose(
            found.visual.uv[found.faces], expected[mesh.triangle_corners[triangles]], atol=1e-6
        )
    path = tmp_path / "x.glb"
    path.write_bytes(data)
    looks = read_glb(path).geometry.appearance
    order = np.argsort(labels[mesh.triangle_polygon], kind="stable")
    np.testing.assert_allclose(
        looks.texture.values[looks.texture.corners],
        expected[mesh.triangle_corners[order]].reshape(-1, 2),
        atol=1e-6,
    )
    assert [looks.materials[k] for k in looks.polygon_materials] == ["body"] * 72 + ["lid"] * 24


def test_no_texture_no_coordinates():
    mesh, labels = jar()
    tree = tree_of(encode_glb(mesh, labels, NAMES, COLORS))
    attributes = [part["primitives"][0]["attributes"] for part in tree["meshes"]]
    assert [set(each) for each in attributes] == [{"POSITION", "NORMAL"}] * 2


@pytest.mark.parametrize("up", ["x", "-x", "-y", "z", "-z"])
def test_what_is_up_is_turned_to_y_and_labels_come_back(up, tmp_path):
    mesh, labels = jar()
    mesh = replace(mesh, vertices=mesh.vertices + np.array([10.0, 20.0, 30.0]))
    path = tmp_path / "x.glb"
    path.write_bytes(encode_glb(mesh, labels, NAMES, COLORS, up=up))
    turned = Shape.from_polygon_mesh(replace(mesh, vertices=mesh.vertices @ turn_to_y(up).T))
    read = read_glb(path)
    np.testing.assert_allclose(read.centroid, turned.centroid, rtol=1e-6)
    np.testing.assert_allclose(read.frame.center, turned.frame.center, rtol=1e-6)
    # The data are the user's: only the nodes turn.
    plain = scene_of(encode_glb(mesh, labels, NAMES, COLORS))
    for name, part in scene_of(path.read_bytes()).geometry.items():
        np.testing.assert_array_equal(part.vertices, plain.geometry[name].vertices)
    found = read_labels(path, Shape.from_polygon_mesh(mesh))
    assert [found.names[k] for k in found.labels] == [NAMES[k] for k in labels]


@pytest.mark.parametrize("up", [None, "y"])
def test_nothing_turns_where_nothing_is_known_or_y_is_up(up):
    mesh, labels = jar()
    data = encode_glb(mesh, labels, NAMES, COLORS, up=up)
    assert data == encode_glb(mesh, labels, NAMES, COLORS)
    assert "extras" not in tree_of(data)["scenes"][0]
