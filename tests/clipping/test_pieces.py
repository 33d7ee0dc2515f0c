"""How a triangle is divided where the flood has parted what the cuts have not."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.clipping.bisector import Bisectors
from moseg_core.clipping.net import Cuts, Net
from moseg_core.clipping.pieces import divide
from moseg_core.shape.mesh import PolygonMesh
from tests.clipping.checks import polygon_areas

# A corner at the origin and one along each of x and y; positions are numbered in order of x, y, z.
CORNERS = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]
AT_ORIGIN, AT_Y, AT_X = range(3)


def divided(own: int, labels: list[int], cut: dict[tuple[int, int], float], *, turn: int = 0):
    """Area by label of the triangle with this label, labels by position, and cuts."""
    mesh = PolygonMesh.from_faces(CORNERS, np.roll([[0, 1, 2]], turn, axis=1))
    # The centre of part 2 is nearer to the centroid than that of part 1.
    centers = np.array([[9.0, 0, 0], [0, 2, 0], [1, 0, 0], [9, 9, 0]])
    net = Net.of(
        mesh,
        np.array([own]),
        np.array([[2 / 3, 2 / 3, 0.0]]),
        mesh.vertices,
        Bisectors(centers, np.ones(4)),
    )
    ends = [tuple(pair) for pair in net.ends.tolist()]
    cuts = Cuts(
        label=np.array(labels),
        cut=np.array([pair in cut for pair in ends]),
        where=np.array([cut.get(pair, 0.0) for pair in ends]),
    )
    pieces = divide(net, cuts)
    area = np.bincount(pieces.labels, polygon_areas(pieces.mesh), 4)
    return {label: a for label, a in enumerate(area.tolist()) if a}


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize(("own", "rest"), [(0, 2), (1, 1), (2, 2), (3, 2)])
def test_two_cuts_and_two_corners_that_the_flood_parted(own, rest, turn):
    cut = {(AT_ORIGIN, AT_X): 0.5, (AT_ORIGIN, AT_Y): 0.25}
    found = divided(own, [0, 1, 2], cut, turn=turn)
    assert found == pytest.approx({0: 0.25, rest: 1.75})


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize("third", [-1, 0, 1, 2])
@pytest.mark.parametrize(
    ("own", "areas"), [(0, {0: 0.5, 1: 1.5}), (1, {0: 0.5, 1: 1.5}), (3, {3: 2.0})]
)
def test_one_cut(own, areas, third, turn):
    found = divided(own, [0, 1, third], {(AT_ORIGIN, AT_Y): 0.25}, turn=turn)
    assert found == pytest.approx(areas)


@pytest.mark.parametrize(
    ("labels", "found"),
    [([1, 1, 1], 1), ([1, 1, 2], 3), ([-1, -1, -1], 3), ([-1, 1, 1], 3)],
)
def test_no_cut(labels, found):
    assert divided(3, labels, {}) == {found: 2.0}


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize(
    ("x", "y", "areas"),
    [
        (1e-9, 0.5, {1: 2.0}),  # the corner's share has no extent, yet the other cut is there
        (1e-9, 1e-9, {1: 2.0}),
        (1 - 1e-9, 0.5, {0: 1.0, 1: 1.0}),
        (1 - 1e-9, 1 - 1e-9, {0: 2.0}),
        (1e-9, 1 - 1e-9, {1: 2.0}),
    ],
)
def test_cuts_at_corners(x, y, areas, turn):
    cut = {(AT_ORIGIN, AT_X): x, (AT_ORIGIN, AT_Y): y}
    assert divided(0, [0, 1, 1], cut, turn=turn) == pytest.approx(areas)
