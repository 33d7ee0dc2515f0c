"""Kinds of surplus and missing data that real programs write, each made here in several dialects.

Half of the inputs are whole shapes in unusual clothes: they are read, and what was passed over is
said. The other half are damaged, or ask for what moseg does not do: they are refused in one line.
"""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from moseg_core import Shape, load
from moseg_core.errors import ShapeError
from tests.io.read.glb_files import TETRAHEDRON, glb, one_node, pack
from tests.io.read.ply_files import FACES, VERTICES, encode, mesh_file

#: A file, or several that belong together, of which the first is read.
Contents = bytes | str | Mapping[str, bytes]

RNG = np.random.default_rng(5)
NORMALS = RNG.normal(size=(40, 3))
NORMALS /= np.linalg.norm(NORMALS, axis=1, keepdims=True)
POINTS = (NORMALS * [3, 2, 1]).round(4)
COLOURS = RNG.integers(0, 256, (40, 3))
LABELS = RNG.integers(0, 4, (40, 1))
BOX = trimesh.creation.box((3, 2, 1))
STL = BOX.export(file_type="stl")
TEXT_STL = BOX.export(file_type="stl_ascii")
OBJ = BOX.export(file_type="obj")
OFF = BOX.export(file_type="off") + "\n"
PLY = mesh_file("binary_little_endian")
INVALID = "points that are not finite: 3; they keep their rows and carry no weight"
GAPS = POINTS.copy()
GAPS[[0, 7, 8]] = np.nan


def text(*blocks: Any, sep: str = " ", head: str = "", form: str = "%.10g") -> str:
    stream = io.StringIO()
    np.savetxt(stream, np.hstack(blocks), delimiter=sep, fmt=form)
    return head + stream.getvalue()


def npy(array: Any) -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.asarray(array), allow_pickle=True)
    return stream.getvalue()


def document(edit: Callable[[dict], object] = lambda tree: None, **node: Any) -> dict:
    """A tetrahedron as glTF, its bytes within the text."""
    tree, binary = glb([[TETRAHEDRON]], [{"mesh": 0, **node}])
    code = base64.b64encode(binary).decode()
    tree["buffers"] = [{"byteLength": len(binary), "uri": f"data:;base64,{code}"}]
    edit(tree)
    return tree


def gltf(edit: Callable[[dict], object] = lambda tree: None, **node: Any) -> str:
    return json.dumps(document(edit, **node))


def beside(uri: str, name: str) -> dict[str, bytes]:
    """A glTF file with its bytes in a file."""
    tree, binary = glb([[TETRAHEDRON]], [{"mesh": 0}])
    tree["buffers"] = [{"byteLength": len(binary), "uri": uri}]
    return {"a.gltf": json.dumps(tree).encode(), name: binary}


def primitive(tree: dict) -> dict:
    return tree["meshes"][0]["primitives"][0]


def view(tree: dict) -> dict:
    return tree["bufferViews"][0]


def noisy_stl(noise: float) -> bytes:
    """Text of a box whose corners at 0 differ from triangle to triangle, and by how much."""
    box = trimesh.creation.box((3, 2, 1))
    box.apply_translation((1.5, 1, 0.5))
    corners = box.triangles + noise * np.random.default_rng(0).random((12, 3, 3))
    facets = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join("vertex {!r} {!r} {!r}\n".format(*map(float, corner)) for corner in corners_)
        + "endloop\nendfacet\n"
        for corners_ in corners
    )
    return f"solid box\n{facets}endsolid box\n".encode()


def quantized() -> bytes:
    corners = np.array([(0, 0, 0), (127, 0, 0), (0, 127, 0), (0, 0, 127)], "i1")
    mesh = {
        "POSITION": corners,
        "indices": TETRAHEDRON["indices"],
        "described": {"normalized": True},
    }
    needs = ["KHR_mesh_quantization"]
    return pack(*glb([[mesh]], [{"mesh": 0}], extensionsRequired=needs, extensionsUsed=needs))


READ: dict[str, tuple[str, Contents, int, str]] = {
    # name: (file, contents, elements, a note)
    "normal and label": ("a.txt", text(POINTS, NORMALS, LABELS), 40, "passed over: column 7"),
    "colour, then normal": ("a.asc", text(POINTS, COLOURS, NORMALS), 40, "over: columns 4, 5, 6"),
    "leica": ("a.pts", text(POINTS, LABELS, COLOURS, head="40\n"), 40, "over: columns 4, 5, 6, 7"),
    "leica, two scans": (
        "a.pts",
        text(POINTS[:9], COLOURS[:9], head="9\n") + text(POINTS[9:], COLOURS[9:], head="31\n"),
        40,
        "passed over: columns 4, 5, 6",
    ),
    "commented header": (
        "a.csv",
        text(POINTS, LABELS, sep=",", head="//X,Y,Z,Scalar field\n"),
        40,
        "passed over: column 'scalar field'",
    ),
    "header of numpy": ("a.txt", text(POINTS, LABELS, head="# x y z label\n"), 40, "'label'"),
    "header of another separator": ("a.xyz", text(POINTS, LABELS, head="# x,y,z,w\n"), 40, "'w'"),
    "comments of the program": (
        "a.xyz",
        text(POINTS, LABELS, head="// made by a scanner\n% in metres\n"),
        40,
        "passed over: column 4",
    ),
    "columns of paraview": (
        "a.csv",
        text(LABELS, POINTS, sep=",", head='"id","Points:0","Points:1","Points:2"\n'),
        40,
        "passed over: column 'id'",
    ),
    "index of pandas": (
        "a.csv",
        text(np.arange(40)[:, None], POINTS, sep=",", head=",x,y,z\n"),
        40,
        "passed over: column ''",
    ),
    "missing values of pandas": (
        "a.csv",
        text(GAPS, sep=",", head="x,y,z\n").replace("nan", ""),
        40,
        INVALID,
    ),
    "missing values of a C library": ("a.xyz", text(GAPS).replace("nan", "-nan(ind)"), 40, INVALID),
    "first row without a value": ("a.xyz", text(GAPS, COLOURS), 40, INVALID),
    "decimal commas": (
        "a.csv",
        text(POINTS, sep=";", head="x;y;z\n").replace(".", ","),
        40,
        "commas are taken for decimal points",
    ),
    "tabs": ("a.xyz", text(POINTS, LABELS, sep="\t", head="X\tY\tZ\tan id\n"), 40, "'an id'"),
    "separator behind the last cell": (
        "a.csv", text(POINTS, LABELS, sep=",").replace("\n", ",\n"), 40, "column 4",
    ),
    "text of two bytes a letter": ("a.txt", text(POINTS, LABELS).encode("utf-16"), 40, "column 4"),
    "labels that are words": (
        "a.txt",
        "".join(f"{row} chair_{k}\n" for k, row in enumerate(text(POINTS).splitlines())),
        40,
        "passed over: column 4",
    ),
    "array with colours": ("a.npy", npy(np.hstack([POINTS, COLOURS])), 40, "columns 4, 5, 6"),
    "array of another byte order": ("a.npy", npy(GAPS.astype(">f4")), 40, INVALID),
    "picture of depth": ("a.npy", npy(GAPS.reshape(8, 5, 3)), 40, "8 x 5 points, row by row"),
    "cloud without normals in places": (
        "a.ply",
        encode(
            "binary_little_endian",
            [("vertex", [f"double {n}" for n in ("x", "y", "z", "nx", "ny", "nz")],
              np.hstack([POINTS, np.where(LABELS > 0, NORMALS, np.nan)]).tolist())],
        ),
        40,
        "normals that are not finite:",
    ),
    "line's end behind stl": ("a.stl", STL + b"\r\n", 12, "bytes behind the last triangle: 2"),
    "block behind stl": ("a.stl", STL + bytes(1024 - len(STL)), 12, "bytes behind the last triang"),
    "end of file of dos": ("a.stl", TEXT_STL.encode() + b"\x1a", 12, "behind the text: 1"),
    "stl whose zeros differ": ("a.stl", noisy_stl(1e-15), 12, "less than 3.7e-08 from another"),
    "bytes behind glb": ("a.glb", one_node() + b"\n", 4, "bytes behind the end of the file: 1"),
    "byte behind ply": ("a.ply", PLY + b"\0", 4, "bytes behind the data: 1; passed over"),
    "statements of one's own": ("a.obj", OBJ + "\ne 1 2\nvc 1 1 1\n", 12, "statement 'vc' is unkn"),
    "edges as faces in obj": ("a.obj", OBJ + "\nf 1 2\nf 3\n", 12, "fewer than three corners: 2"),
    "edges as faces in off": (
        "a.off",
        OFF.replace("8 12", "8 13", 1) + "2 0 1\n",
        12,
        "faces of fewer than three corners: 1",
    ),
    "edges as faces in ply": (
        "a.ply",
        mesh_file("ascii", faces=[[0, 1], *FACES]),
        4,
        "fewer than three corners: 1, the first in row 0",
    ),
    "no place in obj, not used": ("a.obj", OBJ + "\nv nan nan nan\n", 12, "used by no face: 1"),
    "no place in ply, not used": (
        "a.ply",
        mesh_file("binary_big_endian", [*VERTICES, (np.inf, 0, 0), (0, np.nan, 0)]),
        4,
        "used by no face: 2",
    ),
    "too far in off, not used": (
        "a.off",
        OFF.replace("8 12", "9 12", 1).replace("\n3 ", "\n1e300 0 0\n3 ", 1),
        12,
        "used by no face: 1",
    ),
    "skin": ("a.gltf", gltf(skin=0, translation=[5, 5, 5]), 4, "meshes with a skin: 1; read in"),
    "morph targets": (
        "a.gltf",
        gltf(lambda tree: primitive(tree).update(targets=[{"POSITION": 0}]), weights=[1]),
        4,
        "though the file shows some of them",
    ),
    "lines among triangles": (
        "a.glb",
        pack(*glb([[TETRAHEDRON, {**TETRAHEDRON, "mode": 3}]], [{"mesh": 0}])),
        4,
        "lists of points or lines: 1; passed over",
    ),
    "gltf with a file beside": ("a.gltf", beside("my%20data.bin", "my data.bin"), 4, ""),
    "gltf with a folder beside": ("a.gltf", beside("./data/a.bin", "data/a.bin"), 4, ""),
    "whole numbers in glb": ("a.glb", quantized(), 4, ""),
}  # fmt: skip

REFUSED: dict[str, tuple[str, Contents, str]] = {
    # name: (file, contents, what is said)
    "row cut off": ("a.xyz", text(POINTS) + "1 2", "the row has 2 cells, the first 3"),
    "row too long": ("a.csv", text(POINTS, sep=",", head="x,y,z\n") + "1,2,3,4\n", "has 4 cells"),
    "last cell cut off": ("a.csv", text(POINTS, sep=",", head="x,y,z\n") + "1,2,", "is cut off"),
    "fewer points than announced": ("a.pts", text(POINTS, head="41\n"), "announced, 40 follow"),
    "more points than announced": ("a.pts", text(POINTS, head="39\n"), "more points than ann"),
    "word for a coordinate": ("a.txt", text(POINTS) + "1 2 x\n", "'x' is not a number"),
    "atoms": ("a.xyz", "2\nwater\nO 0 0 0\nH 0 0 1\n", "the row has 4 cells, the first 1"),
    "no heights": ("a.csv", text(POINTS[:, :2], sep=",", head="x,y\n"), "has no column 'z'"),
    "two columns": ("a.txt", text(POINTS[:, :2]), "expected x y z in the first columns, found 2"),
    "no point with a place": ("a.xyz", "nan nan nan\n" * 9, "no point is finite"),
    "point beyond all": ("a.xyz", text(POINTS) + "1e300 0 0\n", "beyond what can be measured"),
    "array of two columns": ("a.npy", npy(POINTS[:, :2]), "a cloud of points the shape (N, 3)"),
    "array on its side": ("a.npy", npy(np.vstack([POINTS] * 9).T), "save it transposed"),
    "array of densities": ("a.npy", npy(np.zeros((4, 5, 6))), "save the grid as bool"),
    "array of objects": ("a.npy", npy(np.array([{}, None], object)), "not numbers"),
    "triangle behind stl": ("a.stl", STL + STL[-50:], "does not match its header"),
    "stl cut off": ("a.stl", STL[:-1], "is cut off or damaged"),
    "stl of no triangles": ("a.stl", STL[:80] + bytes(4) + STL[84:], "does not match its header"),
    "glb cut off": ("a.glb", one_node()[:-4], "it is cut off or damaged"),
    "row behind ply": ("a.ply", PLY + PLY[-13:], "holds more than its header announces"),
    "ply cut off": ("a.ply", PLY[:-1], "it is cut off"),
    "no place in ply, used": (
        "a.ply", mesh_file("ascii", [(np.nan, 0, 0), *VERTICES[1:]]), "vertex 0 is not finite",
    ),
    "no place in obj, used": ("a.obj", OBJ + "\nv nan 0 0\nf 1 2 9\n", "vertex 8 is not finite"),
    "damaged face line": ("a.obj", OBJ + "\nf1 2 3\n", "'f1' is not a statement of an OBJ file"),
    "damaged vertex line": ("a.obj", OBJ + "\nv1 2 3\n", "'v1' is not a statement of an OBJ file"),
    "damaged keyword": ("a.obj", OBJ + "\n\x07 1 2 3\n", "is not a statement of an OBJ file"),
    "face cut off": ("a.obj", OBJ + "\nf 1 2", "the last face is cut off"),
    "face of no vertex": ("a.obj", OBJ + "\nf 1 2 9\n", "names vertex 9, but there are 8"),
    "patches": ("a.obj", OBJ + "\nsurf 0 1 0 1 1 2 3 4\n", "'surf' is not supported"),
    "more faces than announced": ("a.off", OFF + "3 0 1 2\n", "goes on behind them"),
    "draco": (
        "a.gltf",
        gltf(lambda tree: tree.update(extensionsRequired=["KHR_draco_mesh_compression"])),
        "compressed with KHR_draco_mesh_compression; open it in a program that reads it",
    ),
    "meshopt": (
        "a.gltf",
        gltf(lambda tree: tree.update(extensionsRequired=["EXT_meshopt_compression"])),
        "compressed with EXT_meshopt_compression; open it in a program that reads it",
    ),
    "meshopt in a view": (
        "a.gltf",
        gltf(lambda tree: view(tree).update(extensions={"EXT_meshopt_compression": {}})),
        "compressed with EXT_meshopt_compression",
    ),
    "sparse": (
        "a.gltf",
        gltf(lambda tree: tree["accessors"][0].update(sparse={"count": 1})),
        "has a sparse accessor (accessors[0]); open it in",
    ),
    "many at once": (
        "a.gltf",
        gltf(extensions={"EXT_mesh_gpu_instancing": {}}),
        "uses the extension EXT_mesh_gpu_instancing; export it without",
    ),
    "file out of the folder": ("a.gltf", beside("..%2Fb.bin", "b.bin"), "out of its folder"),
    "file of the system": ("a.gltf", beside("/etc/passwd", "b.bin"), "out of its folder"),
    "file on a network": ("a.gltf", beside("http://a.org/b.bin", "b.bin"), "out of its folder"),
    "file that is not there": ("a.gltf", beside("c.bin", "b.bin"), "'c.bin', which is not there"),
    "gltf that is no json": ("a.gltf", gltf()[:-9], "has damaged JSON"),
    "gltf of version 1": (
        "a.gltf", gltf(lambda tree: tree.update(asset={"version": "1.0"})), "glTF version 1.0",
    ),
}  # fmt: skip


def put(folder: Path, name: str, contents: Contents) -> Path:
    files = contents if isinstance(contents, Mapping) else {name: contents}
    for each, data in files.items():
        path = folder / each
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(data.encode() if isinstance(data, str) else data)
    return folder / name


@pytest.mark.parametrize("kind", READ)
def test_what_is_whole_is_read_and_what_was_passed_over_is_said(kind, tmp_path):
    name, contents, elements, note = READ[kind]
    shape = load(put(tmp_path, name, contents))
    assert shape.n_elements == elements
    assert sum(note in found for found in shape.notes) == 1 or not note
    assert len(set(shape.notes)) == len(shape.notes)
    check_measures(shape, kind)


def check_measures(shape: Shape, kind: str) -> None:
    """What all files of one kind must agree in."""
    if shape.noun == "point":
        placed = shape.areas > 0
        np.testing.assert_allclose(shape.points[placed], POINTS[placed], atol=1e-6)
        assert (shape.geometry.normals is not None) == ("normal" in kind)
    elif shape.n_elements == 12:
        assert shape.volume == pytest.approx(6.0)
    else:
        assert shape.volume == pytest.approx(1 / 6 if "whole numbers" in kind else 0.25)


@pytest.mark.parametrize("kind", REFUSED)
def test_what_is_damaged_is_refused_in_one_line(kind, tmp_path):
    name, contents, says = REFUSED[kind]
    with pytest.raises(ShapeError) as caught:
        load(put(tmp_path, name, contents))
    assert str(caught.value).startswith(name)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_there_are_enough_of_both():
    assert len(READ) >= 20 <= len(REFUSED)
