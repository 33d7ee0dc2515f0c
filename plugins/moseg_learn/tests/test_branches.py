"""Branches on graphs and shapes whose limbs are known, and by the definition, piece by piece."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import trimesh
from moseg_learn import branches as module
from moseg_learn.branches import (
    BRANCHES,
    LEAST_AREA,
    LEAST_LENGTH,
    MOST_LEVELS,
    STEP,
    branches,
    branches_of,
)
from scipy import sparse
from scipy.spatial.transform import Rotation

from moseg_core import Shape

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])


def named(found):
    return dict(zip(BRANCHES, found.T, strict=True))


def star(*arms):
    """Paths of so many nodes, joined at node 0; each step out is 0.05 more remote."""
    ends, rows, heights = 0, [], [1.0]
    for length in arms:
        for step in range(length):
            rows.append((0 if step == 0 else ends, ends + 1))
            ends += 1
            heights.append(1.0 + 0.05 * (step + 1) + 1e-6)
    links = np.array(rows)
    matrix = sparse.csr_array((np.ones(len(links)), links.T), (ends + 1, ends + 1))
    return np.array(heights), np.full(ends + 1, 1 / (ends + 1)), (matrix + matrix.T).tocsr()


def literal(r, share, touching):
    """(K, 5): the definition in the module's first lines, one place and one level at a time."""
    neighbours = [set(touching.indices[a:b]) for a, b in pairwise(touching.indptr)]
    levels = r.min() + STEP * np.arange(int((r.max() - r.min()) / STEP) + 1)

    def piece(start, level):
        if r[start] < level:
            return None
        reached, waiting = {start}, [start]
        while waiting:
            new = {n for n in neighbours[waiting.pop()] if r[n] >= level} - reached
            reached |= new
            waiting += new
        return frozenset(reached)

    def is_branch(nodes, level):
        nodes = list(nodes)
        return share[nodes].sum() >= LEAST_AREA and r[nodes].max() - level >= LEAST_LENGTH

    rows = []
    for x in range(len(r)):
        k = int((r[x] - r.min()) / STEP)
        part = (r[x] - levels[k]) / STEP
        area, tip = [], []
        for level in (levels[max(k - 1, 0)], levels[k]):
            nodes = list(piece(x, level))
            area.append(share[nodes] @ np.clip((r[nodes] - level) / STEP, 0, 1))
            tip.append(r[nodes].max())
        own, start = piece(x, levels[0]), levels[0]
        for upper in range(k, 0, -1):  # from the smallest piece that has x downward
            here, below = piece(x, levels[upper]), piece(x, levels[upper - 1])
            beside = {piece(y, levels[upper]) for y in below if r[y] >= levels[upper]} - {here}
            if is_branch(here, levels[upper]) and any(is_branch(b, levels[upper]) for b in beside):
                own, start = here, levels[upper]
                break
        nodes = list(own)
        length = r[nodes].max() - start
        rows.append(
            [
                np.log(max((1 - part) * area[0] + part * area[1], 1e-3)),
                (1 - part) * tip[0] + part * tip[1] - r[x],
                np.log(share[nodes].sum()),
                length,
                (r[x] - start) / max(length, LEAST_LENGTH),
            ]
        )
    return np.array(rows)


def test_literally():
    rng = np.random.default_rng(3)
    for trial in range(6):
        points = rng.random((90, 2))
        reach = np.linalg.norm(points[:, None] - points, axis=2)
        touching = sparse.csr_array((reach < 0.17) & (reach > 0))
        r = 1 + 0.3 * (np.sin(7 * points[:, 0] + trial) * np.sin(9 * points[:, 1])) ** 2
        share = rng.random(90)
        share /= share.sum()
        found = branches_of(r, share, touching)
        assert found == pytest.approx(literal(r, share, touching), abs=1e-9)
        assert len(np.unique(found[:, 2])) > 3  # there are branches to be found


def test_arms_of_a_star():
    r, share, touching = star(6, 4, 8)
    found = named(branches_of(r, share, touching))
    arms = np.split(np.arange(1, 19), [6, 10])
    for arm, length in zip(arms, (6, 4, 8), strict=True):
        assert np.exp(found["branch_area"][arm]) == pytest.approx(length / 19)
        assert found["branch_length"][arm] == pytest.approx(0.05 * length, abs=0.05)
        assert (np.diff(found["along_branch"][arm]) > 0).all()
        assert found["along_branch"][arm[-1]] == 1
        assert found["length_beyond"][arm] == pytest.approx(0.05 * np.arange(length)[::-1])
    # The middle lies on no arm, and everything lies beyond it.
    assert np.exp(found["branch_area"][0]) == pytest.approx(1)
    assert found["along_branch"][0] == 0
    assert np.exp(found["area_beyond"][0]) == pytest.approx(18 / 19, abs=0.01)


def test_an_arm_with_fingers_is_a_branch_as_each_finger_is():
    r, _, touching = star(4, 4, 4)  # a hand: three fingers on node 0
    hand = len(r)
    body = np.arange(8)  # it hangs on a path that rises again on the other side
    heights = np.concatenate([r + 1, [1.9, 1.7, 1.5, 1.2, 1.4, 1.6, 1.8, 2.0]])
    links = [(0, hand), *((hand + k, hand + k + 1) for k in body[:-1])]
    larger = sparse.block_diag([touching, sparse.csr_array((8, 8))], format="lil")
    for a, b in links:
        larger[a, b] = larger[b, a] = 1
    found = named(branches_of(heights, np.full(len(heights), 1 / 21), larger.tocsr()))
    assert np.exp(found["branch_area"][1:hand]) * 21 == pytest.approx(4)  # a finger
    assert np.exp(found["branch_area"][[0, hand, hand + 1]]) * 21 == pytest.approx(hand + 3)
    assert np.exp(found["branch_area"][hand + 4 :]) * 21 == pytest.approx(4)  # the other side


def test_what_is_small_is_a_bump():
    for arms in ((8, 8, 1), (8, 8)):  # an arm of one step is shorter than a branch is
        r, share, touching = star(*arms)
        found = named(branches_of(r, share, touching))
        assert np.exp(found["branch_area"][1:9]) == pytest.approx(8 / len(r))
    r, share, touching = star(8, 8, 8)
    share = np.r_[share[:17], np.full(8, LEAST_AREA / 20)]
    found = named(branches_of(r, share / share.sum(), touching))
    assert np.exp(found["branch_area"][17:]) == pytest.approx(1)


def test_a_very_long_hair_makes_no_more_levels_than_there_may_be(monkeypatch):
    levels = []
    whole = module._pieces
    monkeypatch.setattr(
        module,
        "_pieces",
        lambda among, level, *rest: levels.append(level) or whole(among, level, *rest),
    )
    r, share, touching = star(6, 4, 8)
    r[-1] = 100.0
    found = named(branches_of(r, share, touching))
    assert len(levels) == MOST_LEVELS + 1
    assert found["length_beyond"][-1] == pytest.approx(0)
    assert found["branch_length"][-1] == pytest.approx(100 - 1.05, abs=0.2)


def test_loose_pieces_are_whole_each():
    r, share, touching = star(5, 5)
    twice = sparse.block_diag([touching, touching], format="csr")
    found = named(branches_of(np.r_[r, r + 0.5], np.r_[share, share] / 2, twice))
    alone = named(branches_of(r, share, touching))
    for name in ("length_beyond", "along_branch"):
        assert found[name][: len(r)] == pytest.approx(alone[name])
    assert np.exp(found["branch_area"][[0, len(r)]]) == pytest.approx(0.5)


def test_rounding_does_not_say_which_of_equals_comes_first():
    r, share, touching = star(8, 8, 8, 8)
    nudged = r + 1e-12 * np.random.default_rng(0).standard_normal(len(r))
    nudged[0] = nudged.min() - 1e-12
    found, expected = branches_of(nudged, share, touching), branches_of(r, share, touching)
    assert found == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("mirrored", [False, True])
def test_moved_turned_and_scaled(mirrored):
    beam = trimesh.creation.box((6, 1, 1))
    post = trimesh.creation.box((1, 1, 4)).apply_translation((0.7, 0.1, 2.5))
    union = trimesh.boolean.union([beam, post], engine="manifold")
    fine = trimesh.remesh.subdivide_to_size(union.vertices, union.faces, 1.4)
    shape = Shape.from_mesh(*fine)
    vertices = fine[0] * [1, 1, -1 if mirrored else 1]
    turned = Shape.from_mesh(3 * GENERIC.apply(vertices) + [5, 0, 1], fine[1])
    found = named(branches(shape))
    # Its box is another, and remoteness goes by no length: nothing changes.
    assert branches(turned) == pytest.approx(branches(shape), abs=1e-6)
    tips = [np.argmin(shape.points @ way) for way in ([1, 0, 0], [-1, 0, 0], [0, 0, -1])]
    sizes = [found["branch_area"][tip] for tip in tips]
    assert len(set(np.round(sizes, 6))) == 3  # two ends of the beam, and the post
    assert max(sizes) < np.log(0.6)


def test_of_a_single_face():
    found = named(branches(Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])))
    assert [values.item() for values in found.values()] == [np.log(1e-3), 0, 0, 0, 0]
