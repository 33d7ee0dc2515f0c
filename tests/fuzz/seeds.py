"""Sound files of every format, small and of known contents: what damage is done to.

Meshes are a box of 3 x 2 x 1 units, triangulated: 44 triangles, an area of 22. Clouds are its
corners, grids an L of cells. All are written here by hand, by no writer of moseg.
"""

from __future__ import annotations

import base64
import gzip
import io
import json
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from tests import shapes
from tests.fuzz.case import Made

Triangles = tuple[np.ndarray, np.ndarray]


@cache
def box() -> Triangles:
    """Vertices (24, 3) and triangles (44, 3) of a closed box."""
    vertices, quads = shapes.box(3, 2, 1)
    return vertices, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


Rows = Sequence[Sequence[Any]]


def rows(table: Rows, before: str = "", between: str = " ") -> str:
    """A line for each row."""
    return "".join(f"{before}{between.join(map(str, row))}\n" for row in table)


def off(vertices: Rows, faces: Rows, *, counts: str | None = None) -> bytes:
    """An OFF file; its counts may be lies."""
    said = f"{len(vertices)} {len(faces)} 0" if counts is None else counts
    listed = [(len(face), *face) for face in faces]
    return f"OFF\n{said}\n{rows(vertices)}{rows(listed)}".encode()


def obj(vertices: Rows, faces: Rows) -> bytes:
    counted = [[corner + 1 for corner in face] for face in faces]
    return f"# a box\no box\n{rows(vertices, 'v ')}{rows(counted, 'f ')}".encode()


def ply_header(
    n_vertices: Any, n_faces: Any, *, format: str = "ascii", number: str = "float", more: str = ""
) -> bytes:
    """The header of a PLY file of triangles; counts may be anything."""
    axes = "".join(f"property {number} {axis}\n" for axis in "xyz")
    faces = "" if n_faces is None else (
        f"element face {n_faces}\nproperty list uchar int vertex_indices\n"
    )  # fmt: skip
    return (
        f"ply\nformat {format} 1.0\nelement vertex {n_vertices}\n{axes}{more}{faces}end_header\n"
    ).encode()


def ply(vertices: Rows, faces: Rows) -> bytes:
    listed = [(len(face), *face) for face in faces]
    body = rows(vertices) + rows(listed)
    return ply_header(len(vertices), len(faces), number="double") + body.encode()


def ply_binary(vertices: Rows, faces: Rows, order: str = "<") -> bytes:
    word = "binary_little_endian" if order == "<" else "binary_big_endian"
    head = ply_header(len(vertices), len(faces), format=word, number="double")
    body = np.asarray(vertices, f"{order}f8").tobytes()
    listed = b"".join(bytes([len(f)]) + np.asarray(f, f"{order}i4").tobytes() for f in faces)
    return head + body + listed


def stl(vertices: Rows, faces: Rows) -> bytes:
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + rows([vertices[corner] for corner in face], "vertex ")
        + "endloop\nendfacet\n"
        for face in faces
    )
    return f"solid box\n{facets}endsolid box\n".encode()


def stl_binary(vertices: Rows, faces: Rows, *, count: int | None = None) -> bytes:
    record = np.zeros(len(faces), [("n", "<f4", 3), ("corners", "<f4", (3, 3)), ("a", "<u2")])
    record["corners"] = np.asarray(vertices, np.float64)[np.asarray(faces)]
    said = len(faces) if count is None else count
    return bytes(80) + struct.pack("<I", said) + record.tobytes()


def scene(vertices: Rows, faces: Rows) -> tuple[dict[str, Any], bytes]:
    """A glTF document of one mesh, and the bytes that it speaks of."""
    points = np.asarray(vertices, "<f4").tobytes()
    corners = np.asarray(faces, "<u4").tobytes()
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "box"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(points) + len(corners)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(corners)},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"},
        ],
    }
    return document, points + corners


def glb(document: Any, binary: bytes, *, length: int | None = None) -> bytes:
    """A binary glTF file of a document, or of the text of one."""
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks) if length is None else length) + chunks


def gltf(document: dict[str, Any], binary: bytes) -> bytes:
    data = f"data:application/octet-stream;base64,{base64.b64encode(binary).decode()}"
    buffers = [{**document["buffers"][0], "uri": data}]
    return json.dumps({**document, "buffers": buffers}).encode()


def npy(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def npz(**arrays: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


def npy_header(words: str | bytes, body: bytes = b"", *, version: int = 1) -> bytes:
    """An .npy file with a header of any words."""
    text = (words if isinstance(words, bytes) else words.encode("latin1")) + b"\n"
    size = struct.pack("<H" if version == 1 else "<I", len(text))
    return b"\x93NUMPY" + bytes((version, 0)) + size + text + body


def ell() -> np.ndarray:
    """(5, 4, 3) uint8: an L of 10 cells, one of its arms 1 and the other 2."""
    cells = np.zeros((5, 4, 3), np.uint8)
    cells[1:4, 1, 1:] = 1
    cells[3, 2:, 1:] = 2
    return cells


N_CELLS = 10


def binvox(head: str, runs: bytes) -> bytes:
    return f"#binvox 1\n{head}data\n".encode() + runs


def _binvox() -> bytes:
    return binvox("dim 3 3 3\ntranslate 0 0 0\nscale 1\n", bytes((0, 9, 1, 9, 0, 1, 1, 8)))


def nifti(array: np.ndarray, **fields: Any) -> bytes:
    """A NIfTI-1 file by hand: a header of 348 bytes, of which a field may be anything."""
    codes = {"uint8": 2, "int16": 4, "int32": 8, "float32": 16, "float64": 64}
    dims = [array.ndim, *array.shape, *([1] * (7 - array.ndim))]
    values: dict[str, Any] = {
        "dim": dims, "datatype": codes[array.dtype.name], "bitpix": array.dtype.itemsize * 8,
        "pixdim": [1.0] * 8, "vox_offset": 352.0, "slope": 1.0, "inter": 0.0, "qform": 0,
        "sform": 1, "srow": [0.9, 0, 0, 5, 0, 0.8, 0, -3, 0, 0, 2.0, 1], "magic": b"n+1\0",
        "size": 348,
    }  # fmt: skip
    values |= fields
    head = bytearray(352)
    struct.pack_into("<i", head, 0, values["size"])
    struct.pack_into("<8h", head, 40, *values["dim"])
    struct.pack_into("<hh", head, 70, values["datatype"], values["bitpix"])
    struct.pack_into("<8f", head, 76, *values["pixdim"])
    struct.pack_into("<3f", head, 108, values["vox_offset"], values["slope"], values["inter"])
    struct.pack_into("<hh", head, 252, values["qform"], values["sform"])
    struct.pack_into("<12f", head, 280, *values["srow"])
    struct.pack_into("<4s", head, 344, values["magic"])
    return bytes(head) + array.tobytes(order="F")


def nrrd(array: np.ndarray, *, head: dict[str, str] | None = None, body: bytes | None = None):
    """A NRRD file by hand; a field that is "" is left out."""
    fields = {
        "type": "uint8",
        "dimension": str(array.ndim),
        "space": "left-posterior-superior",
        "sizes": " ".join(map(str, array.shape)),
        "space directions": "(1,0,0) (0,1,0) (0,0,2)",
        "kinds": "domain domain domain",
        "encoding": "raw",
        "space origin": "(0,0,0)",
    } | (head or {})
    lines = "".join(f"{key}: {value}\n" for key, value in fields.items() if value)
    data = array.astype(np.uint8).tobytes(order="F") if body is None else body
    return f"NRRD0005\n{lines}\n".encode() + data


@dataclass(frozen=True, kw_only=True)
class Seed:
    """A sound file.

    Parameters
    ----------
    format, suffix, task : str
        As in a case.
    data : callable
        The contents.
    elements : int
        How many elements, labels or parts it has.
    counted : bool
        Whether the file says itself how much it holds, so that a cut can be noticed.
    text : bool
        Whether it is made of lines.
    """

    format: str
    suffix: str
    data: Callable[[], bytes]
    elements: int
    counted: bool
    text: bool
    task: str = "shape"
    beside: dict[str, bytes] = field(default_factory=dict)

    def with_data(self, data: bytes) -> Made:
        """The damaged file, with what stands beside it."""
        return {"": data, **self.beside} if self.beside else data


def _named(text: bytes) -> bytes:
    return b"x,y,z,intensity\n" + text.replace(b" ", b",").replace(b"\n", b",7\n")


def _points() -> bytes:
    return rows(box()[0]).encode()


SEEDS = [
    Seed(format=name, suffix=suffix, data=data, elements=n, counted=counted, text=text)
    for name, suffix, data, n, counted, text in (
        ("off", ".off", lambda: off(*box()), 44, True, True),
        ("obj", ".obj", lambda: obj(*box()), 44, False, True),
        ("ply, text", ".ply", lambda: ply(*box()), 44, True, True),
        ("ply, binary", ".ply", lambda: ply_binary(*box()), 44, True, False),
        ("ply, binary, big endian", ".ply", lambda: ply_binary(*box(), ">"), 44, True, False),
        ("stl, text", ".stl", lambda: stl(*box()), 44, True, True),
        ("stl, binary", ".stl", lambda: stl_binary(*box()), 44, True, False),
        ("glb", ".glb", lambda: glb(*scene(*box())), 44, True, False),
        ("gltf", ".gltf", lambda: gltf(*scene(*box())), 44, True, True),
        ("npy, grid", ".npy", lambda: npy(ell()), N_CELLS, True, False),
        ("npy, points", ".npy", lambda: npy(box()[0]), 24, True, False),
        ("binvox", ".binvox", _binvox, 17, True, False),
        ("points, xyz", ".xyz", _points, 24, False, True),
        ("points, csv", ".csv", lambda: _named(_points()), 24, False, True),
        ("points, pts", ".pts", lambda: b"24\n" + _points(), 24, True, True),
        ("ply, points", ".ply", lambda: ply_header(24, None, number="double") + _points(),
         24, True, True),
        ("nifti", ".nii", lambda: nifti(ell()), N_CELLS, True, False),
        ("nifti, zipped", ".nii.gz", lambda: gzip.compress(nifti(ell()), mtime=0),
         N_CELLS, True, False),
        ("nrrd", ".nrrd", lambda: nrrd(ell()), N_CELLS, True, False),
        ("nrrd, zipped", ".nrrd", lambda: nrrd(
            ell(), head={"encoding": "gzip"},
            body=gzip.compress(ell().tobytes(order="F"), mtime=0)), N_CELLS, True, False),
    )
]  # fmt: skip
"""A sound file of each format of shapes."""
