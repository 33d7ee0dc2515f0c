"""An objective of your own
========================

An objective of one's own is as short as its formula: a horse's legs stand upright (Sec. 3).

An objective is a function of a part, 0 where it is met. ``upright`` compares the part's long axis
with the file's y axis, which points up in the sample horse, and ``ahead`` looks along its x axis,
in which the horse walks. So a rigid motion changes them, and they declare only what does not. A
package makes an objective everybody's (``docs/authors/index.md``); here they are handed to the
problem.

::

    python examples/own_objective.py FOLDER

writes ``horse.png``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import moseg_core as moseg


@moseg.objective(range=(0, 1), invariant_to=("scale", "reflection", "order", "tessellation"))
def upright(part: moseg.Part) -> float:
    """Small where the long axis of a part is vertical: ``1 - |axis_1 . y|``."""
    return float(1 - abs(part.axes[0][1]))


@moseg.objective(range=(0, 1), invariant_to=("scale", "order", "tessellation"))
def ahead(part: moseg.Part) -> float:
    """Small where a part is in front: 0 at the greatest x of the shape, 1 at the least."""
    x = part.shape.points[:, 0]
    return float((x.max() - part.centroid[0]) / (x.max() - x.min()))


def main(folder: Path) -> None:
    """Segment the sample horse."""
    shape = moseg.load(moseg.sample_path("horse"))
    problem = moseg.Problem(
        labels=["head", "body", "leg1", "leg2", "leg3", "leg4"],
        minimize="5*upright(leg*) + 5*narrow(leg*) + ahead(head) + convex_parts",
        objectives={"upright": upright, "ahead": ahead},
    )
    search = "pattern_search(max_evaluations=1500)"  # enough to see what comes out
    result = moseg.segment(shape, problem, optimizer=search, seed=0, restarts=1, resolution=500)
    for label, part in result.parts.items():
        print(f"{label}: upright {upright(part):.2f}, ahead {ahead(part):.2f}")
    moseg.save(result, folder / "horse.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
