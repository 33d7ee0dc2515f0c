"""Draw what ``--clip`` does: a boundary of the sample horse before and after.

Run it from anywhere::

    python tools/clip_picture.py                      # writes docs/images/clip.png
    python tools/clip_picture.py --output elsewhere.png

A piece of the surface around one boundary is cut out of the mesh twice, as it was segmented and as
it was clipped.
"""

from __future__ import annotations

import argparse
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

import moseg_core as moseg
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.view.picture import render_picture

DESTINATION = Path(__file__).resolve().parent.parent / "docs" / "images" / "clip.png"
SIZE = (1400, 560)
HALF = SIZE[0] // 2, SIZE[1]
BOUNDARY = ("head", "body")
#: A centre, in units of the sample, and a weight for each part.
CENTERS = {
    "head": ((0.95, 1.85, 0.0), 1.0),
    "body": ((-0.2, 1.2, 0.0), 1.5),
    "leg1": ((0.60, 0.40, -0.16), 1.0),
    "leg2": ((0.29, 0.40, 0.16), 1.0),
    "leg3": ((-0.77, 0.50, -0.16), 1.0),
    "leg4": ((-0.52, 0.50, 0.16), 1.0),
}

#: What to show: everything within this share of the box's diagonal from where the parts meet.
REACH = 0.11


def segmented() -> moseg.Result:
    """The sample horse, cut into parts about given centres, with its boundaries clipped."""
    shape = moseg.load(moseg.sample_path("horse"))
    problem = moseg.Problem(list(CENTERS), "narrow(leg*)")
    start = moseg.Centers(
        positions=np.array([center for center, _ in CENTERS.values()]),
        weights=np.array([weight for _, weight in CENTERS.values()]),
    )
    result = moseg.segment(
        shape,
        problem,
        start=start,
        optimizer="pattern_search(max_evaluations=1)",
        resolution="full",
    )
    return moseg.clip(result)


def around_boundary(result: moseg.Result) -> np.ndarray:
    """(F,) bool: the input faces near to where head and body meet."""
    shape, adjacency = result.shape, result.shape.adjacency
    head, body = (result.problem.labels.index(name) for name in BOUNDARY)
    rows = np.repeat(np.arange(shape.n_elements), np.diff(adjacency.indptr))
    meets = (result.labels[rows] == head) & (result.labels[adjacency.indices] == body)
    middle = shape.points[rows[meets]].mean(axis=0)
    apart = np.linalg.norm(shape.points - middle, axis=1)
    return apart < REACH * shape.frame.scale


def drawn(result: moseg.Result, faces: np.ndarray, title: str) -> Image.Image:
    """Some input faces, or their pieces where the result is clipped, seen from one side."""
    mesh, labels = result.surface
    if result.clipped is not None:
        faces = faces[result.clipped.source]
    piece = PolygonMesh.from_faces(mesh.vertices, mesh.triangles[faces[mesh.triangle_polygon]])
    two = [result.problem.labels.index(name) for name in BOUNDARY]
    part = (labels[faces] == two[1]).astype(int)
    # The first view is the outside of the surface.
    picture = render_picture(piece, part, BOUNDARY, title=title, size=HALF, up="y", views=["main"])
    return Image.open(io.BytesIO(picture))


def main() -> None:
    parser = argparse.ArgumentParser(description="Draw what --clip does.")
    parser.add_argument("--output", type=Path, default=DESTINATION)
    output = parser.parse_args().output
    smooth = segmented()
    faces = around_boundary(smooth)
    plain = replace(smooth, clipped=None)
    picture = Image.new("RGB", SIZE, "white")
    picture.paste(drawn(plain, faces, "without --clip: on mesh edges"), (0, 0))
    picture.paste(drawn(smooth, faces, "with --clip: on the bisector"), (SIZE[0] // 2, 0))
    picture.save(output)


if __name__ == "__main__":
    main()
