"""Shapes with known symmetries, and how to move them."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from moseg_core import Shape

#: No axis of a shape is along one of the file, and no coordinate is 0.
GENERIC = Rotation.from_rotvec([0.4, -0.9, 0.55])
SHIFT = np.array([3.0, -7.0, 2.0])


def shape(mesh: trimesh.Trimesh, name: str = "shape") -> Shape:
    return Shape.from_mesh(mesh, name=name)


def moved(mesh, *, turn=GENERIC, scale=1.0, shift=SHIFT) -> trimesh.Trimesh:
    vertices = turn.apply(np.asarray(mesh.vertices)) * scale + shift
    return trimesh.Trimesh(vertices, mesh.faces, process=False)


def ellipsoid(*radii: float, rounds: int = 3) -> trimesh.Trimesh:
    ball = trimesh.creation.icosphere(subdivisions=rounds)
    return trimesh.Trimesh(ball.vertices * radii, ball.faces, process=False)


def prism(sides: int, *, height: float = 3.0) -> trimesh.Trimesh:
    return trimesh.creation.cylinder(radius=1.0, height=height, sections=sides)


def blob(seed: int = 0) -> trimesh.Trimesh:
    """A ball with bumps of all sizes in all places: nothing like its mirror image."""
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=4)
    at = rng.normal(size=(9, 3))
    at /= np.linalg.norm(at, axis=1)[:, None]
    height, width = rng.uniform(0.3, 1.2, 9), rng.uniform(0.15, 0.5, 9)
    apart = ((ball.vertices[:, None] - at) ** 2).sum(axis=2)
    radius = 1.0 + (height * np.exp(-apart / (2 * width**2))).sum(axis=1)
    return trimesh.Trimesh(ball.vertices * radius[:, None], ball.faces, process=False)


def stool(*, kick: float = 0.0) -> trimesh.Trimesh:
    """A body, a head and four legs; symmetric at x = 0 unless one leg is kicked forward."""
    parts = [
        moved(ellipsoid(0.5, 1.2, 0.5), turn=Rotation.identity(), shift=[0, 0, 1.5]),
        moved(ellipsoid(0.3, 0.4, 0.35, rounds=2), turn=Rotation.identity(), shift=[0, 1.5, 2.1]),
    ]
    for x in (-0.35, 0.35):
        for y in (-0.8, 0.8):
            leg = trimesh.creation.capsule(height=1.3, radius=0.13, count=[12, 12])
            leg.apply_translation([0, 0, -1.3])
            angle = kick if (x, y) == (0.35, 0.8) else 0.0
            turn = Rotation.from_rotvec([angle, 0, 0])
            parts.append(moved(leg, turn=turn, shift=[x, y, 1.4]))
    return trimesh.util.concatenate(parts)


def angle_between(a, b) -> float:
    """Between two lines, in radians, exact also where it is small."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), abs(np.dot(a, b))))


@pytest.fixture(scope="session")
def make() -> SimpleNamespace:
    return SimpleNamespace(
        GENERIC=GENERIC,
        SHIFT=SHIFT,
        shape=shape,
        moved=moved,
        ellipsoid=ellipsoid,
        prism=prism,
        blob=blob,
        stool=stool,
        angle_between=angle_between,
    )


@pytest.fixture(scope="session")
def psb() -> Path:
    """Folder of the Princeton Segmentation Benchmark."""
    folder = os.environ.get("MOSEG_PSB")
    if not folder:
        pytest.skip("MOSEG_PSB does not name a folder with the benchmark's models")
    return Path(folder)
