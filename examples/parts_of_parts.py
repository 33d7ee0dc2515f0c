"""Parts of parts
==============

A part is segmented in its turn by a problem of its own: several levels (Sec. 10, Fig. 8).

First handle and head of the hammer are told apart; then, in the head, the round face that strikes
from the peen, which ends in an edge. Labels of the result are paths, ``head/peen``. What is said of
a part in its own problem looks at nothing but that part.

::

    python examples/parts_of_parts.py FOLDER

writes ``levels.png`` and ``levels.glb``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import moseg_core as moseg


def main(folder: Path) -> None:
    """Segment the sample hammer on two levels."""
    shape = moseg.load(moseg.sample_path("hammer"))
    hammer = moseg.Problem(
        labels=["handle", "head"],
        minimize="3*narrow(handle) + perpendicular(handle, head) + convex_parts",
    )
    head = moseg.Problem(
        labels=["face", "peen"], minimize="compact(face) + flat(peen) + convex_parts"
    )
    levels = moseg.Hierarchy(hammer, {"head": head})
    result = moseg.segment_hierarchy(shape, levels, seed=0, restarts=1, resolution=500)

    for path, level in result.levels.items():
        print(f"level '{path}': {', '.join(level.problem.labels)}")
    for label, part in result.parts.items():
        print(f"{label}: {part.area / shape.area:.1%} of the surface")
    for suffix in ("png", "glb"):
        moseg.save(result, folder / f"levels.{suffix}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
