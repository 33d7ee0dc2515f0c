"""OBJ files line by line, through trimesh, and back through moseg's own readers."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.labels import read_labels
from moseg_core.io.read.obj import read_obj
from moseg_core.io.write.obj import encode_obj
from moseg_core.shape.appearance import Appearance, CornerValues
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape

COLORS = [[255, 0, 51], [0, 128, 2], [7, 8, 250]]
CORNERS = np.random.default_rng(0).uniform(-1, 1, (12, 3))


def cube_sphere(steps=3):
    """Six sides of quads on a sphere, each side with a texture square and material of its own."""
    ticks = np.tan(np.linspace(-np.pi / 4, np.pi / 4, steps + 1))
    u, v = np.meshgrid(ticks, ticks, indexing="ij")
    points, faces, texture, material = [], [], [], []
    k = np.arange((steps + 1) ** 2).reshape(steps + 1, -1)
    quads = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    for side in range(6):
        axis, sign = side % 3, 1.0 if side < 3 else -1.0
        place = np.stack([np.full(u.shape, sign), u, sign * v], axis=-1).reshape(-1, 3)
        place = np.roll(place / np.linalg.norm(place, axis=1, keepdims=True), axis, axis=1)
        faces.append(quads + len(points) * len(k.flat))
        points.append(place)
        texture.append(np.stack([u, v], axis=-1).reshape(-1, 2) / 2 + 0.5)
        material.append(np.full(len(quads), side // 2))
    mesh = PolygonMesh.from_faces(np.concatenate(points), np.concatenate(faces))
    looks = Appearance(
        texture=CornerValues(values=np.concatenate(texture), corners=mesh.corners.copy()),
        normals=CornerValues(values=mesh.vertices.copy(), corners=mesh.corners.copy()),
        materials=("skin", "eye", "claw"),
        polygon_materials=np.concatenate(material),
    )
    return replace(mesh, appearance=looks)


def polygons(mesh, chosen):
    return [mesh.corners[mesh.offsets[f] : mesh.offsets[f + 1]].tolist() for f in chosen]


@given(
    faces=st.lists(st.lists(st.integers(0, 11), min_size=3, max_size=7), min_size=1, max_size=12),
    seed=st.integers(0, 99),
)
@settings(max_examples=40, deadline=None)
def test_vertices_and_polygons_stay_as_they_are_and_come_part_by_part(faces, seed):
    labels = np.random.default_rng(seed).integers(0, 3, len(faces))
    mesh = PolygonMesh.from_faces(CORNERS, faces)
    obj, _ = encode_obj(mesh, labels, ["a", "b", "c"], COLORS, materials_file="x.mtl")
    lines = obj.decode().splitlines()
    assert lines[0] == "mtllib x.mtl"
    vertices = [list(map(float, line.split()[1:])) for line in lines if line[:2] == "v "]
    assert vertices == CORNERS.tolist()
    expected = []
    for part, name in enumerate("abc"):
        members = np.flatnonzero(labels == part)
        if len(members):
            expected += [f"o {name}", f"g {name}", f"usemtl {name}"]
        expected += ["f " + " ".join(str(c + 1) for c in faces[f]) for f in members]
    assert lines[1 + len(vertices) :] == expected


def test_texture_normals_and_materials_come_back(tmp_path):
    mesh = cube_sphere()
    labels = (mesh.vertices[mesh.corners[mesh.offsets[:-1]], 2] > 0.2).astype(int)
    obj, mtl = encode_obj(mesh, labels, ["low", "high"], COLORS[:2], materials_file="x.mtl")
    (tmp_path / "x.obj").write_bytes(obj)
    found = read_obj(tmp_path / "x.obj").geometry
    order = np.argsort(labels, kind="stable")
    np.testing.assert_array_equal(found.vertices, mesh.vertices)
    assert polygons(found, range(found.n_polygons)) == polygons(mesh, order)
    corners = (4 * order[:, None] + np.arange(4)).reshape(-1)
    for kind in ("texture", "normals"):
        given, kept = getattr(found.appearance, kind), getattr(mesh.appearance, kind)
        np.testing.assert_array_equal(given.values, kept.values)
        np.testing.assert_array_equal(given.corners, kept.corners[corners])
    # A part that several materials share has one of its colour for each.
    materials = [
        f"{['low', 'high'][labels[f]]}.{mesh.appearance.materials[m]}"
        for f, m in zip(order, mesh.appearance.polygon_materials[order], strict=True)
    ]
    assert [found.appearance.materials[m] for m in found.appearance.polygon_materials] == materials
    defined = [line.split()[1] for line in mtl.decode().splitlines() if line[:6] == "newmtl"]
    assert sorted(defined) == sorted(set(materials))


def test_labels_come_back_to_the_input(tmp_path):
    shape = Shape.from_polygon_mesh(cube_sphere())
    labels = np.arange(shape.n_elements) % 3
    names = ["left arm", "größe", "body/leg"]
    obj, _ = encode_obj(shape.geometry, labels, names, COLORS, materials_file="x.mtl")
    (tmp_path / "x.obj").write_bytes(obj)
    found = read_labels(tmp_path / "x.obj", shape)
    assert [found.names[k] for k in found.labels] == [names[k] for k in labels]


def test_trimesh_finds_parts_texture_and_colors():
    mesh = cube_sphere()
    mesh = replace(mesh, appearance=replace(mesh.appearance, materials=(), polygon_materials=None))
    labels = np.arange(mesh.n_polygons) % 3
    obj, mtl = encode_obj(mesh, labels, ["arm", "leg", "lid"], COLORS, materials_file="x.mtl")
    scene = trimesh.load_scene(io.BytesIO(obj), file_type="obj", resolver={"x.mtl": mtl})
    assert sorted(scene.geometry) == ["arm", "leg", "lid"]
    for part, name in enumerate(["arm", "leg", "lid"]):
        found = scene.geometry[name]
        assert len(found.faces) == 2 * (labels == part).sum()
        assert found.visual.material.name == name
        np.testing.assert_array_equal(found.visual.material.diffuse[:3], COLORS[part])
        # A vertex of the sphere tells its texture coordinates, but for the side that it is on.
        pairs = np.column_stack([found.vertices, found.visual.uv])
        known = np.column_stack([mesh.vertices, mesh.appearance.texture.values])
        apart = np.abs(pairs[:, None] - known[None]).max(axis=2).min(axis=1)
        assert apart.max() < 1e-6


def test_a_polygon_has_texture_at_all_corners_or_none():
    mesh = PolygonMesh.from_faces(CORNERS[:4], [[0, 1, 2], [0, 2, 3]])
    texture = CornerValues(values=np.zeros((1, 2)), corners=np.array([0, 0, 0, 0, -1, 0]))
    normals = CornerValues(values=np.ones((1, 3)), corners=np.zeros(6, np.int64))
    for looks, words in (
        (Appearance(texture=texture), ["f 1/1 2/1 3/1", "f 1 3 4"]),
        (Appearance(texture=texture, normals=normals), ["f 1/1/1 2/1/1 3/1/1", "f 1//1 3//1 4//1"]),
        (Appearance(normals=normals), ["f 1//1 2//1 3//1", "f 1//1 3//1 4//1"]),
    ):
        given = replace(mesh, appearance=looks)
        obj, _ = encode_obj(given, [0, 0], ["a"], COLORS[:1], materials_file="x.mtl")
        assert obj.decode().splitlines()[-2:] == words


@pytest.mark.parametrize(
    "name", ["../../x", "<script>", "con", "a\nf 1 2 3", "", "x" * 10_000, "a#\\"]
)
def test_no_name_of_a_part_adds_or_ends_a_line(name, tmp_path):
    mesh = PolygonMesh.from_faces(CORNERS[:4], [[0, 1, 2], [0, 2, 3]])
    obj, mtl = encode_obj(mesh, [0, 1], [name, "b"], COLORS[:2], materials_file="x.mtl")
    assert [line.split()[0] for line in obj.decode().splitlines()] == [
        "mtllib", *["v"] * 4, *["o", "g", "usemtl", "f"] * 2,
    ]  # fmt: skip
    assert len(mtl.decode().splitlines()) == 10
    (tmp_path / "x.obj").write_bytes(obj)
    assert read_labels(tmp_path / "x.obj", 2).labels.tolist() == [0, 1]


def test_what_is_refused():
    mesh = PolygonMesh.from_faces(CORNERS[:3], [[0, 1, 2]])
    with pytest.raises(ShapeError, match="face 0 has the label 1"):
        encode_obj(mesh, [1], ["a"], COLORS[:1], materials_file="x.mtl")
    with pytest.raises(UsageError, match="1 parts need as many colours"):
        encode_obj(mesh, [0], ["a"], COLORS, materials_file="x.mtl")
