"""Where to cut a mushroom, so that its cap needs no support.

    python try_it.py

writes ``mushroom.off``, cuts it where nothing hangs over, and prints what that comes to.
"""

from __future__ import annotations

import math
from pathlib import Path

import moseg_core as moseg

AROUND = 24
#: (radius, height) from the middle of the underside to the middle of the top.
PROFILE = [
    *((r / 4, 0.0) for r in range(1, 4)),
    *((1.0, float(z)) for z in range(9)),  # the stem, 8 high
    *((1.0 + r / 4, 8.0) for r in range(1, 9)),  # the underside of the cap
    *((3 * math.cos(t), 8 + 2 * math.sin(t)) for t in (k * math.pi / 16 for k in range(1, 8))),
]


def mushroom() -> moseg.Shape:
    """The profile turned around the z axis."""
    rings = len(PROFILE)
    vertices = [
        [r * math.cos(2 * math.pi * k / AROUND), r * math.sin(2 * math.pi * k / AROUND), z]
        for r, z in PROFILE
        for k in range(AROUND)
    ]
    bottom, top = len(vertices), len(vertices) + 1
    vertices += [[0.0, 0.0, 0.0], [0.0, 0.0, 10.0]]
    faces = []
    for k in range(AROUND):
        after = (k + 1) % AROUND
        faces.append([bottom, after, k])
        faces += [
            [i * AROUND + k, i * AROUND + after, (i + 1) * AROUND + after, (i + 1) * AROUND + k]
            for i in range(rings - 1)
        ]
        faces.append([top, (rings - 1) * AROUND + k, (rings - 1) * AROUND + after])
    return moseg.Shape.from_mesh(vertices, faces, name="mushroom")


def write_off(shape: moseg.Shape, path: Path) -> None:
    """Write a mesh for the command line."""
    mesh = shape.geometry
    lines = ["OFF", f"{len(mesh.vertices)} {shape.n_elements} 0"]
    lines += [" ".join(map(str, vertex)) for vertex in mesh.vertices.tolist()]
    for begin, end in zip(mesh.offsets[:-1], mesh.offsets[1:], strict=True):
        corners = mesh.corners[begin:end].tolist()
        lines.append(" ".join(map(str, [len(corners), *corners])))
    path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    shape = mushroom()
    write_off(shape, Path("mushroom.off"))
    whole = moseg.Problem(["whole"], "overhang(whole)")
    cost = whole.evaluate(shape, [0] * shape.n_elements).cost.value
    print(f"in one piece: {cost:.2f}")

    problem = moseg.Problem(["stem", "cap"], "overhang(*)")
    result = moseg.segment(shape, problem, seed=0)
    for call in result.evaluation.terms[0].calls:
        print(f"the {call.labels[0]}: {call.value:.2f}")
    heights = result.parts["stem"].vertices[:, 2]
    print(f"the stem reaches from {heights.min():g} to {heights.max():g}")
