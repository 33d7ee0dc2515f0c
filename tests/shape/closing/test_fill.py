"""What fills a rim: the least area of all ways, no overlaps in a plane, no edge that is barred."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.closing import fill as module
from moseg_core.shape.closing.fill import bridged, edges_of, fill


def areas(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0


def every_way(i, k):
    """All triangulations of the stretch of a loop from i to k."""
    if k - i < 2:
        yield []
    for j in range(i + 1, k):
        for left in every_way(i, j):
            for right in every_way(j, k):
                yield [(i, j, k), *left, *right]


@given(st.integers(0, 10_000), st.integers(3, 7))
@settings(max_examples=25)
def test_the_area_is_the_least_of_all_ways(seed, count):
    vertices = np.random.default_rng(seed).normal(size=(count, 3))
    least = min(areas(vertices, np.array(way)).sum() for way in every_way(0, count - 1))
    found = fill(vertices, np.arange(count), set())
    assert found.shape == (count - 2, 3)
    assert areas(vertices, found).sum() == pytest.approx(least, rel=1e-3)


def star(points=9, depth=0.35):
    angle = np.arange(2 * points) * np.pi / points
    radius = np.where(np.arange(2 * points) % 2, depth, 1.0)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle])


def shoelace(plane):
    x, y = plane[:, 0], plane[:, 1]
    return (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2.0


@pytest.mark.parametrize("longest", [module.LONGEST, 4])
def test_a_loop_in_a_plane_is_covered_once(monkeypatch, longest):
    monkeypatch.setattr(module, "LONGEST", longest)
    outline = star()
    triangles = fill(outline, np.arange(18), set())
    assert areas(outline, triangles).sum() == pytest.approx(shoelace(outline))
    assert (np.cross(*np.diff(outline[triangles], axis=1).swapaxes(0, 1))[:, 2] > 0).all()


def test_sides_with_points_on_them_get_no_triangles_without_area():
    side = np.arange(6) / 6
    square = np.concatenate(
        [np.c_[side, 0 * side], np.c_[1 + 0 * side, side], np.c_[1 - side, 1 + 0 * side],
         np.c_[0 * side, 1 - side]]
    )  # fmt: skip
    square = np.c_[square, np.zeros(len(square))]
    triangles = fill(square, np.arange(len(square)), set())
    assert areas(square, triangles).min() > 1e-3
    assert areas(square, triangles).sum() == pytest.approx(1.0)


@pytest.mark.parametrize("longest", [module.LONGEST, 4])
def test_a_barred_edge_is_not_made(monkeypatch, longest):
    monkeypatch.setattr(module, "LONGEST", longest)
    angle = np.arange(6) * np.pi / 3
    hexagon = np.c_[np.cos(angle), np.sin(angle), 0 * angle]
    for made in edges_of(fill(hexagon, np.arange(6), set())) - {(0, 5)}:
        if abs(made[0] - made[1]) > 1:
            again = fill(hexagon, np.arange(6), {made})
            assert again is None or made not in edges_of(again)
    every = {(i, j) for i in range(6) for j in range(i + 2, 6)} - {(0, 5)}
    assert fill(hexagon, np.arange(6), every) is None


def test_holes_are_left_out_of_a_cap():
    outer = 3.0 * star(depth=0.8)
    holes = [0.3 * star()[::-1] + [x, 0, 0] for x in (-1.0, 1.0)]
    vertices = np.concatenate([outer, *holes])
    rings = np.split(np.arange(len(vertices)), 3)
    barred = set()
    loop = bridged(vertices, rings, barred)
    assert len(loop) == len(vertices) + 4
    assert len(barred) == 2
    triangles = fill(vertices, loop, barred)
    expected = shoelace(outer) + sum(map(shoelace, holes))
    assert areas(vertices, triangles).sum() == pytest.approx(expected)
    sides = np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    assert np.unique(sides, axis=0, return_counts=True)[1].max() == 2
