"""How time and memory grow with the mesh: the same surface of 10 000 to 1 000 000 faces.

The sample hammer with its triangles cut up. So the surface, and what there is to find on it, stays
the same to rounding, and only the number of elements grows. It is also the easy case: on a finer
mesh of a rounder surface hulls have more corners.
"""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import moseg_core as moseg
from speed_jobs.processes import (
    HERE,
    MOSEG,
    run,
    run_by_stage,
    segmenting,
    stage_records,
    used_records,
)
from speed_jobs.records import Record, Request, quotients
from speed_jobs.subdivision import cut_up, write_mesh

FACES = (10_000, 100_000, 1_000_000)
#: In the order of a run, and which of moseg's stages each is the sum of.
STAGES = {
    "read": ("read",),
    "fields": ("fields",),
    "super-elements": ("super-elements",),
    "search": ("seeds and labels", "search", "exchange of labels"),
    "polish": ("polish",),
    "write": ("write",),
    "start and rest": ("rest", "refine", "clip"),
}
#: Which of them are compared between the largest and the smallest mesh.
RATIOS = {
    "search": ("search",),
    "search and polish": ("search", "polish"),
    "super-elements, search and polish": ("super-elements", "search", "polish"),
}


def growth(request: Request, faces: tuple[int, ...] = FACES) -> Iterator[Record]:
    """The recipe hammer on the sample hammer cut up: seconds by stage, memory; ratios."""
    sums: dict[int, list[dict[str, float]]] = {}
    for wanted in faces:
        path = cut_hammer(request.folder, wanted)
        command = segmenting(path, "hammer", request)
        runs = [run([MOSEG, *command], request) for _ in range(request.repeat)]
        by_stage = [run_by_stage([command], request) for _ in range(request.repeat)]
        path.unlink()
        title = path.stem
        yield Record(job="growth", what=f"{title}: faces", unit="faces", runs=(float(title),))
        yield from used_records("growth", title, runs)
        stages = [
            {name: sum(found.get(stage, 0.0) for stage in of) for name, of in STAGES.items()}
            for _, found in by_stage
        ]
        yield from stage_records("growth", f"{title}, one process", stages)
        memory = tuple(used.memory for used, _ in by_stage)
        yield Record(job="growth", what=f"{title}, one process: memory", unit="GB", runs=memory)
        sums[wanted] = stages
    largest, smallest = sums[faces[-1]], sums[faces[0]]
    for what, names in RATIOS.items():
        over, under = (
            tuple(sum(stages[name] for name in names) for stages in runs)
            for runs in (largest, smallest)
        )
        title = f"{what}, {faces[-1]} : {faces[0]} faces"
        yield Record(job="growth", what=title, unit=": 1", runs=quotients(over, under))


def cut_hammer(folder: Path, faces: int) -> Path:
    """Write the sample hammer with about so many faces; the file is called by their number.

    In a process of its own: the memory that it takes is not given back.
    """
    program = [sys.executable, "-c", _CUT, str(HERE.parent), str(folder), str(faces)]
    said = subprocess.run(program, check=True, stdout=subprocess.PIPE, text=True)
    return Path(said.stdout.strip())


_CUT = """\
import sys
sys.path.insert(0, sys.argv[1])
from speed_jobs.growth import write_cut_hammer
print(write_cut_hammer(sys.argv[2], int(sys.argv[3])))
"""


def write_cut_hammer(folder: str, faces: int) -> Path:
    """What :func:`cut_hammer` has the other process do."""
    shape = moseg.load(moseg.sample_path("hammer"))
    fine = cut_up(shape, max(1, round(math.sqrt(faces / shape.n_elements))))
    path = Path(folder) / f"{fine.n_elements}.ply"
    write_mesh(fine, path)
    return path
