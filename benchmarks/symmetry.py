"""Does ``plane = "auto"`` find the plane that people's labels have? For docs/symmetry.md.

For every model of the Princeton Segmentation Benchmark (its folder as the argument, or in
``MOSEG_PSB``), one line: the plane found with its residual and share, the share of the area whose
label is the same at its mirror image, and the plane for which that share is greatest. The latter
is looked for on its own, over directions, offsets and then by a simplex, without the surface's
distances having a say; ``--quick`` leaves it out.

    python benchmarks/symmetry.py build/psb 381 385 389 393 397
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
from moseg_symmetry.motions import Reflection
from moseg_symmetry.plane_detection import detect_planes, half_sphere
from moseg_symmetry.surface import Surface, surface_of
from scipy.optimize import minimize

import moseg_core as moseg
from moseg_core.io import read_labels


class LabelShare:
    """Share of the area that a reflection maps onto its own label."""

    def __init__(self, shape: moseg.Shape, labels: np.ndarray, n: int) -> None:
        self.surface: Surface = surface_of(shape)
        self.points = self.surface.samples(n)
        # The triangles of no area are not in the surface; none of these models has any.
        self.labels = labels[shape.geometry.triangle_polygon]
        assert len(self.surface.triangles) == len(self.labels)
        self.own = self.labels[self.surface.nearest(self.points)[1]]

    def __call__(self, motion: Reflection) -> float:
        """The share, 0 to 1; 1 is best."""
        triangles = self.surface.nearest(motion.images(self.points)[0])[1]
        return float((self.labels[triangles] == self.own).mean())


def best_by_labels(rough: LabelShare, fine: LabelShare) -> Reflection:
    """The reflection that keeps most labels."""
    starts = [Reflection(n, h) for n in half_sphere(400) for h in np.linspace(-0.08, 0.08, 9)]
    starts.sort(key=lambda motion: -rough(motion))
    found = []
    for start in starts[:10]:
        simplex = np.vstack([np.zeros(3), np.diag([0.1, 0.1, 0.02])])
        ended = minimize(
            lambda step, start=start: -fine(start.changed(step)),
            np.zeros(3),
            method="Nelder-Mead",
            options={"initial_simplex": simplex, "maxiter": 120, "xatol": 1e-4, "fatol": 1e-5},
        )
        found.append((ended.fun, len(found), start.changed(ended.x)))
    return min(found)[2]


def main(arguments: list[str]) -> None:
    quick = "--quick" in arguments
    arguments = [argument for argument in arguments if argument != "--quick"]
    folder = Path(arguments[0] if arguments else os.environ["MOSEG_PSB"])
    ids = arguments[1:] or sorted((p.stem for p in (folder / "off").glob("*.off")), key=int)
    print("  id  residual  share  labels kept  most labels kept  angle between")
    for name in ids:
        shape = moseg.load(folder / "off" / f"{name}.off")
        truth = read_labels(folder / "labels" / f"{name}_labels.txt", shape.n_elements)
        fine = LabelShare(shape, np.asarray(truth.labels), 4000)
        found = detect_planes(shape)[0]
        offset = found.plane.heights(fine.surface.center) / -fine.surface.size
        kept = fine(Reflection(found.plane.normal, float(offset)))
        line = f"{name:>4}  {found.residual:8.2%}  {found.share:5.0%}  {kept:11.1%}"
        if not quick:
            best = best_by_labels(LabelShare(shape, np.asarray(truth.labels), 400), fine)
            cosine = min(1.0, abs(float(best.normal @ found.plane.normal)))
            line += f"  {fine(best):16.1%}  {np.degrees(np.arccos(cosine)):11.1f} °"
        print(line, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
