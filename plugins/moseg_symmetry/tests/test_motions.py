from __future__ import annotations

import numpy as np
import pytest
from moseg_symmetry.motions import Reflection, Turns
from scipy.spatial.transform import Rotation

NORMAL = np.array([2.0, -1.0, 2.0]) / 3.0
POINTS = np.random.default_rng(1).normal(size=(7, 3))
MOTIONS = {
    "reflection": Reflection(NORMAL, 0.3),
    "turns": Turns(NORMAL, np.array([0.3, 0.1, -0.2]), np.array([0.7, 2.0])),
    "half a turn": Turns(np.array([0.0, 0.0, 1.0]), np.zeros(3), np.array([np.pi])),
}


def test_reflection_by_hand():
    image = Reflection(np.array([0.0, 1.0, 0.0]), 2.0).images(np.array([[1.0, 5.0, 3.0]]))
    np.testing.assert_allclose(image, [[[1.0, -1.0, 3.0]]])


def test_turns_by_the_book():
    turns = MOTIONS["turns"]
    images = turns.images(POINTS)
    assert images.shape == (2, 7, 3)
    for angle, image in zip(turns.angles, images, strict=True):
        rotation = Rotation.from_rotvec(angle * NORMAL)
        expected = rotation.apply(POINTS - turns.point) + turns.point
        np.testing.assert_allclose(image, expected, atol=1e-14)


@pytest.mark.parametrize("name", MOTIONS)
def test_tangents_against_differences(name):
    motion = MOTIONS[name]
    tangents = motion.tangents(POINTS)
    assert tangents.shape[1:] == motion.images(POINTS).shape
    h = 1e-6
    for k, tangent in enumerate(tangents):
        step = h * np.eye(len(tangents))[k]
        ahead, back = motion.changed(step).images(POINTS), motion.changed(-step).images(POINTS)
        np.testing.assert_allclose((ahead - back) / (2 * h), tangent, atol=1e-8)


@pytest.mark.parametrize("name", MOTIONS)
def test_no_step_is_no_change(name):
    motion = MOTIONS[name]
    same = motion.changed(np.zeros(len(motion.tangents(POINTS))))
    np.testing.assert_allclose(same.images(POINTS), motion.images(POINTS), atol=1e-14)
    assert motion.apart(same) < 1e-7


def test_apart():
    reflection = MOTIONS["reflection"]
    assert reflection.apart(Reflection(-NORMAL, -0.3)) < 1e-7  # one plane from its other side
    assert reflection.apart(Reflection(NORMAL, 0.8)) == pytest.approx(0.5)
    assert reflection.apart(Reflection(np.array([1.0, 2.0, 0.0]) / 5**0.5, 0.3)) >= 1.0
    turns = MOTIONS["turns"]
    along = Turns(-NORMAL, turns.point + 5 * NORMAL, turns.angles)
    assert turns.apart(along) < 1e-7  # one axis, by another point of it
    across = np.cross(NORMAL, [1.0, 0, 0])
    beside = Turns(NORMAL, turns.point + 0.25 * across / np.linalg.norm(across), turns.angles)
    assert turns.apart(beside) == pytest.approx(0.25)
