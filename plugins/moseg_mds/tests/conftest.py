"""Surfaces whose geodesic distances are known in closed form, and bends that do not change them."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from moseg_core import Shape

Mesh = tuple[np.ndarray, np.ndarray]


def ball(rounds: int) -> Mesh:
    mesh = trimesh.creation.icosphere(subdivisions=rounds)
    return np.array(mesh.vertices), np.array(mesh.faces, np.int64)


def grid(columns: int, rows: int) -> np.ndarray:
    """Triangles of a grid of vertices, numbered row by row, with diagonals of both directions."""
    faces = []
    for r in range(rows - 1):
        for c in range(columns - 1):
            a = r * columns + c
            b, d = a + 1, a + columns
            e = d + 1
            faces += [[a, b, e], [a, e, d]] if (r + c) % 2 else [[a, b, d], [b, e, d]]
    return np.array(faces, np.int64)


def strip(columns: int, rows: int, length: float = 4.0, width: float = 1.0) -> Mesh:
    """A flat strip."""
    x, y = np.meshgrid(np.linspace(0, length, columns), np.linspace(0, width, rows))
    return np.c_[x.ravel(), y.ravel(), np.zeros(x.size)], grid(columns, rows)


def rolled(mesh: Mesh, radius: float) -> Mesh:
    """The same, bent around a cylinder: no distance along the surface changes."""
    (x, y, z), faces = mesh[0].T, mesh[1]
    angle = x / radius
    return np.c_[(radius + z) * np.sin(angle), y, (radius + z) * np.cos(angle)], faces


def cylinder(sections: int, rows: int, radius: float = 1.0, height: float = 2.0) -> Mesh:
    """An open cylinder; vertex ``r * sections + s`` is at angle ``2 pi s / sections``."""
    angle = 2 * np.pi * np.arange(sections) / sections
    z = np.linspace(0, height, rows)
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    vertices = np.c_[np.tile(ring, (rows, 1)), np.repeat(z, sections)]
    faces = grid(sections + 1, rows)
    row, column = np.divmod(faces, sections + 1)
    return vertices, row * sections + column % sections


def cube(cuts: int) -> Mesh:
    """The surface of a unit cube in a grid of triangles."""
    mesh = trimesh.creation.box()
    for _ in range(cuts):
        mesh = mesh.subdivide()
    return np.array(mesh.vertices), np.array(mesh.faces, np.int64)


def worm(bend: Callable[[np.ndarray], np.ndarray], thickness: float = 0.006) -> Mesh:
    """A closed tube of length 1 around a plane curve with the direction ``bend(t)``, t in 0..1.

    Its skin is stretched and squeezed where it is bent, by the curvature times its thickness.
    """
    sections, rings = 8, 40
    t = np.linspace(0, 1, rings)
    direction = bend(t)
    tangent = np.stack([np.cos(direction), np.sin(direction), 0 * t], axis=1)
    steps = (tangent[1:] + tangent[:-1]) / 2 * np.diff(t)[:, None]
    middle = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    normal = np.stack([-np.sin(direction), np.cos(direction), 0 * t], axis=1)
    radius = thickness * np.sqrt(np.clip(1 - (2 * t - 1) ** 8, 0.05, None)) * (1.2 - 0.6 * t)
    angle = 2 * np.pi * np.arange(sections) / sections
    side = np.cos(angle)[None, :, None] * normal[:, None] + np.sin(angle)[None, :, None] * [0, 0, 1]
    tube = (middle[:, None] + radius[:, None, None] * side).reshape(-1, 3)
    ends = middle[[0, -1]] + tangent[[0, -1]] * thickness * [[-0.3], [0.3]]
    row, column = np.divmod(grid(sections + 1, rings), sections + 1)
    faces = (row * sections + column % sections)[:, ::-1]
    k = np.arange(sections)
    first, last = len(tube), len(tube) + 1
    after, top = (k + 1) % sections, (rings - 1) * sections
    caps = [np.c_[k, after, 0 * k + first][:, ::-1], np.c_[top + k, top + after, 0 * k + last]]
    faces = np.concatenate([faces, caps[0][:, ::-1], caps[1][:, ::-1]])
    mesh = trimesh.Trimesh(np.concatenate([tube, ends]), faces, process=False)
    mesh.fix_normals()
    return np.array(mesh.vertices), np.array(mesh.faces, np.int64)


def soup(mesh: Mesh) -> Mesh:
    """As an STL file has it: three vertices of its own for every triangle."""
    vertices, faces = mesh
    return vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)


def blob(seed: int, rounds: int = 3) -> Mesh:
    """A closed surface without symmetry: an ellipsoid, bent and dented."""
    rng = np.random.default_rng(seed)
    vertices, faces = ball(rounds)
    vertices = vertices * [1.0, 0.6, 0.4]
    for _ in range(3):
        frequency, phase, push = rng.normal(size=(3, 3))
        vertices = vertices + 0.05 * np.sin(3 * vertices @ frequency + phase[0])[:, None] * push
    return vertices, faces


def apart(places: np.ndarray) -> np.ndarray:
    """All distances in space."""
    return np.linalg.norm(places[:, None] - places, axis=2)


def shape(mesh: Mesh) -> Shape:
    return Shape.from_mesh(*mesh)


@pytest.fixture(scope="session")
def make() -> SimpleNamespace:
    return SimpleNamespace(
        ball=ball,
        strip=strip,
        rolled=rolled,
        cylinder=cylinder,
        cube=cube,
        worm=worm,
        soup=soup,
        blob=blob,
        apart=apart,
        shape=shape,
    )
