"""A hammer
========

A hammer is a narrow handle and a head set across it: the paper's first example (Fig. 1).

The cost is a weighted sum of three things that one knows of a hammer. The search finds the two
parts that make it least; ``result.evaluation`` says what each of the three still costs.

::

    python examples/segment_hammer.py FOLDER

writes ``hammer.png`` (a picture), ``hammer.html`` (a page to turn it in), ``hammer.glb`` (a node
for each part) and ``hammer.json``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import moseg_core as moseg


def main(folder: Path) -> None:
    """Segment the sample hammer."""
    shape = moseg.load(moseg.sample_path("hammer"))
    problem = moseg.Problem(
        labels=["handle", "head"],
        minimize="3*narrow(handle) + perpendicular(handle, head) + convex_parts",
    )
    result = moseg.segment(shape, problem, seed=0, restarts=2, resolution=500)

    for term in result.evaluation.terms:
        print(f"{term.weighted:9.6f}  {term.weight:g} * {term.text}")
    for label, part in result.parts.items():
        print(f"{label}: {part.area / shape.area:.0%} of the surface")
    for suffix in ("png", "html", "glb", "json"):
        moseg.save(result, folder / f"hammer.{suffix}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
