"""The tree of boxes: which pieces each box holds, and what is lost by seeing it from afar."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.winding_tree import _LEAF, WindingTree, _boxes
from tests import shapes


def tree_of(mesh):
    return WindingTree.of(PolygonMesh.from_faces(*mesh))


@pytest.mark.parametrize("n", [1, _LEAF, _LEAF + 1, 100, 1000])
def test_boxes_halve_the_pieces_down_to_leaves(n):
    places = np.random.default_rng(n).normal(size=(n, 3))
    order, starts, stops, skips = _boxes(places)
    assert sorted(order) == list(range(n))
    assert (starts[0], stops[0], skips[0]) == (0, n, len(starts))
    for box in range(len(starts)):
        if skips[box] == box + 1:  # nothing within it
            assert 0 < stops[box] - starts[box] <= _LEAF
            continue
        left, right = box + 1, skips[box + 1]
        assert skips[right] == skips[box]
        assert (starts[left], stops[left]) == (starts[box], starts[right])
        assert stops[right] == stops[box]
        # Parted by a plane across the longest side.
        inside = places[order[starts[box] : stops[box]]]
        axis = np.ptp(inside, axis=0).argmax()
        first, second = (places[order[starts[b] : stops[b]], axis] for b in (left, right))
        assert first.max() <= second.min()


def test_a_box_has_the_dipole_of_its_pieces_and_reaches_around_them():
    tree = tree_of(shapes.jitter(shapes.sphere(3), 1, 0.05))
    assert np.abs(tree.box_dipoles[0]).max() < 1e-12  # a closed surface
    for box, (start, stop) in enumerate(zip(tree.starts, tree.stops, strict=True)):
        assert tree.box_dipoles[box] == pytest.approx(tree.dipoles[start:stop].sum(axis=0))
        apart = np.linalg.norm(tree.corners[start:stop] - tree.box_places[box], axis=2)
        assert apart.max() <= tree.box_radii[box] + 1e-12


@pytest.mark.parametrize("far", [1.5, 2.0, 4.0])
def test_far_boxes_make_little_difference(far):
    tree = tree_of(shapes.jitter(shapes.sphere(4), 3, 0.02))
    queries = np.random.default_rng(1).uniform(-1.3, 1.3, (500, 3))
    apart = np.abs(tree.winding(queries, far) - tree.winding(queries, np.inf)).max()
    assert 0 < apart < 0.3 / far**2
