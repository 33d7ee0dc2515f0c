"""A point cloud
=============

Points without faces can be segmented too: an element is then a point.

A scan says where the surface is and not what belongs together. Areas are estimated from distances
between points. Neighbours are found with ``adjacency="knn"``, and the volume of the convex hull
stands for that of the shape with ``with_volume("hull")``, because somebody asks for it: without, an
objective that needs them is refused with what to do.

::

    python examples/point_cloud.py FOLDER

writes ``points.png`` and ``points.ply``, a coloured cloud with labels.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import moseg_core as moseg


def scanned(mesh: moseg.Shape, count: int) -> moseg.Shape:
    """A cloud of some of the centroids of a mesh's faces, as a scanner might see it."""
    rng = np.random.default_rng(0)
    chosen = rng.choice(mesh.n_elements, count, replace=False)
    cloud = moseg.Shape.from_points(mesh.points[chosen], adjacency="knn", name="scan")
    return cloud.with_volume("hull")


def main(folder: Path) -> None:
    """Segment points of the sample hammer."""
    cloud = scanned(moseg.load(moseg.sample_path("hammer")), 3000)
    problem = moseg.Problem(
        labels=["handle", "head"],
        minimize="3*narrow(handle) + perpendicular(handle, head) + convex_parts",
    )
    result = moseg.segment(cloud, problem, seed=0, restarts=2, resolution=500)
    for label, part in result.parts.items():
        print(f"{label}: {len(part.elements)} points")
    for suffix in ("png", "ply"):
        moseg.save(result, folder / f"points.{suffix}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
