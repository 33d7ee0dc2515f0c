"""The same mesh by other programs, which take it apart without being told what to look for.

Each is called with its own defaults, by a script of a few lines in a process of its own, from an
interpreter that has it (``--peers``); moseg needs none of them. MeshLib's is ``segmentMesh``, which
joins faces across the flattest edges until as many segments are left as paper_horse has labels.
What is counted is what counts for moseg: from the start of the interpreter until the parts are
there, the reading of the mesh included (of numpy arrays, which is fast). All are run in turn, so
that what else the machine does falls on all alike.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import moseg_core as moseg
from speed_jobs.processes import MOSEG, Used, run, segmenting, used_records
from speed_jobs.records import Record, Request, quotients

_READ = "import sys, numpy; a = numpy.load(sys.argv[1]); v, f = a['vertices'], a['faces']\n"

_MINE = "moseg, paper_horse"

#: By the module that is imported the name, and a script that takes the mesh apart.
PEERS = {
    "coacd": (
        "CoACD",
        "import coacd; coacd.set_log_level('error')\n"
        "parts = coacd.run_coacd(coacd.Mesh(v, f.astype('int32')))\n",
    ),
    "vhacdx": ("V-HACD", "import vhacdx; parts = vhacdx.compute_vhacd(v, f.astype('uint32'))\n"),
    "meshlib": (
        "MeshLib",
        "from meshlib import mrmeshpy, mrmeshnumpy\n"
        "mesh = mrmeshnumpy.meshFromFacesVerts(f.astype('int32'), v)\n"
        "parts = mrmeshpy.segmentMesh(mesh, mrmeshpy.edgeDihedralAngleMetric(mesh))\n"
        "mrmeshpy.findSegmentBoundaries(mesh.topology, parts, 6)\n",
    ),
}


def peers(request: Request) -> Iterator[Record]:
    """The mesh by CoACD, V-HACD and MeshLib, in turn with the recipe paper_horse; ratios."""
    if request.peers is None:
        print("  left out: needs --peers PYTHON, an interpreter with coacd, vhacdx or meshlib")
        return
    geometry, data = moseg.load(request.mesh).geometry, request.folder / "mesh.npz"
    np.savez(data, vertices=geometry.vertices, faces=geometry.triangles)
    here: dict[str, list[str]] = {}
    for module, (title, script) in PEERS.items():
        version = _version(request.peers, module)
        if version is None:
            print(f"  left out: {title}, which {Path(request.peers).name} does not have")
        else:
            command = [request.peers, "-c", f"{_READ}{script}", str(data)]
            here[f"{title} {version}"] = command
    runs: dict[str, list[Used]] = {title: [] for title in (_MINE, *here)}
    for seed in range(request.repeat):
        mine = [MOSEG, *segmenting(request.mesh, "paper_horse", request, "--seed", str(seed))]
        for title, command in {_MINE: mine, **here}.items():
            runs[title].append(run(command, request))
    for title, used in runs.items():
        yield from used_records("peers", title, used)
    walls = {title: [each.wall for each in used] for title, used in runs.items()}
    for title in here:
        ratio = quotients(walls[_MINE], walls[title])
        yield Record(job="peers", what=f"moseg : {title}", unit=": 1", runs=ratio)


def _version(interpreter: str, module: str) -> str | None:
    """The version of a package as it is installed, None where it is not."""
    asked = f"import importlib.metadata as m; print(m.version({module!r}))"
    said = subprocess.run([interpreter, "-c", asked], capture_output=True, text=True, check=False)
    return said.stdout.strip() if said.returncode == 0 else None
