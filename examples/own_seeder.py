"""A seeder of your own
====================

A seeder of one's own: where the search begins (Sec. 5), tried without making a package.

A component is any object that answers the calls of its kind (``moseg_core.Seeder``). Installed ones
are found through entry points; a registry made by hand holds further ones, here a bundle ``mine``
with the seeder ``strung``: centres strung along the shape's long axis.

::

    python examples/own_seeder.py FOLDER

writes ``strung.png``, and ``strung.svg``: how the cost fell from there.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import moseg_core as moseg


class Strung:
    """Centres at the middles of equal shares of the area along the shape's long axis."""

    def __call__(
        self, evaluator: moseg.Evaluator, *, rng: np.random.Generator, report: moseg.Report
    ) -> moseg.Seeding:
        """Place one centre per label, at the element that is in the middle of each share."""
        shape = evaluator.shape
        whole = moseg.Segmentation.from_labels(shape, np.zeros(shape.n_elements, int), 1).parts[0]
        order = np.argsort(shape.points @ whole.axes[0], kind="stable")
        share = np.cumsum(shape.areas[order]) / shape.area
        n = evaluator.parameterization.n_parts
        middles = np.searchsorted(share, (np.arange(n) + 0.5) / n)
        return moseg.Seeding(centers=shape.points[order[middles]])


def with_mine() -> moseg.Registry:
    """Everything that is installed, and the bundle ``mine``."""
    spec = moseg.SeederSpec(name="strung", target=f"{__name__}:Strung")
    mine = moseg.Component("mine", "own_seeder.py", spec)
    bundle = moseg.Bundle("mine", "own_seeder.py", "0", __name__, components=(mine,))
    return moseg.Registry([*moseg.registry().bundles, bundle])


def main(folder: Path) -> None:
    """Segment the sample hammer from centres along it."""
    shape = moseg.load(moseg.sample_path("hammer"))
    problem = moseg.Problem(
        labels=["handle", "head"],
        minimize="3*narrow(handle) + perpendicular(handle, head) + convex_parts",
        registry=with_mine(),
    )
    result = moseg.segment(shape, problem, seeder="strung", seed=0, restarts=1, resolution=500)
    print(f"seeded by {result.method['seeder']}, cost {result.cost:.4f}")
    for suffix in ("png", "svg"):
        moseg.save(result, folder / f"strung.{suffix}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
