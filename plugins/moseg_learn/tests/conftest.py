"""Beasts made of a body and knobs on it: as many legs as asked for, with or without a tail."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from moseg_core import Example, Recipe, Shape, learn

_HEADS = np.array([1.0, 0.0, 0.1])
_TAIL = np.array([-1.0, 0.0, 0.1])


def directions(legs: int) -> np.ndarray:
    """Where legs stand out from the body, all downward."""
    angle = 2 * np.pi * (np.arange(legs) + 0.5) / legs
    out = np.stack([0.6 * np.cos(angle), 0.6 * np.sin(angle), np.full(legs, -1.0)], axis=1)
    return out / np.linalg.norm(out, axis=1)[:, None]


def beast(
    *, legs: int = 3, tail: bool = False, stretch: float = 1.0, name: str = "beast", rounds: int = 3
) -> Example:
    """A ball with bumps: a wide one is the head, narrow ones are legs and tail."""
    ball = trimesh.creation.icosphere(subdivisions=rounds)
    vertices, faces = np.array(ball.vertices), np.array(ball.faces, np.int64)
    bumps = [(_HEADS / np.linalg.norm(_HEADS), 0.45, 0.8, "head")]
    bumps += [(towards, 0.25, 1.3, "leg") for towards in directions(legs)]
    bumps += [(_TAIL / np.linalg.norm(_TAIL), 0.2, 0.9, "tail")] if tail else []
    grown, middles = vertices.copy(), vertices[faces].mean(axis=1)
    middles /= np.linalg.norm(middles, axis=1)[:, None]
    names = ["body", "head", "leg", "tail"]
    labels = np.zeros(len(faces), np.int64)
    for towards, width, height, label in bumps:
        off = np.arccos(np.clip(vertices @ towards, -1, 1)) / width
        grown += (height * np.clip(2.0 * (1 - off), 0, 1))[:, None] * towards
        labels[np.arccos(np.clip(middles @ towards, -1, 1)) < width] = names.index(label)
    grown *= [stretch, 1.0, 1.0]
    return Example(Shape.from_mesh(grown, faces, name=name), labels, tuple(names))


@pytest.fixture(scope="session")
def make() -> SimpleNamespace:
    return SimpleNamespace(beast=beast)


@pytest.fixture(scope="session")
def herd() -> list[Example]:
    """Three beasts that differ in their proportions, and the last has a tail."""
    return [
        beast(name="one"),
        beast(name="two", stretch=1.25),
        beast(name="three", stretch=1.1, tail=True),
    ]


@pytest.fixture(scope="session")
def recipe(herd) -> Recipe:
    """What is learned from the herd, which takes a while."""
    return learn(herd)
