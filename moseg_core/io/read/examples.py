"""A small file in each format that the core reads: what its readers are tried on.

The contract kit asks each reader for such a file (``example`` of
:class:`~moseg_core.components.discovery.specs.ReaderSpec`), reads it, and cuts it short. All hold
the corner of a cube, as a mesh, as its corners or as a block of cells.
"""

from __future__ import annotations

import base64
import io
import json
import struct
from typing import Any

import numpy as np

_CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))


def _rows(rows: tuple[tuple[int, ...], ...], between: str = " ", before: str = "") -> str:
    return "".join(f"{before}{between.join(map(str, row))}\n" for row in rows)


def _off() -> bytes:
    return f"OFF\n4 4 0\n{_rows(_CORNERS)}{_rows(_FACES, before='3 ')}".encode()


def _ply() -> bytes:
    header = (
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    )
    return f"{header}{_rows(_CORNERS)}{_rows(_FACES, before='3 ')}".encode()


def _obj() -> bytes:
    counted = tuple(tuple(k + 1 for k in face) for face in _FACES)
    return f"{_rows(_CORNERS, before='v ')}{_rows(counted, before='f ')}".encode()


def _stl() -> bytes:
    corners = np.array(_CORNERS, "<f4")
    record = np.zeros(4, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    record["corners"] = corners[np.array(_FACES)]
    return bytes(80) + struct.pack("<I", 4) + record.tobytes()


def _scene() -> tuple[dict[str, Any], bytes]:
    """A glTF document of one mesh, and the buffer that it speaks of."""
    points, faces = np.array(_CORNERS, "<f4").tobytes(), np.array(_FACES, "<u4").tobytes()
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(points) + len(faces)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(faces)},
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 4,
                "type": "VEC3",
                "min": [0, 0, 0],
                "max": [1, 1, 1],
            },
            {"bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR"},
        ],
    }
    return document, points + faces


def _gltf() -> bytes:
    document, content = _scene()
    data = base64.b64encode(content).decode()
    document["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{data}"
    return json.dumps(document).encode()


def _glb() -> bytes:
    document, content = _scene()
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(content), b"BIN\0") + content
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _npy() -> bytes:
    file = io.BytesIO()
    np.save(file, np.ones((3, 3, 3), np.bool_))
    return file.getvalue()


def _binvox() -> bytes:
    return b"#binvox 1\ndim 3 3 3\ntranslate 0 0 0\nscale 1\ndata\n" + bytes((1, 27))


_MAKERS = {
    ".off": _off,
    ".ply": _ply,
    ".obj": _obj,
    ".stl": _stl,
    ".glb": _glb,
    ".gltf": _gltf,
    **dict.fromkeys((".xyz", ".pts", ".asc", ".txt"), lambda: _rows(_CORNERS).encode()),
    ".csv": lambda: ("x,y,z\n" + _rows(_CORNERS, ",")).encode(),
    ".npy": _npy,
    ".binvox": _binvox,
}


def example(suffix: str) -> bytes | None:
    r"""The contents of a small file of a suffix; None for one that there is no example of.

    Examples
    --------
    >>> example(".xyz")
    b'0 0 0\n1 0 0\n0 1 0\n0 0 1\n'
    """
    maker = _MAKERS.get(suffix)
    return None if maker is None else maker()
