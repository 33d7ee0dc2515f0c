"""Ears: those of the definition, found in time, also where the polygon is none."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.shape.triangulate import clip_ears
from tests import shapes
from tests.shape.test_triangulate import assert_cuts_once, star


def slow_ears(points):
    """Ear clipping as its definition says: after each cut all corners are looked at anew."""
    points = points - points[0]
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    drop = int(np.argmax(np.abs(normal)))
    plane = np.delete(points, drop, axis=1)
    if (normal[drop] < 0) != (drop == 1):
        plane = plane[:, ::-1]

    def turns(a, b, c):
        return (b - a)[..., 0] * (c - a)[..., 1] - (b - a)[..., 1] * (c - a)[..., 0]

    def holds_none(i):
        ring = plane[left]
        a, b, c = ring[i - 1], ring[i], ring[(i + 1) % len(ring)]
        inside = (turns(a, b, ring) >= 0) & (turns(b, c, ring) >= 0) & (turns(c, a, ring) >= 0)
        for corner in (a, b, c):
            inside &= (ring != corner).any(axis=1)
        return not inside.any()

    found, left = [], np.arange(len(points))
    while len(left) > 3:
        all_turns = turns(plane[np.roll(left, 1)], plane[left], plane[np.roll(left, -1)])
        ears = (i for i in np.flatnonzero(all_turns > 0) if holds_none(int(i)))
        ear = next(ears, int(np.argmax(all_turns)))
        found.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
        left = np.delete(left, ear)
    return [*map(list, found), left.tolist()]


@pytest.mark.parametrize("kind", ["star", "random", "lattice", "repeated"])
@pytest.mark.parametrize("seed", range(10))
def test_ears_are_those_that_the_definition_finds_one_after_the_other(kind, seed):
    rng = np.random.default_rng(seed)
    points = {
        "star": lambda: star(seed, 30) @ shapes.rotation(seed).T,
        "random": lambda: rng.normal(size=(20, 3)),
        "lattice": lambda: np.pad(rng.integers(0, 4, (25, 2)).astype(float), ((0, 0), (0, 1))),
        "repeated": lambda: star(seed, 20)[np.r_[0:20, rng.integers(0, 20, 4)]],
    }[kind]()
    found = clip_ears(points).tolist()
    assert found == slow_ears(points) or found == [[0, k, k + 1] for k in range(1, len(points) - 1)]


def test_of_a_large_polygon_the_grid_of_cells_finds_the_same_ears():
    points = star(3, 700)
    assert clip_ears(points).tolist() == slow_ears(points)
    assert_cuts_once(points, clip_ears(points))


def test_a_polygon_of_thousands_of_scattered_corners_is_cut_all_the_same():
    rng = np.random.default_rng(0)
    assert len(clip_ears(rng.normal(size=(5000, 3)))) == 4998


def test_a_spiral_of_thirty_thousand_corners_is_cut_into_pieces_that_add_up():
    t = np.linspace(0, 200 * np.pi, 15000)
    inner, outer = ([r * np.cos(t), r * np.sin(t), 0 * t] for r in (t, t + 1.5))
    points = np.concatenate([np.transpose(inner), np.transpose(outer)[::-1]])
    assert_cuts_once(points, clip_ears(points))
