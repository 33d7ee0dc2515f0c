"""The samples that are shipped: sound meshes, complete labels, and made by the script."""

from __future__ import annotations

import importlib
import importlib.util
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import cKDTree

from moseg_core.errors import UsageError
from moseg_core.samples import SAMPLES, sample_labels_path, sample_path
from moseg_core.shape.shape import Shape

TOOLS = Path(__file__).resolve().parents[2] / "tools"
PARTS = {
    "bulldog": ["head", "body", "leg1", "leg2", "leg3", "leg4"],
    "dove": ["body", "wing1", "wing2", "tail"],
    "hammer": ["handle", "head"],
    "horse": ["head", "body", "leg1", "leg2", "leg3", "leg4"],
    "octopus": ["head", *(f"arm{i}" for i in range(1, 9))],
}
# Parts that are each other's image in the plane z = 0; all other parts are their own.
PAIRS = {
    "bulldog": [("leg1", "leg2"), ("leg3", "leg4")],
    "dove": [("wing1", "wing2")],
}
# Least and greatest share of the area, and of the sample's length (along x, model units).
SHARES = {
    "bulldog": {
        "head": (0.2, 0.35),
        "body": (0.25, 0.45),
        **{f"leg{i}": (0.06, 0.14) for i in (1, 2, 3, 4)},
    },
    "dove": {
        "body": (0.2, 0.4),
        "wing1": (0.25, 0.35),
        "wing2": (0.25, 0.35),
        "tail": (0.07, 0.15),
    },
    "hammer": {"handle": (0.5, 0.8), "head": (0.2, 0.5)},
    "horse": {
        "head": (0.15, 0.3),
        "body": (0.3, 0.55),
        **{f"leg{i}": (0.06, 0.14) for i in (1, 2, 3, 4)},
    },
    "octopus": {"head": (0.2, 0.4), **{f"arm{i}": (0.07, 0.1) for i in range(1, 9)}},
}
LENGTH = {
    "bulldog": (0.8, 0.95),
    "dove": (380.0, 430.0),
    "hammer": (300.0, 340.0),
    "horse": (2.2, 2.6),
    "octopus": (400.0, 500.0),
}


@dataclass(frozen=True)
class Sample:
    """A sample as read from its files, by code that is independent of moseg's readers."""

    header: str
    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.int64]
    labels: list[tuple[str, npt.NDArray[np.int64]]]

    @property
    def part(self) -> npt.NDArray[np.int64]:
        """Part number of each face, -1 where there is none."""
        result = np.full(len(self.faces), -1)
        for number, (_, faces) in enumerate(self.labels):
            result[faces - 1] = number
        return result


def read(mesh: Path, labels: Path) -> Sample:
    """Read the two files of a sample."""
    head, body = mesh.read_bytes().split(b"end_header\n", 1)
    header = head.decode("ascii")
    n_vertices = int(re.search(r"element vertex (\d+)", header)[1])
    n_faces = int(re.search(r"element face (\d+)", header)[1])
    assert len(body) == 12 * n_vertices + 13 * n_faces
    row = np.dtype([("count", "u1"), ("corners", "<i4", 3)])
    vertices = np.frombuffer(body, "<f4", 3 * n_vertices).reshape(-1, 3)
    faces = np.frombuffer(body, row, n_faces, 12 * n_vertices)
    assert (faces["count"] == 3).all()
    text = labels.read_text("ascii")
    assert text.endswith("\n")
    lines = text.splitlines()
    named = [
        (n, np.array(f.split(), np.int64)) for n, f in zip(lines[::2], lines[1::2], strict=True)
    ]
    return Sample(header, vertices.astype(np.float64), faces["corners"].astype(np.int64), named)


@pytest.fixture(scope="module", params=SAMPLES)
def name(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture(scope="module")
def sample(name: str) -> Sample:
    return read(sample_path(name), sample_labels_path(name))


@pytest.fixture(scope="module")
def shape(sample: Sample) -> Shape:
    return Shape.from_mesh(sample.vertices, sample.faces)


def area_shares(sample: Sample, shape: Shape) -> dict[str, float]:
    sums = np.bincount(sample.part, shape.areas) / shape.area
    return {label: sums[number] for number, (label, _) in enumerate(sample.labels)}


def test_names_match_files() -> None:
    assert set(SAMPLES) == set(PARTS)
    folder = sample_path(SAMPLES[0]).parent
    assert sorted(p.stem for p in folder.glob("*.ply")) == sorted(SAMPLES)
    assert sorted(p.stem for p in folder.glob("*.txt")) == sorted(SAMPLES)


def test_unknown_name() -> None:
    with pytest.raises(UsageError, match="unknown sample 'horze'; did you mean 'horse'"):
        sample_path("horze")
    with pytest.raises(UsageError, match=r"unknown sample '\.\./x'; known: bulldog, dove, hammer"):
        sample_labels_path("../x")


def test_size_and_format(name: str, sample: Sample) -> None:
    assert sample.header.startswith("ply\nformat binary_little_endian 1.0\n")
    assert "property list uchar int vertex_indices\n" in sample.header
    assert 5_000 <= len(sample.faces) <= 15_000
    extent = np.ptp(sample.vertices, axis=0)
    low, high = LENGTH[name]
    assert low < extent[0] < high
    # It stands, or lies, on the ground, and only just.
    assert abs(sample.vertices[:, 1].min()) < 1e-3 * extent[0]


def test_closed_oriented_manifold(sample: Sample) -> None:
    faces, count = sample.faces, len(sample.vertices)
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    forward, backward = start * count + end, end * count + start
    assert len(np.unique(forward)) == len(forward)
    assert np.array_equal(np.sort(forward), np.sort(backward))
    # One fan of faces about each vertex: corner by corner across the edges that leave it.
    corner = np.arange(3 * len(faces))
    order = np.argsort(forward)
    twin = order[np.searchsorted(forward[order], backward)]
    after_twin = twin - twin % 3 + (twin % 3 + 1) % 3
    assert np.array_equal(start[after_twin], start)
    size = (len(corner), len(corner))
    fans = sparse.coo_array((np.ones(len(corner)), (corner, after_twin)), shape=size)
    assert csgraph.connected_components(fans, directed=False)[0] == count


def test_sphere_like(sample: Sample, shape: Shape) -> None:
    assert np.array_equal(np.unique(sample.faces), np.arange(len(sample.vertices)))
    assert len(np.unique(sample.vertices, axis=0)) == len(sample.vertices)
    edges = len(sample.faces) * 3 // 2
    assert len(sample.vertices) - edges + len(sample.faces) == 2
    assert shape.adjacency.components()[0] == 1
    assert shape.notes == ()


def test_outward_volume(sample: Sample, shape: Shape) -> None:
    a, b, c = (sample.vertices[sample.faces[:, k]] for k in range(3))
    signed = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    assert signed > 0.0
    assert shape.volume == pytest.approx(signed)
    box = np.prod(np.ptp(sample.vertices, axis=0))
    assert 0.02 * box < signed < 0.5 * box


def test_triangle_quality(sample: Sample) -> None:
    sides = np.roll(sample.vertices[sample.faces], -1, axis=1) - sample.vertices[sample.faces]
    length = np.linalg.norm(sides, axis=2)
    before = np.roll(sides, 1, axis=1)
    cosine = -(sides * before).sum(axis=2) / (length * np.roll(length, 1, axis=1))
    least = np.degrees(np.arccos(cosine)).min(axis=1)
    assert least.min() > 30.0
    assert np.percentile(least, 5) > 45.0
    assert length.max() < 4.0 * length.min()
    assert length.std() < 0.25 * length.mean()


def test_labels_complete(name: str, sample: Sample) -> None:
    assert [label for label, _ in sample.labels] == PARTS[name]
    listed = np.concatenate([faces for _, faces in sample.labels])
    assert np.array_equal(np.sort(listed), np.arange(1, len(sample.faces) + 1))


def test_parts_connected(sample: Sample, shape: Shape) -> None:
    for label, faces in sample.labels:
        assert shape.adjacency.components(faces - 1)[0] == 1, label


def test_area_shares(name: str, sample: Sample, shape: Shape) -> None:
    for label, share in area_shares(sample, shape).items():
        low, high = SHARES[name][label]
        assert low < share < high, label


def test_horse_is_not_symmetric() -> None:
    horse = read(sample_path("horse"), sample_labels_path("horse"))
    part = horse.part
    middle = horse.vertices[horse.faces].mean(axis=1)
    feet = [middle[part == PARTS["horse"].index(f"leg{i}")] for i in (1, 2, 3, 4)]
    x = [foot[foot[:, 1] < foot[:, 1].min() + 0.05, 0].mean() for foot in feet]
    assert x[2] < x[3] < x[1] < x[0]
    assert np.diff(sorted(x)).min() > 0.2
    # Odd legs are on the left, at negative z.
    assert [np.sign(foot[:, 2].mean()) for foot in feet] == [-1, 1, -1, 1]


def mirror_faces(sample: Sample) -> npt.NDArray[np.int64]:
    """(F,) the face that is each face's image in the plane z = 0; fails where there is none.

    Exactly: corners are compared bit by bit, and the image of a face runs round the other way.
    """
    bits = (sample.vertices * [1.0, 1.0, -1.0] + 0.0).tolist()
    at = {tuple(p): i for i, p in enumerate((sample.vertices + 0.0).tolist())}
    image = np.array([at[tuple(p)] for p in bits])
    number = {}
    for face, (a, b, c) in enumerate(sample.faces.tolist()):
        number |= {(a, b, c): face, (b, c, a): face, (c, a, b): face}
    return np.array([number[tuple(f)] for f in image[sample.faces][:, ::-1].tolist()])


@pytest.mark.parametrize("model", PAIRS)
def test_mirror_symmetric_mesh_and_labels(model: str) -> None:
    sample = read(sample_path(model), sample_labels_path(model))
    image = mirror_faces(sample)
    assert np.array_equal(image[image], np.arange(len(image)))
    # No face lies across the plane: what touches it does so with a corner or an edge.
    z = sample.vertices[sample.faces][:, :, 2]
    assert ((z <= 0.0).all(axis=1) | (z >= 0.0).all(axis=1)).all()
    swapped = {a: b for pair in PAIRS[model] for a, b in (pair, pair[::-1])}
    partner = np.array([PARTS[model].index(swapped.get(label, label)) for label in PARTS[model]])
    assert np.array_equal(sample.part[image], partner[sample.part])
    # The first of a pair is on the left, at negative z.
    for left, _ in PAIRS[model]:
        assert (z[sample.part == PARTS[model].index(left)] < 0.0).all()


def test_dove_wings_and_tail_are_flat() -> None:
    dove = read(sample_path("dove"), sample_labels_path("dove"))
    extent = {
        label: np.ptp(dove.vertices[np.unique(dove.faces[faces - 1])], axis=0)
        for label, faces in dove.labels
    }
    chord, height, span = extent["wing1"]
    assert span > 1.8 * chord > 3.0 * height
    length, height, width = extent["tail"]
    assert 0.7 < length / width < 1.4
    assert height < 0.25 * width
    length, height, width = extent["body"]
    assert length > 3.0 * max(height, width)


def arms_of_octopus() -> list[npt.NDArray[np.float64]]:
    """Vertices of each arm."""
    octopus = read(sample_path("octopus"), sample_labels_path("octopus"))
    return [octopus.vertices[np.unique(octopus.faces[f - 1])] for _, f in octopus.labels[1:]]


def test_octopus_arms_keep_apart() -> None:
    # They are 24 thick, and 10 thick at the tips; nearest are the roots, side by side.
    arms = arms_of_octopus()
    for i, arm in enumerate(arms):
        for other in arms[:i]:
            assert cKDTree(arm).query(other)[0].min() > 10.0


def test_octopus_arms_are_equally_long_and_pass_above_each_other() -> None:
    octopus = read(sample_path("octopus"), sample_labels_path("octopus"))
    edges = np.concatenate([octopus.faces[:, [0, 1]], octopus.faces[:, [1, 2]]])
    length = np.linalg.norm(octopus.vertices[edges[:, 0]] - octopus.vertices[edges[:, 1]], axis=1)
    graph = sparse.coo_array((length, edges.T), shape=(len(octopus.vertices),) * 2).tocsr()
    head = np.unique(octopus.faces[octopus.labels[0][1] - 1])
    away = csgraph.dijkstra(graph, directed=False, indices=head, min_only=True)
    reach, straight = [], []
    for _, faces in octopus.labels[1:]:
        vertices = np.unique(octopus.faces[faces - 1])
        tip = vertices[away[vertices].argmax()]
        reach.append(away[tip])
        straight.append(cKDTree(octopus.vertices[head]).query(octopus.vertices[tip])[0])
    assert max(reach) < 1.1 * min(reach)
    # Bent: as the crow flies, tips are nearer to the head, each by another amount.
    assert (np.array(straight) < 0.95 * np.array(reach)).all()
    assert min(straight) < 0.5 * max(reach)
    # Seen from above, some pairs cross; in space they do not touch.
    flat = [arm[:, [0, 2]] for arm in arms_of_octopus()]
    crossing = {
        (j + 1, i + 1)
        for i in range(8)
        for j in range(i)
        if cKDTree(flat[i]).query(flat[j])[0].min() < 2.0
    }
    assert crossing == {(3, 4), (6, 7), (1, 8)}


def test_labels_follow_from_construction(
    name: str, sample: Sample, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(TOOLS))
    solid = importlib.import_module(f"samples.{name}")
    length = np.ptp(sample.vertices[:, 0])
    # The field jumps a little where the nearest point on a bent curve does.
    assert np.abs(solid.whole(sample.vertices)).max() < 1e-4 * length
    middle = sample.vertices[sample.faces].mean(axis=1)
    distances = np.stack([part(middle) for part in solid.parts().values()], axis=1)
    assert list(solid.parts()) == PARTS[name]
    own = distances[np.arange(len(middle)), sample.part]
    # float32 coordinates may turn a tie, and nothing else.
    assert (own <= distances.min(axis=1) + 1e-6 * length).all()
    assert (own == distances.min(axis=1)).mean() > 0.999


@pytest.mark.slow
@pytest.mark.skipif(importlib.util.find_spec("skimage") is None, reason="needs scikit-image")
def test_script_makes_the_same_again(name: str, sample: Sample, tmp_path: Path) -> None:
    command = [sys.executable, str(TOOLS / "make_samples.py"), "--output", str(tmp_path)]
    subprocess.run([*command, "--only", name], check=True, capture_output=True)
    made = tmp_path / f"{name}.ply", tmp_path / f"{name}.txt"
    again = read(*made)
    versions = [re.search(r"comment (.*)\n", s.header)[1] for s in (sample, again)]
    if versions[0] == versions[1]:
        assert made[0].read_bytes() == sample_path(name).read_bytes()
        assert made[1].read_bytes() == sample_labels_path(name).read_bytes()
        return
    # Another version may march or round differently; the surface is the same.
    old, new = (Shape.from_mesh(s.vertices, s.faces) for s in (sample, again))
    assert len(again.faces) == pytest.approx(len(sample.faces), rel=0.05)
    assert new.volume == pytest.approx(old.volume, rel=0.005)
    assert area_shares(again, new) == pytest.approx(area_shares(sample, old), abs=0.01)
