"""PLY files made by hand, in text and in both byte orders."""

from __future__ import annotations

import numpy as np

CODES = {
    "char": "i1", "uchar": "u1", "int16": "i2", "ushort": "u2", "int": "i4", "uint32": "u4",
    "float": "f4", "double": "f8",
}  # fmt: skip
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
FORMATS = ["ascii", *ORDERS]

VERTICES = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1.5)])
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def encode(form: str, elements: list[tuple[str, list[str], list[list]]], *, comments=()) -> bytes:
    """A PLY file from (element, properties, rows); a list in a row is a list property."""
    header = ["ply", f"format {form} 1.0", *(f"comment {text}" for text in comments)]
    for name, properties, rows in elements:
        header += [f"element {name} {len(rows)}", *(f"property {p}" for p in properties)]
    body = b""
    for _, properties, rows in elements:
        types = [declared.split()[:-1] for declared in properties]
        for row in rows:
            if form == "ascii":
                words = []
                for value in row:
                    words += [len(value), *value] if isinstance(value, list) else [value]
                body += " ".join(map(str, words)).encode() + b"\n"
                continue
            for value, kind in zip(row, types, strict=True):
                if kind[0] == "list":
                    body += np.array(len(value), ORDERS[form] + CODES[kind[1]]).tobytes()
                body += np.array(value, ORDERS[form] + CODES[kind[-1]]).tobytes()
    return "\n".join([*header, "end_header\n"]).encode() + body


def mesh_file(form: str, vertices=VERTICES, faces=FACES, labels=None, comments=()) -> bytes:
    properties = ["list uchar int vertex_indices"]
    rows: list[list] = [[list(face)] for face in faces]
    if labels is not None:
        properties.append("int label")
        rows = [[*row, label] for row, label in zip(rows, labels, strict=True)]
    elements = [
        ("vertex", ["float x", "float y", "float z"], np.asarray(vertices).tolist()),
        ("face", properties, rows),
    ]
    return encode(form, elements, comments=comments)


ASCII = mesh_file("ascii").decode()
BINARY = mesh_file("binary_little_endian")
