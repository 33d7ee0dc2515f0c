from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.read.glb_scene import GlbPiece, read_glb, read_glb_pieces
from tests.io.read.glb_files import CORNERS, FACES, TETRAHEDRON, glb, one_node, pack


def corners_of(shape) -> np.ndarray:
    return shape.geometry.vertices[shape.geometry.corners].reshape(-1, 3, 3)


def test_a_plain_file(as_file):
    shape = read_glb(as_file("tetra.glb", one_node()))
    assert (shape.name, shape.up) == ("tetra", "y")
    np.testing.assert_array_equal(corners_of(shape), CORNERS[FACES])
    assert shape.volume == pytest.approx(0.25)


@given(data=st.data())
def test_files_of_trimesh_keep_their_faces_in_order(data, as_file, polygon_meshes):
    vertices, faces = data.draw(polygon_meshes)
    triangles = np.array([[f[0], f[k], f[k + 1]] for f in faces for k in range(1, len(f) - 1)])
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    path = as_file("random.glb", mesh.export(file_type="glb"))
    shape = read_glb(path)
    np.testing.assert_array_equal(corners_of(shape), vertices[triangles])
    assert read_glb(path).fingerprint == shape.fingerprint


def test_a_scene_is_placed_as_trimesh_places_it(as_file):
    turn = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3], [0.5, 0, 1])
    scene = trimesh.Scene()
    box, ball = trimesh.creation.box((1, 2, 3)), trimesh.creation.icosphere(subdivisions=1)
    scene.add_geometry(box, node_name="box", transform=turn)
    scene.add_geometry(
        ball,
        node_name="ball",
        parent_node_name="box",
        transform=trimesh.transformations.scale_matrix(2.5),
    )
    scene.add_geometry(ball, node_name="other", transform=turn @ turn)
    shape = read_glb(as_file("scene.glb", scene.export(file_type="glb")))
    assert shape.n_elements == 12 + 80 + 80
    expected = scene.to_geometry().triangles_center
    order, expected_order = (np.lexsort(points.round(4).T) for points in (shape.points, expected))
    np.testing.assert_allclose(shape.points[order], expected[expected_order], atol=1e-5)
    assert shape.volume == pytest.approx(6 + ball.volume * (2.5**3 + 1), rel=1e-5)


def test_the_order_is_depth_first_as_the_lists_say(as_file):
    # Each mesh is one triangle, told by its size: 1, 2, 3...; mesh 2 has two primitives.
    def primitive(size: float) -> dict:
        return {"POSITION": np.array([(0, 0, 0), (size, 0, 0), (0, 1, 0)], "<f4")}

    meshes = [[primitive(1)], [primitive(2)], [primitive(3), primitive(4)], [primitive(5)]]
    nodes = [
        {"mesh": 0},
        {"children": [3, 0], "mesh": 1},
        {"mesh": 3},
        {"children": [4]},
        {"mesh": 2},
        {"mesh": 0},
    ]
    cases = [
        ({"scenes": [{"nodes": [2]}, {"nodes": [2, 1]}], "scene": 1}, [5, 2, 3, 4, 1]),
        ({"scenes": [{"nodes": [1, 2]}, {"nodes": [2]}]}, [2, 3, 4, 1, 5]),
        ({}, [2, 3, 4, 1, 5, 1]),
    ]
    for rest, sizes in cases:
        path = as_file("order.glb", pack(*glb(meshes, nodes, **rest)))
        for shape in (read_glb(path), read_glb(path)):
            assert corners_of(shape)[:, 1, 0].tolist() == sizes


def test_a_matrix_stores_columns(as_file):
    matrix = np.array([[0, -2, 0, 5], [2, 0, 0, 6], [0, 0, 2, 7], [0, 0, 0, 1.0]])
    shape = read_glb(as_file("m.glb", one_node(matrix=matrix.T.reshape(-1).tolist())))
    expected = CORNERS[FACES].astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    np.testing.assert_allclose(corners_of(shape), expected)


def test_scale_then_rotation_then_translation(as_file):
    half = np.sqrt(0.5)
    node = {"translation": [5, 6, 7], "rotation": [0, 0, half, half], "scale": [2, 3, 4]}
    shape = read_glb(as_file("trs.glb", one_node(**node)))
    # A quarter turn about z takes (x, y, z) to (-y, x, z).
    x, y, z = np.moveaxis(CORNERS[FACES].astype(float) * [2, 3, 4], -1, 0)
    np.testing.assert_allclose(corners_of(shape), np.stack([5 - y, 6 + x, 7 + z], axis=-1))


def test_a_mirrored_node_keeps_its_outside_out(as_file):
    shape = read_glb(as_file("mirror.glb", one_node(scale=[-1, 1, 1])))
    a, b, c = np.moveaxis(corners_of(shape), 1, 0)
    # All normals point away from the centre.
    assert (
        np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c - [-0.75, 0.75, 1.125]) > 0
    ).all()


def test_equal_positions_stay_equal_wherever_they_stand(as_file):
    rng = np.random.default_rng(0)
    ball = trimesh.creation.icosphere(subdivisions=2)
    soup = ball.triangles[rng.permutation(len(ball.faces))].reshape(-1, 3).astype("<f4")
    turn = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3], [0.5, 0, 1]).T.reshape(-1)
    document, binary = glb([[{"POSITION": soup}]], [{"mesh": 0, "matrix": turn.tolist()}])
    shape = read_glb(as_file("soup.glb", pack(document, binary)))
    assert shape.volume is not None
    assert shape.adjacency.components()[0] == 1


@pytest.mark.parametrize(
    ("mode", "expected"),
    [
        (4, [[0, 1, 2], [3, 4, 5]]),
        (5, [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]]),
        (6, [[1, 2, 0], [2, 3, 0], [3, 4, 0], [4, 5, 0]]),
    ],
)
@pytest.mark.parametrize("indexed", [False, True])
def test_lists_strips_and_fans(mode, expected, indexed, as_file):
    points = np.array([(x, y, x * y) for x in range(3) for y in range(2)], "<f4")
    primitive = {"POSITION": points, "mode": mode}
    if indexed:
        primitive = {"POSITION": points[::-1], "indices": np.arange(5, -1, -1, "<u1"), "mode": mode}
    lines = {"POSITION": points, "mode": 1}
    dots = {"POSITION": points, "mode": 0}
    contents = pack(*glb([[lines, primitive, dots]], [{"mesh": 0}]))
    shape = read_glb(as_file("mode.glb", contents))
    np.testing.assert_array_equal(corners_of(shape), points[np.array(expected)])


@pytest.mark.parametrize(
    ("stored", "normalized", "expected"),
    [
        (np.array([(0, 0, 0, 9), (127, 0, 0, 9), (0, -128, 0, 9)], "<i1"), True, -1),
        (np.array([(0, 0, 0, 9), (1, 0, 0, 9), (0, -128, 0, 9)], "<i1"), False, -128),
        (np.array([(0, 0, 0, 9), (65535, 0, 0, 9), (0, 65535, 0, 9)], "<u2"), True, 1),
    ],
)
def test_quantized_positions_with_a_stride(stored, normalized, expected, as_file):
    document, binary = glb([[{"POSITION": stored}]], [{"mesh": 0}])
    document["accessors"][0].update(type="VEC3", normalized=normalized)
    document["bufferViews"][0]["byteStride"] = 4 * stored.itemsize
    document["extensionsRequired"] = ["KHR_mesh_quantization", "KHR_materials_unlit"]
    shape = read_glb(as_file("quantized.glb", pack(document, binary)))
    np.testing.assert_array_equal(corners_of(shape)[0], [[0, 0, 0], [1, 0, 0], [0, expected, 0]])


def changed(edit) -> bytes:
    document, binary = glb([[TETRAHEDRON]], [{"mesh": 0}])
    edit(document)
    return pack(document, binary)


def put(*where):
    """An edit: put the last argument at the place that the others name."""
    *path, key, value = where

    def edit(document):
        for step in path:
            document = document[step]
        document[key] = value

    return edit


PRIMITIVE = ("meshes", 0, "primitives", 0)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (put("extensionsRequired", ["XX_magic"]), " needs the extension XX_magic; export it with"),
        (
            lambda document: (
                put(*PRIMITIVE, "extensions", {"KHR_draco_mesh_compression": {}})(document),
                document["accessors"][0].pop("bufferView"),
            ),
            " is compressed with KHR_draco_mesh_compression; open it in a program that reads it",
        ),
        (
            put("bufferViews", 0, "extensions", {"EXT_meshopt_compression": {}}),
            " is compressed with EXT_meshopt_compression; open it in a program that reads it",
        ),
        (
            put("nodes", 0, "extensions", {"EXT_mesh_gpu_instancing": {}}),
            " uses the extension EXT_mesh_gpu_instancing; export it without",
        ),
        (put("buffers", 0, "uri", "a.bin"), " keeps its data in 'a.bin', which is not there;"),
        (put("accessors", 0, "sparse", {}), " has a sparse accessor (accessors[0]); open"),
        (put("nodes", []), " has no faces; export the shape with its faces"),
        (put(*PRIMITIVE, "mode", 0), " has no faces; export the shape with its faces"),
        (put("nodes", 0, "mesh", 1), " is damaged: 1 names none of the 1 meshes; export it again"),
        (put("nodes", 0, "mesh", True), " is damaged: true names none of the 1 meshes"),
        (put("nodes", 0, "mesh", [[]]), " is damaged: [[]] names none of the 1 meshes"),
        (put("nodes", 0, 3), " is damaged: nodes[0] must be an object"),
        (put("nodes", "0"), " is damaged: 'nodes' must be a list"),
        (put("nodes", 0, "children", [0]), " has no faces"),
        (put("scenes", [{"nodes": [0, 0]}]), " is damaged: nodes[0] stands in the scene twice"),
        (put("scenes", [{"nodes": [[0]]}]), " is damaged: [0] names none of the 1 nodes"),
        (
            lambda document: document.update(scenes=[{"nodes": [0]}], scene=0.5),
            " is damaged: 'scene' must be an integer from 0, not 0.5",
        ),
        (put("nodes", 0, "matrix", [1, 2]), " is damaged: 'matrix' must be 16 finite numbers"),
        (put("nodes", 0, "scale", [1, 2, "3"]), " is damaged: 'scale' must be 3 finite numbers"),
        (put("nodes", 0, "scale", [1, 2, 10**400]), " is damaged: 'scale' must be 3 finite"),
        (put("nodes", 0, "scale", [1, 2, float("nan")]), " is damaged: 'scale' must be 3 finite"),
        (put("nodes", 0, "scale", [1e299, 1, 1]), " has vertex 1 at [1e+299, 0.0, 0.0], beyond"),
        (put(*PRIMITIVE, 7), " is damaged: a primitive must be an object"),
        (put(*PRIMITIVE, "attributes", {}), " is damaged: null names none of the 2 accessors"),
        (put(*PRIMITIVE, "attributes", []), " is damaged: 'attributes' must be an object"),
        (put(*PRIMITIVE, "attributes", {"POSITION": 1}), " is damaged: positions must have three"),
        (put(*PRIMITIVE, "indices", 0), " is damaged: indices must be unsigned integers"),
        (put("accessors", 0, "count", 3), " is damaged: a triangle names vertex 3, but its prim"),
        (put("accessors", 1, "count", 11), " is damaged: 11 indices do not make whole triangles"),
        (put("accessors", 1, "count", 13), " is damaged: accessors[1] reaches past the end of it"),
        (put("accessors", 1, "byteOffset", 2), " is damaged: accessors[1] reaches past the end"),
        (
            put("accessors", 1, "count", -1),
            " is damaged: 'count' must be an integer from 0, not -1",
        ),
        (put("accessors", 1, "count", "12"), " is damaged: 'count' must be an integer from 0"),
        (put("accessors", 1, "type", "VEC9"), " is damaged: accessors[1] has an unknown type"),
        (put("accessors", 1, "type", []), " is damaged: accessors[1] has an unknown type"),
        (put("accessors", 1, "componentType", 1), " is damaged: accessors[1] has an unknown type"),
        (put("accessors", 0, {"count": 3}), " is damaged: accessors[0] has no data"),
        (put("bufferViews", 1, "byteLength", 99), " is damaged: bufferViews[1] reaches past the"),
        (put("bufferViews", 0, "byteStride", 4), " is damaged: accessors[0] reaches past the end"),
        (put("buffers", 0, "byteLength", 50), " is damaged: bufferViews[1] reaches past the end"),
    ],
)
def test_documents_that_are_wrong_are_refused_with_the_reason(edit, message, refusal):
    assert message in refusal(read_glb, "bad.glb", changed(edit))


def test_a_long_chain_of_nodes_is_walked(as_file):
    nodes = [{"children": [k + 1], "translation": [1, 0, 0]} for k in range(3000)]
    contents = pack(*glb([[TETRAHEDRON]], [*nodes, {"mesh": 0}]))
    assert corners_of(read_glb(as_file("chain.glb", contents))).min() == 0
    assert corners_of(read_glb(as_file("chain.glb", contents)))[..., 0].max() == 3001


def test_damaged_bytes_are_read_or_refused(damages):
    assert damages(read_glb, "damaged.glb", one_node(scale=[1, 2, 3])) > 100


def test_a_skinned_mesh_is_not_placed_by_its_node(as_file):
    shape = read_glb(as_file("skin.glb", one_node(skin=0, translation=[9, 9, 9], scale=[2, 2, 2])))
    np.testing.assert_array_equal(shape.geometry.vertices, CORNERS)
    assert shape.notes[0].startswith("meshes with a skin: 1; read in the pose in which")


@pytest.mark.parametrize(
    ("weights", "says"),
    [(None, "read without them"), ([0, 0], "read without them"), ([0, 0.5], "shows some of them")],
)
def test_morph_targets_are_not_applied(weights, says, as_file):
    document, binary = glb([[TETRAHEDRON]], [{"mesh": 0}])
    document["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 0}, {"POSITION": 0}]
    if weights is not None:
        document["meshes"][0]["weights"] = weights
    shape = read_glb(as_file("morph.glb", pack(document, binary)))
    np.testing.assert_array_equal(shape.geometry.vertices, CORNERS)
    assert shape.notes[0].startswith("meshes with morph targets: 1; read without them")
    assert shape.notes[0].endswith(says)


def test_compressed_data_are_not_needed_where_the_plain_ones_are_there(as_file):
    def edit(document):
        extensions = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}}
        document["meshes"][0]["primitives"][0]["extensions"] = extensions

    assert read_glb(as_file("both.glb", changed(edit))).n_elements == 4


def test_points_and_lines_are_said_to_be_passed_over(as_file):
    lines = {**TETRAHEDRON, "mode": 1}
    shape = read_glb(as_file("l.glb", pack(*glb([[TETRAHEDRON, lines]], [{"mesh": 0}]))))
    assert (shape.n_elements, shape.notes[0]) == (4, "lists of points or lines: 1; passed over")


def test_pieces_are_called_by_node_mesh_and_material_in_the_order_of_the_triangles(as_file):
    meshes = [[TETRAHEDRON], [TETRAHEDRON, TETRAHEDRON]]
    nodes = [
        {"mesh": 0, "name": "leg", "children": [1]},
        {"mesh": 1, "name": ""},
        {"mesh": 0, "name": "leg"},
    ]
    document, binary = glb(meshes, nodes, scenes=[{"nodes": [0, 2]}])
    document["meshes"][1]["name"] = "shell"
    document["materials"] = [{"name": "steel"}, {}]
    document["meshes"][1]["primitives"][0]["material"] = 0
    document["meshes"][1]["primitives"][1]["material"] = 1
    path = as_file("named.glb", pack(document, binary))

    def piece(place, **names):
        return GlbPiece(
            **({"node": None, "mesh": None, "material": None} | names), place=place, n_triangles=4
        )

    assert read_glb_pieces(path) == [
        piece(0, node="leg"),
        piece(1, mesh="shell", material="steel"),
        piece(1, mesh="shell"),
        piece(2, node="leg"),
    ]
