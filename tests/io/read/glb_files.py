"""GLB files made by hand, down to the bytes."""

from __future__ import annotations

import json
import struct

import numpy as np

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1.5)], "<f4")
FACES = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)], "<u2")
COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}


def pack(document: object, binary: bytes) -> bytes:
    """A GLB file from its JSON and its binary chunk."""
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    if binary:
        chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def glb(meshes: list[list[dict]], nodes: list[dict], **rest: object) -> tuple[dict, bytes]:
    """Document and binary chunk; a primitive gives its "POSITION" and "indices" as arrays."""
    binary, views, accessors = b"", [], []

    def accessor(array: np.ndarray, **described: object) -> int:
        nonlocal binary
        array = np.asarray(array)
        binary += b"\0" * (-len(binary) % 4)
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes})
        binary += array.tobytes()
        kind = "SCALAR" if array.ndim == 1 else f"VEC{array.shape[1]}"
        accessors.append(
            {"bufferView": len(views) - 1, "componentType": COMPONENTS[array.dtype.str[1:]],
             "count": len(array), "type": kind, **described}
        )  # fmt: skip
        return len(accessors) - 1

    listed = []
    for mesh in meshes:
        primitives = []
        for given_primitive in mesh:
            primitive = dict(given_primitive)
            described = primitive.pop("described", {})
            position = accessor(primitive.pop("POSITION"), **described)
            primitive["attributes"] = {"POSITION": position}
            if "indices" in primitive:
                primitive["indices"] = accessor(primitive["indices"])
            primitives.append(primitive)
        listed.append({"primitives": primitives})
    document = {
        "asset": {"version": "2.0"},
        "meshes": listed,
        "nodes": nodes,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
        **rest,
    }
    return document, binary


TETRAHEDRON = {"POSITION": CORNERS, "indices": FACES.reshape(-1)}


def one_node(**node: object) -> bytes:
    return pack(*glb([[TETRAHEDRON]], [{"mesh": 0, **node}]))
