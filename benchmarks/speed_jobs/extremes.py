"""What is large in some other way than a mesh of many faces, and many small shapes in one batch.

Points, cells and labels each have a cost of their own: neighbours have to be found, cells take
memory, and starts, exchanges and terms grow with the number of labels. The shapes are made here, so
that anybody can measure the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

import moseg_core as moseg
from speed_jobs.growth import cut_hammer
from speed_jobs.processes import MOSEG, run, used_records
from speed_jobs.records import Record, Request

POINTS, CELLS, FACES, LABELS, SHAPES = 1_000_000, 200, 100_000, 30, 1_000
TWO = ("--labels", "a,b", "--minimize", "narrow(a) + convex_parts")

#: A cloud has no volume, so nothing can be said of convex parts, and its neighbours are found.
TWO_OF_A_CLOUD = (
    *("--labels", "a,b", "--minimize", "narrow(a) + short_boundaries"),
    *("--adjacency", "knn"),
)


def extremes(request: Request) -> Iterator[Record]:
    """A cloud of 1 M points, 200^3 full voxels, 30 labels on 100 k faces, 1,000 small shapes."""
    for what, words in (
        (f"{POINTS} points", [str(write_cloud(request.folder, POINTS)), *TWO_OF_A_CLOUD]),
        (f"{CELLS}^3 voxels", [str(write_block(request.folder, CELLS)), *TWO]),
        (
            f"{LABELS} labels on {FACES} faces",
            [str(cut_hammer(request.folder, FACES)), *many_labels(LABELS)],
        ),
    ):
        out = str(request.folder / "result.json")
        command = [MOSEG, "segment", *words, "--quiet", "-o", out]
        yield from used_records("extremes", what, [run(command, request)])
    folder = write_boxes(request.folder, SHAPES)
    few = ["--restarts", "1", "--optimizer", "pattern_search(max_evaluations=100)"]
    command = [MOSEG, "batch", str(folder / "*.ply"), *TWO, *few, "--quiet"]
    used = run([*command, "-o", str(request.folder / "batch")], request)
    yield from used_records("extremes", f"batch of {SHAPES} shapes", [used])
    rate = 60 * SHAPES / used.wall
    yield Record(job="extremes", what="batch: shapes a minute", unit="a minute", runs=(rate,))


def write_cloud(folder: Path, count: int) -> Path:
    """A cloud of points on the sample hammer, without normals or neighbours."""
    mesh = moseg.load(moseg.sample_path("hammer")).geometry
    rng = np.random.default_rng(0)
    corners = np.asarray(mesh.vertices)[np.asarray(mesh.triangles)]
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    chosen = corners[rng.choice(len(corners), size=count, p=areas / areas.sum())]
    weights = rng.dirichlet((1.0, 1.0, 1.0), size=count)
    path = folder / "cloud.npy"
    np.save(path, np.einsum("pk,pkd->pd", weights, chosen))
    return path


def write_block(folder: Path, side: int) -> Path:
    """A grid of voxels, all of them full."""
    path = folder / "block.npy"
    np.save(path, np.ones((side, side, side), dtype=bool))
    return path


def many_labels(count: int) -> list[str]:
    """Options that ask for so many parts."""
    names = ",".join(f"part{k}" for k in range(1, count + 1))
    return ["--labels", names, "--minimize", "convex_parts + narrow(*)"]


def write_boxes(folder: Path, count: int) -> Path:
    """Boxes of 320 to 576 triangles and of other sides each, in a folder."""
    made = folder / "boxes"
    made.mkdir()
    rng = np.random.default_rng(1)
    for k in range(count):
        size = (16, 8, 8) if k % 2 else (24, 12, 8)
        sides = rng.uniform(1.0, 3.0, size=3)
        (made / f"box{k:04}.ply").write_bytes(_box(np.array(size), sides))
    return made


def _box(size: np.ndarray, sides: np.ndarray) -> bytes:
    """A box as a PLY file; each side a grid of triangles."""
    vertices: list[np.ndarray] = []
    faces: list[np.ndarray] = []
    start = 0
    for axis in range(3):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        n, m = int(size[one]) // 2, int(size[other]) // 2
        u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1), indexing="ij")
        corner = np.arange((n + 1) * (m + 1)).reshape(n + 1, m + 1)
        quads = np.stack(
            [corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]], axis=-1
        ).reshape(-1, 4)
        triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        for at in (0.0, 1.0):
            points = np.empty((corner.size, 3))
            points[:, axis], points[:, one], points[:, other] = at, u.ravel(), v.ravel()
            vertices.append(points * sides)
            faces.append((triangles if at else triangles[:, ::-1]) + start)
            start += corner.size
    points, triangles = np.concatenate(vertices), np.concatenate(faces)
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
        "property double x\nproperty double y\nproperty double z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(triangles), dtype=[("n", "u1"), ("corners", "<i4", 3)])
    rows["n"], rows["corners"] = 3, triangles
    return head.encode() + points.astype("<f8").tobytes() + rows.tobytes()
