"""What the tests of all objectives share: meshes with known measures, parts made of them, motions.

The fixtures live for the session so that hypothesis may use them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from moseg_core import Part, Problem, Segmentation, Shape

Mesh = tuple[np.ndarray, Sequence[Sequence[int]] | np.ndarray]


def box(*size: float) -> Mesh:
    """Corners and the six rectangles of a box around the origin, seen from outside."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2.0
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners * np.array(size), quads


def rectangle(length: float, width: float) -> Mesh:
    corners = [[0, 0, 0], [length, 0, 0], [length, width, 0], [0, width, 0]]
    return np.array(corners, float), [[0, 1, 2, 3]]


def tube(radius: float, length: float, sections: int, *, caps: bool) -> Mesh:
    """A prism over a regular polygon whose corners lie on the circle."""
    angle = np.arange(sections) * 2 * np.pi / sections
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    low = np.c_[ring, np.full(sections, -length / 2)]
    high = np.c_[ring, np.full(sections, length / 2)]
    k = np.arange(sections)
    after = np.roll(k, -1)
    faces = np.stack([k, after, after + sections, k + sections], axis=1).tolist()
    middles = np.array([[0, 0, -length / 2], [0, 0, length / 2]])
    if caps:
        faces += np.stack([after, k, 0 * k + 2 * sections], axis=1).tolist()
        faces += np.stack(
            [k + sections, after + sections, 0 * k + 2 * sections + 1], axis=1
        ).tolist()
    return np.concatenate([low, high, middles]), faces


def disc(rings: int, sections: int) -> Mesh:
    """A flat disc of radius 1 in rings of quads; the innermost quads are pointed."""
    angle = np.arange(sections) * 2 * np.pi / sections
    radius, angle = (np.ravel(x) for x in np.meshgrid(np.arange(rings + 1) / rings, angle))
    faces = []
    for k in range(sections):
        this, that = k * (rings + 1), (k + 1) % sections * (rings + 1)
        faces += [[this + r, this + r + 1, that + r + 1, that + r] for r in range(rings)]
    return np.c_[radius * np.cos(angle), radius * np.sin(angle), 0 * angle], faces


def ball(rounds: int) -> Mesh:
    mesh = trimesh.creation.icosphere(subdivisions=rounds)
    return np.array(mesh.vertices), np.array(mesh.faces)


def moved(
    mesh: Mesh, *, turn: Rotation | None = None, scale: float = 1.0, shift: object = 0.0
) -> Mesh:
    vertices, faces = mesh
    turned = vertices if turn is None else vertices @ turn.as_matrix().T
    return turned * scale + np.asarray(shift), faces


def joined(meshes: Sequence[Mesh]) -> tuple[np.ndarray, list[list[int]], np.ndarray]:
    """Vertices and faces of all meshes, and for each face the number of its mesh."""
    faces, labels, offset = [], [], 0
    for number, (vertices, own) in enumerate(meshes):
        faces += [[int(v) + offset for v in face] for face in own]
        labels += [number] * len(own)
        offset += len(vertices)
    return np.concatenate([vertices for vertices, _ in meshes]), faces, np.array(labels)


def segmented(meshes: Sequence[Mesh]) -> Segmentation:
    """A shape that consists of the meshes, each a part of its own."""
    vertices, faces, labels = joined(meshes)
    return Segmentation.from_labels(Shape.from_mesh(vertices, faces), labels, len(meshes))


def part(mesh: Mesh) -> Part:
    """A whole mesh as one part."""
    return segmented([mesh]).parts[0]


@dataclass(frozen=True)
class Labelled:
    """A triangle mesh in three parts that is nothing in particular."""

    vertices: np.ndarray
    faces: np.ndarray
    labels: np.ndarray

    @property
    def diagonal(self) -> float:
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    def segmentation(self) -> Segmentation:
        shape = Shape.from_mesh(self.vertices, self.faces)
        return Segmentation.from_labels(shape, self.labels, 3)

    def in_general_position(self) -> bool:
        """Whether no part is empty and principal axes are far from arbitrary."""
        whole = part((self.vertices, self.faces))
        parts = [whole, *self.segmentation().parts]
        if any(p.n_elements < 4 for p in parts):
            return False
        values = np.array([p.scales for p in parts]) ** 2
        gaps = -np.diff(values, axis=1) / values[:, :1]
        return bool((gaps > 1e-3).all() and (values[:, 2] > 1e-4 * values[0, 0]).all())

    def values(self, expression: str) -> np.ndarray:
        """What each call of each term comes to."""
        shape = Shape.from_mesh(self.vertices, self.faces)
        found = Problem(["a", "b", "c"], expression).evaluate(shape, self.labels)
        assert found.empty == ()
        return np.array([call.value for term in found.terms for call in term.calls])


def generic(seed: int) -> Labelled:
    """A closed, bent and dented ellipsoid, cut into three cells."""
    rng = np.random.default_rng(seed)
    vertices, faces = ball(2)
    vertices = vertices * [1.0, 0.5 + 0.2 * rng.random(), 0.3 + 0.15 * rng.random()]
    for _ in range(3):
        frequency, phase, push = rng.normal(size=(3, 3))
        vertices = vertices + 0.08 * np.sin(3 * vertices @ frequency + phase[0])[:, None] * push
    centers = vertices[rng.choice(len(vertices), 3, replace=False)]
    middles = vertices[faces].mean(axis=1)
    labels = np.linalg.norm(middles[:, None] - centers, axis=2).argmin(axis=1)
    return Labelled(vertices, faces, labels)


def quartered(original: Labelled) -> Labelled:
    """The same surface, each triangle cut in four through the middles of its sides."""
    corners = original.vertices[original.faces]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    pieces = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    vertices = np.concatenate([np.stack(piece, axis=1).reshape(-1, 3) for piece in pieces])
    return Labelled(vertices, np.arange(len(vertices)).reshape(-1, 3), np.tile(original.labels, 4))


def punctured(original: Labelled, seed: int) -> Labelled:
    """The same surface, each triangle cut in three at a point inside it."""
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet([3.0, 3.0, 3.0], size=len(original.faces))
    inside = np.einsum("fi,fij->fj", weights, original.vertices[original.faces])
    top = len(original.vertices) + np.arange(len(original.faces))
    a, b, c = original.faces.T
    faces = np.concatenate([np.stack(f, axis=1) for f in ((a, b, top), (b, c, top), (c, a, top))])
    return Labelled(np.concatenate([original.vertices, inside]), faces, np.tile(original.labels, 3))


@dataclass(frozen=True)
class Motion:
    """A similarity, a mirror image and another order of the elements."""

    turn: Rotation
    scale: float
    shift: np.ndarray
    mirrored: bool
    seed: int

    def __call__(self, original: Labelled) -> Labelled:
        vertices, faces = original.vertices, original.faces
        if self.mirrored:
            vertices, faces = vertices * [1, 1, -1], faces[:, ::-1]
        vertices = self.turn.apply(vertices + self.shift * original.diagonal) * self.scale
        order = np.random.default_rng(self.seed).permutation(len(faces))
        return Labelled(vertices, faces[order], original.labels[order])


def squared_distances(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(k,): squared distance of points to the nearest of (t, 3, 3) triangles, by the book.

    The nearest point of a triangle is the foot of the perpendicular where that lies inside, and
    on one of the three sides where it does not.
    """
    least = np.full(len(points), np.inf)
    for a, b, c in corners:
        for start, stop in ((a, b), (b, c), (c, a)):
            side = stop - start
            along = np.clip((points - start) @ side / (side @ side), 0.0, 1.0)
            least = np.minimum(least, ((points - start - along[:, None] * side) ** 2).sum(axis=1))
        normal = np.cross(b - a, c - a)
        if not normal.any():
            continue
        height = (points - a) @ normal / (normal @ normal)
        foot = points - height[:, None] * normal
        inside = np.ones(len(points), bool)
        for start, stop in ((a, b), (b, c), (c, a)):
            inside &= np.cross(stop - start, foot - start) @ normal >= 0.0
        least[inside] = np.minimum(least, ((foot - points) ** 2).sum(axis=1))[inside]
    return least


def dense_samples(corners: np.ndarray, rounds: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights: the middles of the sides after quartering each triangle repeatedly."""
    for _ in range(rounds):
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        pieces = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        corners = np.concatenate([np.stack(piece, axis=1) for piece in pieces])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middles = (corners + np.roll(corners, 1, axis=1)) / 2
    return middles.reshape(-1, 3), np.repeat(np.linalg.norm(normals, axis=1) / 6.0, 3)


@st.composite
def motions(draw: st.DrawFn) -> Motion:
    """Scales from 1e-4 to 1e4, and up to a thousand diagonals away."""
    seed = draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    away = rng.normal(size=3)
    return Motion(
        turn=Rotation.random(rng=rng),
        scale=10.0 ** draw(st.floats(-4, 4)),
        shift=draw(st.sampled_from([0.0, 1.0, 1e3])) * away / np.linalg.norm(away),
        mirrored=draw(st.booleans()),
        seed=seed,
    )


@pytest.fixture(scope="session")
def make() -> SimpleNamespace:
    """The functions above, and strategies for shapes in general position and for motions."""
    shapes = st.integers(0, 10_000).map(generic).filter(Labelled.in_general_position)
    return SimpleNamespace(
        box=box,
        rectangle=rectangle,
        tube=tube,
        disc=disc,
        ball=ball,
        moved=moved,
        part=part,
        segmented=segmented,
        quartered=quartered,
        punctured=punctured,
        squared_distances=squared_distances,
        dense_samples=dense_samples,
        shapes=shapes,
        motions=motions(),
    )


@pytest.fixture(scope="session")
def nasty() -> dict[str, Part]:
    """Parts that a search may come by, none of them empty."""
    vertices, faces = ball(3)
    vertices = vertices * [1.0, 0.8, 0.6] + 5.0
    labels = np.zeros(len(faces), int)
    labels[0] = 1
    labels[[10, 700]] = 2
    labels[vertices[faces].mean(axis=1)[:, 2] > 5.4] = 3
    cells = Segmentation.from_labels(Shape.from_mesh(vertices, faces), labels, 4).parts
    tilt = Rotation.from_rotvec([0.3, 0.2, 0.1])
    brick = box(3, 2, 1)
    sides = Shape.from_mesh(*moved(brick, turn=tilt))
    side = Segmentation.from_labels(sides, [1, 0, 0, 0, 0, 0], 2).parts[1]
    specks = [moved(box(1, 1, 1), scale=1e-6, shift=at) for at in ([0, 0, 0], [1, 0, 0], [0, 1, 1])]
    sliver: Mesh = np.array([[0, 0, 0], [1, 0, 0], [0.3, 1e-9, 0]]), [[0, 1, 2]]
    corners = [[0, 0, 0], [4, 0, 0], [1, 1, 0], [2, 0, 1], [2, 0, 0], [9, 9, 9]]
    pleated: Mesh = np.array(corners, float), [[0, 1, 2], [0, 3, 1], [0, 4, 1], [2, 2, 2]]
    return {
        "all but a little": cells[0],
        "one triangle": cells[1],
        "two far triangles": cells[2],
        "open cap": cells[3],
        "everything": part((vertices, faces)),
        "three distant specks": part(joined(specks)[:2]),
        "one side of a box": side,
        "plate": part(moved(box(1, 1, 1e-9), turn=tilt)),
        "needle": part(moved(box(1, 1e-7, 1e-7), turn=tilt)),
        "sliver": part(moved(sliver, turn=tilt)),
        "sliver beside a box": part(joined([moved(brick, turn=tilt), sliver])[:2]),
        "faces of no area": part(moved(pleated, turn=tilt)),
    }
