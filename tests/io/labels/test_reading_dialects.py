"""Forms of labels as programs write them, all of one labelling of one mesh.

The mesh is of quads and triangles, a T of two parts, with a face that bears no label where a form
can say so. A dialect is a file name and a function that makes the file; what must come out is the
labelling, or the names. The table in ``docs/formats.md`` has a line for each kind.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from json import dumps

import numpy as np
import pytest
import trimesh

from moseg_core.errors import MosegError
from moseg_core.io.labels import read_labels
from moseg_core.io.write.glb import encode_glb
from moseg_core.io.write.ply import encode_ply
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.io.read.ply_files import encode

VERTICES, FACES = shapes.tee(4, 3)
# Some of the quads are two triangles each, so that no count is that of something else.
FACES = [
    list(map(int, piece))
    for k, face in enumerate(FACES)
    for piece in ([face] if k % 3 else [face[:3], [face[0], *face[2:]]])
]
SHAPE = Shape.from_mesh(VERTICES, FACES)
VERTICES = np.asarray(VERTICES, float)
N, V = SHAPE.n_elements, len(VERTICES)
UPPER = SHAPE.points[:, 2] > 3.9
LABELS = UPPER.astype(int)
NAMES = ["stem", "bar"]
WORDS = [NAMES[k] for k in LABELS]
# Vertices of both parts, so that every face has one label at most of its corners.
AT_VERTICES = np.array([np.bincount(LABELS[[v in f for f in FACES]]).argmax() for v in range(V)])
CARRIED = np.array([np.bincount(AT_VERTICES[f], minlength=2).argmax() for f in FACES])
PARTLY = np.where(np.arange(N) % 7 == 3, -1, LABELS)
PART_WORDS = [NAMES[k] if k >= 0 else "" for k in PARTLY]


def lines(values, end="\n") -> str:
    return "".join(f"{value}{end}" for value in values)


def table(header, values, between=",", first=0) -> str:
    """A line for each face: its number and a value."""
    return header + lines(f"{i}{between}{value}" for i, value in enumerate(values, first))


def savetxt(values, **options) -> bytes:
    stream = io.BytesIO()
    np.savetxt(stream, values, **options)
    return stream.getvalue()


def npy(array) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def npz(**arrays) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def points(*, form="ascii", columns=(), of="vertex", values=None) -> bytes:
    """The mesh as PLY with more properties of its vertices or faces."""
    declared = [f"{kind} {name}" for kind, name in columns]
    more = [[] for _ in range(V if of == "vertex" else N)]
    if values is not None:
        more = [list(row) for row in np.atleast_2d(values).reshape(len(columns), -1).T.tolist()]
    position = ["float x", "float y", "float z"]
    rows, polygons = VERTICES.tolist(), [[face] for face in FACES]
    if of == "vertex":
        vertex = ("vertex", position + declared, [a + b for a, b in zip(rows, more, strict=True)])
        face = ("face", ["list uchar int vertex_indices"], polygons)
    else:
        vertex = ("vertex", position, rows)
        polygons = [a + b for a, b in zip(polygons, more, strict=True)]
        face = ("face", ["list uchar int vertex_indices", *declared], polygons)
    return encode(form, [vertex, face])


def face_ply(declared, values, form="ascii") -> bytes:
    """The mesh with one more property of its faces, such as "int label"."""
    return points(form=form, of="face", columns=[tuple(declared.split())], values=values)


def vertex_ply(declared, values) -> bytes:
    return points(columns=[tuple(declared.split())], values=values)


def moseg_ply() -> bytes:
    return encode_ply(SHAPE.geometry, LABELS, NAMES, np.zeros((2, 3), int))


def obj(statement: str, *, before: str = "", words=WORDS) -> str:
    text, last = before + lines("v {} {} {}".format(*v) for v in VERTICES.tolist()), None
    for word, face in zip(words, FACES, strict=True):
        if word != last:
            text += f"{statement} {word}\n"
        text += "f " + " ".join(f"{k + 1}/1/1" for k in face) + "\n"
        last = word
    return text


def solids(names, labels=None) -> str:
    """A solid for each run of faces with one label; of a mesh of triangles."""
    labels, text, last = TRIANGLE_LABELS if labels is None else labels, "", None
    for k, face in enumerate(TRIANGLES):
        if labels[k] != last:
            text += f"endsolid {names[last]}\n" if last is not None else ""
            last = labels[k]
            text += f"solid {names[last]}\n"
        corners = lines("vertex {} {} {}".format(*VERTICES[v].tolist()) for v in face)
        text += f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n"
    return f"{text}endsolid {names[last]}\n"


TRIANGLES = SHAPE.geometry.triangles
TRIANGLE_LABELS = LABELS[SHAPE.geometry.triangle_polygon]
TRIANGULATED = Shape.from_mesh(VERTICES, TRIANGLES.tolist())


def binary_stl(step=31) -> bytes:
    rows = np.zeros(
        len(TRIANGLES), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
    )
    rows["corners"] = VERTICES[TRIANGLES]
    rows["attribute"] = step * TRIANGLE_LABELS
    return bytes(80) + np.uint32(len(rows)).tobytes() + rows.tobytes()


def ids(label: int, first: int = 0) -> list[int]:
    return (np.flatnonzero(label == LABELS) + first).tolist()


def scene() -> bytes:
    """Parts as a viewer exports them: in another order than the faces of the mesh."""
    return encode_glb(SHAPE.geometry, LABELS, NAMES, np.zeros((2, 3), np.uint8))


def nodes_of_materials() -> bytes:
    """A single mesh with two materials, as exported from a painted model."""
    from trimesh.visual.material import PBRMaterial

    made = trimesh.Scene()
    for k, name in enumerate(NAMES):
        visual = trimesh.visual.TextureVisuals(material=PBRMaterial(name=name))
        part = trimesh.Trimesh(
            VERTICES, TRIANGLES[k == TRIANGLE_LABELS], visual=visual, process=False
        )
        made.add_geometry(part, node_name=f"n{k}")
    return made.export(file_type="glb")


XYZ = SHAPE.points.round(4)
LABELLED_POINTS = np.column_stack([XYZ, LABELS])
NOT_NUMBERS = np.where(PARTLY < 0, np.nan, PARTLY)

WHOLE: dict[str, tuple[str, Callable[[], str | bytes]]] = {
    "a label a line": ("x.seg", lambda: lines(LABELS)),
    "under another suffix": ("x.labels", lambda: lines(LABELS)),
    "numbers in .txt": ("x.txt", lambda: lines(LABELS)),
    "lines that end in CR LF": ("x.seg", lambda: lines(LABELS, "\r\n")),
    "a byte-order mark": ("x.seg", lambda: "\ufeff" + lines(LABELS)),
    "UTF-16 of Windows": ("x.txt", lambda: lines(LABELS).encode("utf-16")),
    "blank lines and blanks": ("x.seg", lambda: "\n  " + lines(LABELS, "  \n\n")),
    "numpy.savetxt": ("x.seg", lambda: savetxt(LABELS)),
    "numpy.savetxt with a header": ("x.txt", lambda: savetxt(LABELS, fmt="%d", header="label")),
    "numpy.savetxt of a row": ("x.txt", lambda: savetxt(LABELS[None], fmt="%d")),
    "one line with commas": ("x.txt", lambda: ",".join(map(str, LABELS)) + "\n"),
    "floats": ("x.txt", lambda: lines(f"{k:.1f}" for k in LABELS)),
    "numbers from 1": ("x.seg", lambda: lines(LABELS + 1)),
    "pandas, a column": ("x.csv", lambda: "label\n" + lines(LABELS)),
    "pandas, with its index": ("x.csv", lambda: table(",label\n", LABELS, ",")),
    "CSV of faces and labels": ("x.csv", lambda: table("face,segment\n", LABELS, ",")),
    "the same in another order": (
        "x.csv",
        lambda: "face_id;part\n" + lines(f"{i};{LABELS[i]}" for i in reversed(range(N))),
    ),
    "CSV without a header": ("x.csv", lambda: table("", LABELS)),
    "tabs, faces from 1": ("x.tsv", lambda: table("", LABELS, "\t", 1)),
    "quoted": (
        "x.csv",
        lambda: '"id","class"\n' + lines(f'"{i}","{k}"' for i, k in enumerate(LABELS)),
    ),
    "a table of blanks": ("x.txt", lambda: table("# face label\n", LABELS, " ")),
    "a table with a header of words": ("x.txt", lambda: table("face label\n", LABELS, " ")),
    "points with labels": ("x.txt", lambda: savetxt(LABELLED_POINTS, fmt="%g")),
    "points with normals and labels": (
        "x.xyz",
        lambda: savetxt(np.column_stack([XYZ, XYZ / 9 + 0.01, LABELS])),
    ),
    "points in CSV": (
        "x.csv",
        lambda: savetxt(LABELLED_POINTS, delimiter=",", header="x,y,z,label", comments=""),
    ),
    "CloudCompare's CSV": (
        "x.csv",
        lambda: savetxt(LABELLED_POINTS, delimiter=";", header="X;Y;Z;Scalar_Label", comments="//"),
    ),
    "Python's list in .txt": ("x.txt", lambda: str(LABELS.tolist())),
    "JSON list": ("x.json", lambda: dumps(LABELS.tolist())),
    "JSON list of floats": ("x.json", lambda: dumps(LABELS.astype(float).tolist())),
    "JSON list of bools": ("x.json", lambda: dumps(UPPER.tolist())),
    "JSON list of digits": ("x.json", lambda: dumps(list(map(str, LABELS.tolist())))),
    "JSON column": ("x.json", lambda: dumps(LABELS[:, None].tolist())),
    "JSON map from face to label": ("x.json", lambda: dumps(dict(enumerate(LABELS.tolist())))),
    "JSON map from 1": ("x.json", lambda: dumps({i + 1: k for i, k in enumerate(LABELS.tolist())})),
    "JSON member labels": ("x.json", lambda: dumps({"mesh": "t.obj", "labels": LABELS.tolist()})),
    "JSON member face_labels": ("x.json", lambda: dumps({"n": N, "face_labels": LABELS.tolist()})),
    "JSON map in a member": (
        "x.json",
        lambda: dumps({"segmentation": dict(enumerate(LABELS.tolist()))}),
    ),
    "JSON lists of faces": ("x.json", lambda: dumps([ids(0), ids(1)])),
    "JSON faces by number": ("x.json", lambda: dumps({"0": ids(0), "1": ids(1)})),
    "numpy ints": ("x.npy", lambda: npy(LABELS.astype(np.int32))),
    "numpy bytes": ("x.npy", lambda: npy(LABELS.astype(np.uint8))),
    "numpy floats": ("x.npy", lambda: npy(LABELS.astype(np.float32))),
    "numpy bools": ("x.npy", lambda: npy(UPPER)),
    "numpy column": ("x.npy", lambda: npy(LABELS[:, None])),
    "numpy points with labels": ("x.npy", lambda: npy(LABELLED_POINTS)),
    "npz, labels": ("x.npz", lambda: npz(labels=LABELS)),
    "npz, without a name": ("x.npz", lambda: npz(arr_0=LABELS)),
    "npz, among others": ("x.npz", lambda: npz(vertices=VERTICES, faces_in=TRIANGLES, seg=LABELS)),
    "npz, the only row that fits": ("x.npz", lambda: npz(vertices=VERTICES, data=LABELS)),
    "PLY label of faces": ("x.ply", lambda: face_ply("int label", LABELS)),
    "PLY float label": ("x.ply", lambda: face_ply("float label", LABELS * 1.0)),
    "PLY big-endian": ("x.ply", lambda: face_ply("uchar labels", LABELS, "binary_big_endian")),
    "PLY objectId": ("x.ply", lambda: face_ply("ushort objectId", LABELS, "binary_little_endian")),
    "PLY segment_id": ("x.ply", lambda: face_ply("int segment_id", LABELS)),
    "PLY part": ("x.ply", lambda: face_ply("uchar part", LABELS)),
    "PLY category_id": ("x.ply", lambda: face_ply("int category_id", LABELS)),
    "PLY of CloudCompare": ("x.ply", lambda: face_ply("float scalar_Classification", LABELS * 1.0)),
    "PLY of moseg": ("x.ply", moseg_ply),
    "GLB of moseg": ("x.glb", scene),
    "GLB of materials": ("x.glb", nodes_of_materials),
}

NAMED: dict[str, tuple[str, Callable[[], str | bytes]]] = {
    "names and lines of faces": (
        "x.txt",
        lambda: f"stem\n{' '.join(map(str, ids(0, 1)))}\nbar\n{' '.join(map(str, ids(1, 1)))}\n",
    ),
    "a name a line": ("x.txt", lambda: lines(WORDS)),
    "a name a line under .seg": ("x.seg", lambda: lines(WORDS)),
    "CSV of names": ("x.csv", lambda: "label\n" + lines(WORDS)),
    "CSV of faces and names": (
        "x.csv",
        lambda: "face,name,label\n" + lines(f"{i},q,{k}" for i, k in enumerate(WORDS)),
    ),
    "JSON list of names": ("x.json", lambda: dumps(WORDS)),
    "JSON map from face to name": ("x.json", lambda: dumps(dict(enumerate(WORDS)))),
    "JSON faces by name": ("x.json", lambda: dumps({"stem": ids(0), "bar": ids(1)})),
    "JSON faces by name, from 1": ("x.json", lambda: dumps({"stem": ids(0, 1), "bar": ids(1, 1)})),
    "JSON labels and names": ("x.json", lambda: dumps({"labels": LABELS.tolist(), "names": NAMES})),
    "JSON names by number": (
        "x.json",
        lambda: dumps({"labels": LABELS.tolist(), "label_names": {"0": "stem", "1": "bar"}}),
    ),
    "a result of moseg": (
        "x.json",
        lambda: dumps({"labels": LABELS.tolist(), "problem": {"labels": NAMES}}),
    ),
    "JSON records": (
        "x.json",
        lambda: dumps([{"name": "stem", "faces": ids(0)}, {"name": "bar", "faces": ids(1)}]),
    ),
    "JSON records in a member": (
        "x.json",
        lambda: dumps(
            {"parts": [{"label": "stem", "face_ids": ids(0)}, {"label": "bar", "face_ids": ids(1)}]}
        ),
    ),
    "numpy names": ("x.npy", lambda: npy(np.array(WORDS))),
    "npz of moseg": (
        "x.npz",
        lambda: npz(labels=LABELS, names=np.array(NAMES), points=XYZ, areas=SHAPE.areas),
    ),
    "OBJ groups": ("x.obj", lambda: obj("g")),
    "OBJ objects": ("x.obj", lambda: obj("o")),
    "OBJ materials": ("x.obj", lambda: obj("usemtl")),
    "OBJ materials in one object": (
        "x.obj",
        lambda: obj("usemtl", before="mtllib t.mtl\no whole\ng whole\n"),
    ),
    "PLY of moseg": ("x.ply", moseg_ply),
    "GLB of moseg": ("x.glb", scene),
}

PARTIAL: dict[str, tuple[str, Callable[[], str | bytes]]] = {
    "-1 in .seg": ("x.seg", lambda: lines(PARTLY)),
    "-1.0": ("x.seg", lambda: savetxt(PARTLY)),
    "nan": ("x.seg", lambda: savetxt(NOT_NUMBERS)),
    "empty cells": (
        "x.csv",
        lambda: "face,label\n" + lines(f"{i},{'' if k < 0 else k}" for i, k in enumerate(PARTLY)),
    ),
    "rows that are missing": (
        "x.csv",
        lambda: "face,label\n" + lines(f"{i},{k}" for i, k in enumerate(PARTLY) if k >= 0),
    ),
    "null": ("x.json", lambda: dumps([None if k < 0 else k for k in PARTLY.tolist()])),
    "a map with gaps": (
        "x.json",
        lambda: dumps({i: k for i, k in enumerate(PARTLY.tolist()) if k >= 0}),
    ),
    "-1 of numpy": ("x.npy", lambda: npy(PARTLY)),
    "NaN of numpy": ("x.npy", lambda: npy(NOT_NUMBERS)),
    "-1 as an unsigned number": ("x.npy", lambda: npy(PARTLY.astype(np.uint32))),
    "-1 in PLY": ("x.ply", lambda: face_ply("int label", PARTLY)),
    "NaN in PLY": ("x.ply", lambda: face_ply("float label", NOT_NUMBERS)),
    "names, some empty": ("x.csv", lambda: table("face,label\n", PART_WORDS, ",")),
    "names, some 'unlabelled'": ("x.txt", lambda: lines(w or "unlabelled" for w in PART_WORDS)),
    "faces in no group": ("x.obj", lambda: obj("g", words=PART_WORDS)),
}

OF_VERTICES: dict[str, tuple[str, Callable[[], str | bytes]]] = {
    "as many as vertices": ("x.seg", lambda: lines(AT_VERTICES)),
    "numpy": ("x.npy", lambda: npy(AT_VERTICES)),
    "PLY of ScanNet": ("x.ply", lambda: vertex_ply("ushort label", AT_VERTICES)),
    "PLY of CloudCompare": ("x.ply", lambda: vertex_ply("float scalar_Label", AT_VERTICES * 1.0)),
    "segments of ScanNet": (
        "x.segs.json",
        lambda: dumps(
            {
                "params": {"kThresh": "0.01"},
                "sceneId": "s",
                "segIndices": (AT_VERTICES * 7).tolist(),
            }
        ),
    ),
    "segments with groups": (
        "x.json",
        lambda: dumps(
            {
                "segIndices": AT_VERTICES.tolist(),
                "segGroups": [
                    {"objectId": 0, "segments": [0], "label": "stem"},
                    {"objectId": 1, "segments": [1], "label": "bar"},
                ],
            }
        ),
    ),
    "JSON vertex_labels": ("x.json", lambda: dumps({"vertex_labels": AT_VERTICES.tolist()})),
    "JSON map": ("x.json", lambda: dumps(dict(enumerate(AT_VERTICES.tolist())))),
}


def partition(labels) -> list[int]:
    """Labels numbered by first appearance, which two labellings of one partition share."""
    numbers: dict[int, int] = {-1: -1}
    return [numbers.setdefault(k, len(numbers) - 1) for k in np.asarray(labels).tolist()]


def test_the_mesh_is_one_on_which_counts_do_not_coincide():
    assert len({N, V, len(TRIANGLES)}) == 3
    assert {-1, 0, 1} == set(PARTLY.tolist())


@pytest.mark.parametrize("dialect", WHOLE)
def test_labels(dialect, as_file):
    name, made = WHOLE[dialect]
    found = read_labels(as_file(name, made()), SHAPE)
    assert partition(found.labels) == partition(LABELS)


@pytest.mark.parametrize("dialect", NAMED)
def test_names(dialect, as_file):
    name, made = NAMED[dialect]
    found = read_labels(as_file(name, made()), SHAPE)
    assert [found.names[k] for k in found.labels] == WORDS


@pytest.mark.parametrize("dialect", PARTIAL)
def test_some_faces_without_a_label(dialect, as_file):
    name, made = PARTIAL[dialect]
    found = read_labels(as_file(name, made()), SHAPE)
    assert partition(found.labels) == partition(PARTLY)
    count = int((PARTLY < 0).sum())
    assert found.notes[-1] == f"{name}: {count} of {N} faces are unlabelled and left out"


@pytest.mark.parametrize("dialect", OF_VERTICES)
def test_labels_of_vertices(dialect, as_file):
    name, made = OF_VERTICES[dialect]
    found = read_labels(as_file(name, made()), SHAPE)
    assert partition(found.labels) == partition(CARRIED)
    said = f"{name}: labels of {V} vertices; each face has that of most of its corners"
    assert found.notes == (said,)


def test_labels_of_triangles(as_file):
    for name, contents in (("x.stl", solids(NAMES)), ("x.stl", binary_stl())):
        found = read_labels(as_file(name, contents), TRIANGULATED)
        assert partition(found.labels) == partition(TRIANGLE_LABELS)


@pytest.mark.parametrize(
    ("name", "contents", "message"),
    [
        ("x.seg", lines(range(3)), f"has 3 labels but the shape has {N} faces, {V} vertices and"),
        ("x.seg", lines(LABELS[1:]), "one is missing or over, perhaps a header; give the labels"),
        (
            "x.seg",
            lines(TRIANGLE_LABELS),
            "labels of the 60 triangles that its polygons can be cut",
        ),
        ("x.seg", lines(range(2 * V)), "give the labels of this very shape"),
        ("x.eseg", lines(range(3)), "has labels of edges, as MeshCNN writes them"),
        ("x.json", '{"segGroups": [], "segmentsFile": "a.segs.json"}', "give a.segs.json, which"),
        ("x.json", '{"a": [0, 1], "b": [1]}', "gives face 1 the label 'a' and the label 'b'"),
        ("x.json", '{"a": [0, 999]}', f"gives the label 'a' to face 999, but there are {N}"),
        ("x.json", '{"a": 1}', "has no labels under its members 'a'; allowed are a list"),
        ("x.json", '["a", 1]', "mixes names, such as 'a', and 1"),
        ("x.csv", "q,r\n1,2\n2,1\n", "has 2 columns: q, r; say which holds the labels"),
        ("x.npy", npy(np.ones((N, 5))), "if these are scores of labels, save their argmax"),
        ("x.npy", npy(np.array(["a"], "S")), "holds |S1, not numbers"),
        ("x.npz", npz(a=LABELS, b=LABELS), "has no array 'labels' but a, b; say which"),
        ("x.obj", obj("s"), "names no groups (g), objects (o) or materials (usemtl)"),
        (
            "x.stl",
            solids(["a", "a"], 0 * TRIANGLE_LABELS),
            "has one solid, which tells no faces apart",
        ),
        ("x.stl", binary_stl(0), "is binary, and so names no solids"),
        ("x.ply", points(), "has no property 'label'; give a file with labelled faces or points"),
        (
            "x.ply",
            face_ply("int q", LABELS),
            "it has 'q' of a face: say which with --label-property q",
        ),
    ],
)
def test_what_is_refused(name, contents, message, as_file):
    with pytest.raises(MosegError) as caught:
        read_labels(as_file(name, contents), SHAPE)
    assert message in str(caught.value)
    assert str(caught.value).startswith(name)
    assert "\n" not in str(caught.value)


def test_a_count_that_fits_the_edges_is_said_to_do_so(as_file):
    ends = np.sort(SHAPE.geometry.edges[0], axis=1)
    n_edges = len(np.unique(ends, axis=0))
    with pytest.raises(MosegError, match=f"{n_edges} edges; so these are labels of edges, as Mesh"):
        read_labels(as_file("x.seg", lines(range(n_edges))), SHAPE)


@pytest.mark.parametrize(
    ("name", "contents", "asked"),
    [
        (
            "x.ply",
            points(
                of="face", columns=[("int", "q"), ("int", "label")], values=[LABELS, 0 * LABELS]
            ),
            "q",
        ),
        ("x.ply", face_ply("float scalar_Q_seg", LABELS * 1.0), "q_seg"),
        ("x.ply", vertex_ply("uchar red", AT_VERTICES), None),
        ("x.npz", npz(labels=0 * LABELS, mine=LABELS), "mine"),
        ("x.json", dumps({"labels": [0] * N, "mine": LABELS.tolist()}), "mine"),
        ("x.csv", "label,mine\n" + lines(f"7,{k}" for k in LABELS), "mine"),
        ("x.csv", lines(f"7,{k},9" for k in LABELS), "2"),
        ("x.obj", obj("usemtl", before="g a\n"), "usemtl"),
        ("x.obj", obj("usemtl", before="g a\n"), "materials"),
        ("x.glb", scene(), "mesh"),
    ],
)
def test_the_property_may_be_named(name, contents, asked, as_file):
    path = as_file(name, contents)
    if asked is None:
        with pytest.raises(MosegError, match="has no property 'label'"):
            read_labels(path, SHAPE)
        return
    for wanted in (asked, ["nothing", asked]):
        found = read_labels(path, SHAPE, label_property=wanted)
        assert partition(found.labels) == partition(LABELS)
    with pytest.raises(MosegError, match=r"has no .* 'nothing'"):
        read_labels(path, SHAPE, label_property="nothing")
