"""A symmetric animal
==================

What is symmetric is cut symmetrically: constraints on the centres (Sec. 8).

``mirror(wing2, wing1)`` makes the centre of one wing the mirror image of the other's, ``on_plane``
keeps that of the body on the plane of symmetry, which is found on the shape. The search then has 7
numbers to find instead of 12, and cannot give one wing another shape than the other.

::

    python examples/symmetric_animal.py FOLDER

writes ``dove.png`` and ``dove.html``, a page to turn it in.
"""

from __future__ import annotations

import sys
from pathlib import Path

import moseg_core as moseg


def main(folder: Path) -> None:
    """Segment the sample dove."""
    shape = moseg.load(moseg.sample_path("dove"))
    problem = moseg.Problem(
        labels=["body", "wing1", "wing2"],
        minimize="narrow(body) + flat(wing*) + convex_parts",
        constraints=["on_plane(body)", "mirror(wing2, wing1)"],
    )
    result = moseg.segment(shape, problem, seed=0, restarts=1, resolution=500)

    searched, described = result.dimension
    print(f"{searched} numbers were searched for, which give the {described} of all centres")
    for label, part in result.parts.items():
        print(f"{label}: {part.area / shape.area:.1%} of the surface")
    for suffix in ("png", "html"):
        moseg.save(result, folder / f"dove.{suffix}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
