"""Meshes to measure with: a surface cut up more finely, and many small ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh

import moseg_core as moseg


def cut_up(shape: moseg.Shape, n: int) -> moseg.Shape:
    """The same surface, each triangle cut into n^2 equal ones that meet corner to corner."""
    vertices, faces = shape.geometry.vertices, shape.geometry.triangles
    grid = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    number = {place: k for k, place in enumerate(grid)}
    small = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in grid if i + j < n]
    small += [
        (number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in grid if i + j < n - 1
    ]
    parts = np.array([(n - i - j, i, j) for i, j in grid])
    # A point is told by the corners that it lies between, and its share of each.
    corners = np.repeat(faces[:, None], len(grid), axis=1)
    order = np.where(parts > 0, corners, -1).argsort(axis=2)
    who = np.take_along_axis(np.where(parts > 0, corners, -1), order, axis=2)
    share = np.take_along_axis(np.broadcast_to(parts, corners.shape), order, axis=2)
    keys, place = np.unique(
        np.concatenate([who, share], axis=2).reshape(-1, 6), axis=0, return_inverse=True
    )
    points = np.einsum("pk,pki->pi", keys[:, 3:] / n, vertices[keys[:, :3]])
    cut = place.reshape(len(faces), -1)[:, small].reshape(-1, 3)
    return moseg.Shape.from_mesh(points, cut, name=f"{shape.name} cut up")


def small_hammer(rng: np.random.Generator) -> moseg.Shape:
    """A handle and a head across its end, of random proportions: 700 faces, closed."""
    half, long, wide, high, deep = rng.uniform([0.2, 4, 1, 0.8, 0.5], [0.5, 8, 2, 1.5, 1])
    outline = [
        *((-half, 0), (half, 0), (half, long), (wide, long)),
        *((wide, long + high), (-wide, long + high), (-wide, long), (-half, long)),
    ]
    n = len(outline)
    front = [(0, 1, 2), (0, 2, 7), (7, 2, 4), (2, 3, 4), (7, 4, 5), (6, 7, 5)]
    back = [(n + c, n + b, n + a) for a, b, c in front]
    sides = [(k, n + (k + 1) % n, (k + 1) % n) for k in range(n)]
    sides += [(k, n + k, n + (k + 1) % n) for k in range(n)]
    vertices = [(x, y, z) for z in (deep, -deep) for x, y in outline]
    return cut_up(moseg.Shape.from_mesh(vertices, [*front, *back, *sides], name="hammer"), 5)


def write_mesh(shape: moseg.Shape, path: Path) -> None:
    """Write a shape of triangles, without labels."""
    geometry = shape.geometry
    trimesh.Trimesh(geometry.vertices, geometry.triangles, process=False).export(path)
