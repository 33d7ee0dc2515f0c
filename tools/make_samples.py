"""Make the sample shapes that moseg ships, with the labels of their true parts.

Each sample is a smooth solid: the parts, each a union of swept ovals, blended so that the joints
have fillets (``samples/hammer.py``, ``samples/octopus.py`` and so on). Its surface is meshed
evenly (``samples/remesh.py``); where the solid is its own mirror image, so is the mesh. A face
belongs to the part whose own solid, taken without the others and without the fillet between parts,
has the smallest signed distance at the centroid of the face. So the labels follow from the
construction alone.

Run it from anywhere, with scikit-image installed::

    python tools/make_samples.py                      # writes to moseg_core/samples
    python tools/make_samples.py --output elsewhere

It writes ``<name>.ply`` (binary little-endian, float32) and ``<name>.txt`` (a line with a label,
then a line with its faces, numbered from 1). The same versions of NumPy and scikit-image, which
the PLY file names in a comment, give the same bytes.
"""

from __future__ import annotations

import argparse
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

import numpy as np
from samples import bulldog, dove, hammer, horse, octopus
from samples.fields import FloatArray, dot
from samples.remesh import IntArray, mesh_level_set

SAMPLES: dict[str, ModuleType] = {
    "bulldog": bulldog,
    "dove": dove,
    "hammer": hammer,
    "horse": horse,
    "octopus": octopus,
}
DESTINATION = Path(__file__).resolve().parent.parent / "moseg_core" / "samples"


def make(sample: ModuleType) -> tuple[FloatArray, IntArray, IntArray]:
    """Vertices (V, 3), faces (F, 3) and the part number (F,) of each face."""
    vertices, faces = mesh_level_set(
        sample.whole,
        sample.size,
        sample.LOW,
        sample.HIGH,
        grid=sample.GRID,
        symmetric=sample.SYMMETRIC,
    )
    middle = (vertices[faces[:, 0]] + vertices[faces[:, 1]] + vertices[faces[:, 2]]) / 3.0
    distances = np.stack([solid(middle) for solid in sample.parts().values()], axis=1)
    return vertices, faces, distances.argmin(axis=1).astype(np.int64)


def write_ply(path: Path, vertices: FloatArray, faces: IntArray) -> None:
    """Binary little-endian PLY with float32 vertices and uchar-counted int32 faces."""
    corners = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    corners["count"] = 3
    corners["corners"] = faces
    header = (
        "ply\n"
        "format binary_little_endian 1.0\n"
        f"comment numpy {version('numpy')} scikit-image {version('scikit-image')}\n"
        f"element vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\n"
        "property list uchar int vertex_indices\n"
        "end_header\n"
    )
    path.write_bytes(header.encode("ascii") + vertices.astype("<f4").tobytes() + corners.tobytes())


def write_labels(path: Path, names: list[str], part: IntArray) -> None:
    """Named labels: a line with the name, a line with the faces, numbered from 1."""
    lines = []
    for number, name in enumerate(names):
        lines += [name, " ".join(str(face + 1) for face in np.flatnonzero(part == number))]
    path.write_bytes(("\n".join(lines) + "\n").encode("ascii"))


def summary(vertices: FloatArray, faces: IntArray, part: IntArray, names: list[str]) -> str:
    """Say counts, volume, area shares and the quality of the triangles, for the eye."""
    corner = vertices[faces]
    sides = np.roll(corner, -1, axis=1) - corner
    length = np.sqrt(dot(sides, sides))
    normal = np.cross(sides[:, 0], sides[:, 1])
    area = np.sqrt(dot(normal, normal)) / 2.0
    volume = dot(corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum() / 6.0
    cosine = -dot(sides, np.roll(sides, 1, axis=1)) / (length * np.roll(length, 1, axis=1))
    least = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))).min(axis=1)
    at = "/".join(f"{x:.1f}" for x in np.percentile(least, [0, 1, 5, 50]))
    shares = ", ".join(
        f"{name} {area[part == i].sum() / area.sum():.1%}" for i, name in enumerate(names)
    )
    return (
        f"{len(faces)} faces, area {area.sum():.6g}, volume {volume:.6g}; {shares}; "
        f"least angle of a triangle (0/1/5/50%) {at} degrees; "
        f"edges {length.min():.3g} to {length.max():.3g}, mean {length.mean():.3g}, "
        f"deviation {length.std() / length.mean():.1%}"
    )


def main() -> None:
    """Write the samples."""
    parser = argparse.ArgumentParser(description="Make the sample shapes of moseg.")
    parser.add_argument("--output", type=Path, default=DESTINATION, help="where to write")
    parser.add_argument("--only", choices=sorted(SAMPLES), help="make just one of them")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    for name, sample in SAMPLES.items():
        if options.only not in (None, name):
            continue
        vertices, faces, part = make(sample)
        names = list(sample.parts())
        write_ply(options.output / f"{name}.ply", vertices, faces)
        write_labels(options.output / f"{name}.txt", names, part)
        print(f"{name}: {summary(vertices, faces, part, names)}")


if __name__ == "__main__":
    main()
