"""Small shapes for the tests: functions that return ``(vertices, faces)``.

Vertices are an (V, 3) array, faces a list of tuples, so that quads and larger polygons can stand
beside triangles. Closed shapes are oriented outward.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

import numpy as np
import trimesh

Face = tuple[int, ...]
Mesh = tuple[np.ndarray, list[Face]]


def rectangle(width: float = 3.0, height: float = 1.0, nx: int = 1, ny: int = 1) -> Mesh:
    """A rectangle in the xy-plane with a corner at the origin, of nx by ny quads."""
    x, y = np.linspace(0.0, width, nx + 1), np.linspace(0.0, height, ny + 1)
    vertices = np.array([(a, b, 0.0) for b in y for a in x])
    faces = [
        (s, s + 1, s + nx + 2, s + nx + 1)
        for s in (j * (nx + 1) + i for j in range(ny) for i in range(nx))
    ]
    return vertices, faces


def strip(n: int = 8, width: float = 1.0) -> Mesh:
    """A row of n quads along x, each of length 1."""
    return rectangle(float(n), width, n, 1)


def solid(cells: Iterable[Sequence[int]]) -> Mesh:
    """The surface, in unit quads, of a union of unit cubes given by their least corners."""
    filled = {tuple(int(x) for x in cell) for cell in cells}
    corners: dict[tuple[int, ...], int] = {}
    faces: list[Face] = []
    for cell in sorted(filled):
        for axis, side in itertools.product(range(3), (0, 1)):
            beyond = list(cell)
            beyond[axis] += 2 * side - 1
            if tuple(beyond) in filled:
                continue
            u, v = (axis + 1) % 3, (axis + 2) % 3
            ring = []
            for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = list(cell)
                corner[axis] += side
                corner[u] += du
                corner[v] += dv
                ring.append(corners.setdefault(tuple(corner), len(corners)))
            faces.append(tuple(ring if side else ring[::-1]))
    return np.array(list(corners), dtype=np.float64), faces


def box(nx: int = 1, ny: int = 1, nz: int = 1) -> Mesh:
    """A closed box of unit quads."""
    return solid(itertools.product(range(nx), range(ny), range(nz)))


def cube() -> Mesh:
    """The unit cube, six quads."""
    return box()


def tee(stem: int = 6, bar: int = 5) -> Mesh:
    """A T of unit cubes: a stem along z and a bar across it along x, on top."""
    middle = bar // 2
    return solid([(middle, 0, z) for z in range(stem)] + [(x, 0, stem) for x in range(bar)])


def two_boxes(apart: int = 3) -> Mesh:
    """Two closed boxes that do not touch."""
    return solid([(0, 0, 0), (1, 0, 0), (1 + apart, 0, 0), (1 + apart, 0, 1)])


def cube_without_lid() -> Mesh:
    """The unit cube without one of its faces: an open surface."""
    vertices, faces = cube()
    return vertices, faces[:-1]


def annulus(n: int = 12) -> Mesh:
    """A flat ring of n quads, a surface with a hole."""
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)])
    faces = [(k, n + k, n + (k + 1) % n, (k + 1) % n) for k in range(n)]
    return np.concatenate([ring, 2.0 * ring]), faces


def disc(n: int = 8) -> Mesh:
    """An open disc: a fan of n triangles."""
    angle = 2 * np.pi * np.arange(n) / n
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)])
    return np.concatenate([np.zeros((1, 3)), rim]), [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]


def book(pages: int = 3) -> Mesh:
    """Triangles that all share one edge: not a manifold."""
    angle = 2 * np.pi * np.arange(pages) / pages
    tips = np.column_stack([np.cos(angle), np.sin(angle), np.full(pages, 0.5)])
    return np.concatenate([[[0.0, 0, 0], [0, 0, 1]], tips]), [(0, 1, 2 + k) for k in range(pages)]


def sphere(subdivisions: int = 1, radius: float = 1.0) -> Mesh:
    """A subdivided icosahedron."""
    ball = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    return np.array(ball.vertices), [tuple(face) for face in ball.faces.tolist()]


def tube(n: int = 7, radius: float = 1.0, length: float = 4.0, rings: int = 1) -> Mesh:
    """The side of a regular prism around the z-axis, open at both ends, in quads."""
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    vertices = np.concatenate(
        [np.column_stack([ring, np.full(n, z)]) for z in np.linspace(0.0, length, rings + 1)]
    )
    faces = [
        (r * n + k, r * n + (k + 1) % n, (r + 1) * n + (k + 1) % n, (r + 1) * n + k)
        for r in range(rings)
        for k in range(n)
    ]
    return vertices, faces


def prism(n: int = 6, radius: float = 1.0, length: float = 2.0) -> Mesh:
    """A closed regular prism: n quads and two polygons of n corners."""
    vertices, faces = tube(n, radius, length)
    return vertices, [*faces, tuple(reversed(range(n))), tuple(range(n, 2 * n))]


def bent_capsule(sections: int = 16, around: int = 10) -> Mesh:
    """A closed tube with round ends that turns by a right angle half-way; quads and triangles."""
    arc = np.linspace(0.0, 1.0, sections)
    middle = np.column_stack([4 * np.minimum(arc, 0.5), 0 * arc, 4 * np.maximum(arc - 0.5, 0.0)])
    swell = 0.4 * np.sqrt(1.0 - (2 * arc - 1.0) ** 6 * 0.9)
    vertices = [np.array([[-0.2, 0.0, 0.0]])]
    angle = 2 * np.pi * np.arange(around) / around
    for at, t, r in zip(middle, arc, swell, strict=True):
        turn = np.pi / 2 * np.clip((t - 0.4) / 0.2, 0.0, 1.0)
        u = np.array([-np.sin(turn), 0.0, np.cos(turn)])
        v = np.array([0.0, 1.0, 0.0])
        vertices.append(at + r * (np.cos(angle)[:, None] * v + np.sin(angle)[:, None] * u))
    vertices.append(np.array([middle[-1] + [0.0, 0.0, 0.2]]))
    tip = 1 + sections * around
    faces: list[Face] = [(0, 1 + (k + 1) % around, 1 + k) for k in range(around)]
    for s in range(sections - 1):
        low, high = 1 + s * around, 1 + (s + 1) * around
        for k in range(around):
            after = (k + 1) % around
            faces.append((low + k, low + after, high + after, high + k))
    last = 1 + (sections - 1) * around
    faces += [(last + k, last + (k + 1) % around, tip) for k in range(around)]
    return np.concatenate(vertices), faces


def soup(seed: int, n: int) -> Mesh:
    """Triangles at random places that share nothing."""
    rng = np.random.default_rng(seed)
    middles = rng.uniform(-1.0, 1.0, (n, 1, 3))
    vertices = (middles + rng.uniform(-0.2, 0.2, (n, 3, 3))).reshape(-1, 3)
    return vertices, [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(n)]


def jitter(mesh: Mesh, seed: int, amount: float = 0.05) -> Mesh:
    """The mesh with every vertex moved a little, so that no two distances are equal."""
    vertices, faces = mesh
    rng = np.random.default_rng(seed)
    return vertices + rng.uniform(-amount, amount, vertices.shape), faces


def joined(*meshes: Mesh) -> Mesh:
    """Several meshes in one, without joining anything."""
    vertices: list[np.ndarray] = []
    faces: list[Face] = []
    for points, polygons in meshes:
        start = sum(map(len, vertices))
        vertices.append(points)
        faces += [tuple(start + v for v in face) for face in polygons]
    return np.concatenate(vertices), faces


def fan(mesh: Mesh) -> Mesh:
    """The mesh with every polygon cut into triangles from its first corner."""
    vertices, faces = mesh
    return vertices, [
        (face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)
    ]


def subdivided(mesh: Mesh, seed: int) -> Mesh:
    """The same surface in other triangles: each cut at a random point inside of it."""
    vertices, faces = fan(mesh)
    rng = np.random.default_rng(seed)
    share = rng.dirichlet([2.0, 2.0, 2.0], len(faces))
    inner = np.einsum("fk,fkd->fd", share, vertices[np.array(faces)])
    cut = [
        (a, b, len(vertices) + f)
        for f, (i, j, k) in enumerate(faces)
        for a, b in ((i, j), (j, k), (k, i))
    ]
    return np.concatenate([vertices, inner]), cut


def moved(mesh: Mesh, rotation: np.ndarray, scale: float, shift: Sequence[float]) -> Mesh:
    """The mesh rotated, scaled and shifted, in this order."""
    vertices, faces = mesh
    return scale * (vertices @ rotation.T) + np.asarray(shift), faces


def rotation(seed: int) -> np.ndarray:
    """A random proper rotation matrix."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.sign(np.linalg.det(q))
