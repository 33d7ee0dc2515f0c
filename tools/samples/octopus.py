"""The sample `octopus`: an octopus that moves its eight arms every way, in millimetres.

y is up, and x points to where its eyes look; the lowest arm touches the ground y = 0. The mantle,
the eyes and the ring from which the arms grow are the head. All arms are equally long, measured
along them, and equally thick; each bends in its own way, some rise, curl, or pass above another.
They keep well apart, so that two places may be near in space and far along the surface.
"""

from __future__ import annotations

from math import sqrt
from typing import TypeAlias

import numpy as np

from samples.fields import Field, FloatArray, Row, blend, bounded, dot, loft, normalized, smooth_min

GRID = 4.0
LOW = np.array([-225.0, -12.0, -325.0])
HIGH = np.array([250.0, 210.0, 295.0])
SYMMETRIC = False
FILLET = 8.0

# The height of the ring of arms, and the length of each of the ten pieces of an arm.
BASE, STEP = 14.4, 30.0

# The radius of an arm at its root and at its tip.
THICK, THIN = 12.0, 5.0

# How much an arm turns from each piece to the next, to its left and upwards.
Turns: TypeAlias = tuple[tuple[float, ...], tuple[float, ...]]
BENDS: dict[str, Turns] = {
    # Along the ground, the end rolled up to the left.
    "arm1": (
        (0.0, -0.1, -0.1, 0.2, 0.5, 0.6, 0.65, 0.7, 0.75),
        (-0.1, 0.05, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    ),
    # Up in an arch, which then sways to the right.
    "arm2": (
        (0.0, 0.1, 0.1, 0.0, -0.2, -0.3, -0.4, -0.4, -0.4),
        (0.5, 0.4, 0.1, -0.3, -0.5, -0.5, -0.4, 0.0, 0.3),
    ),
    # Along the ground, to the right and back.
    "arm3": (
        (0.0, -0.1, -0.2, -0.4, -0.4, -0.1, 0.4, 0.5, 0.5),
        (-0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    ),
    # Up and over arm 3.
    "arm4": (
        (0.1, 0.4, 0.4, 0.3, 0.1, 0.0, -0.2, -0.4, -0.5),
        (0.45, 0.4, -0.1, -0.3, -0.2, 0.0, 0.1, 0.2, 0.2),
    ),
    # Rolled up in an upright plane, like a fern.
    "arm5": (
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        (-0.1, 0.1, 0.2, 0.4, 0.6, 0.65, 0.7, 0.75, 0.8),
    ),
    # Along the ground and under arm 7.
    "arm6": (
        (0.0, -0.2, -0.3, -0.3, -0.2, 0.0, 0.3, 0.4, 0.5),
        (-0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    ),
    # Up, and over arm 6.
    "arm7": (
        (0.0, 0.2, 0.3, 0.3, 0.2, 0.0, 0.0, -0.3, -0.4),
        (0.4, 0.3, -0.2, -0.3, -0.2, 0.0, 0.2, 0.2, 0.3),
    ),
    # Around and over arm 1, in a tilted loop.
    "arm8": (
        (0.0, -0.2, -0.5, -0.5, -0.5, -0.5, -0.5, -0.55, -0.55),
        (0.3, 0.3, 0.2, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3),
    ),
}


def parts() -> dict[str, Field]:
    """Return the solids of the nine parts, each without the others."""
    arms = zip(BENDS, _directions(), strict=True)
    return {"head": _head(), **{name: _arm(out, BENDS[name]) for name, out in arms}}


def whole(points: FloatArray) -> FloatArray:
    """Blend the octopus into one: each arm with the head, and none with another."""
    head = _head()(points)
    joined = []
    for out, bends in zip(_directions(), BENDS.values(), strict=True):
        line = _center_line(out, bends)
        low, high = line.min(axis=0) - 2.0 * THICK, line.max(axis=0) + 2.0 * THICK
        arm = bounded(_arm(out, bends), low, high, THICK)
        joined.append(smooth_min(head, arm(points), FILLET))
    result = joined[0]
    for other in joined[1:]:
        result = np.minimum(result, other)
    return result


def size(points: FloatArray) -> FloatArray:
    """Give the length of edges: shorter away from the head, where the arms are thin."""
    from_head = points - np.array([0.0, 40.0, 0.0])
    return np.clip(7.2 - 0.018 * (np.sqrt(dot(from_head, from_head)) - 80.0), 4.0, 7.2)


def _head() -> Field:
    """Ring of the arms, neck, mantle, and two eyes."""
    ring = loft(
        [
            (0.0, BASE, 0.0, 58.0, 58.0),
            (0.0, 36.0, 0.0, 48.0, 48.0),
            (0.0, 58.0, 0.0, 40.0, 41.0),
        ],
        caps=(13.0, 20.0),
    )
    mantle = loft(
        [
            (-1.0, 54.0, 0.0, 40.0, 41.0),
            (-10.0, 90.0, 0.0, 48.0, 47.0),
            (-19.0, 122.0, 0.0, 50.0, 48.0),
            (-29.0, 150.0, 0.0, 45.0, 43.0),
        ],
        caps=(20.0, 42.0),
    )
    eyes = [
        loft([(24.0, 58.0, 25.0 * s, 13.0, 13.0), (31.0, 60.0, 31.0 * s, 12.0, 12.0)], steps=1)
        for s in (-1.0, 1.0)
    ]
    return blend([ring, mantle, *eyes], 8.0)


def _directions() -> list[FloatArray]:
    """Eight directions in which arms leave the head, a quarter of a right angle off the axes."""
    near, far = sqrt(2.0 + sqrt(2.0)) / 2.0, sqrt(2.0 - sqrt(2.0)) / 2.0
    around = [(near, far), (far, near), (-far, near), (-near, far)]
    return [np.array([s * x, 0.0, s * z]) for s in (1.0, -1.0) for x, z in around]


def _center_line(out: FloatArray, bends: Turns) -> FloatArray:
    """Points at equal steps along an arm, which turns from each to the next.

    What is left and up turns with the arm: no sine or cosine is needed, and no arm is too steep.
    """
    heading, lift = out, np.array([0.0, 1.0, 0.0])
    place = 32.0 * out + BASE * lift
    line = [place]
    for left, rise in [(0.0, 0.0), *zip(*bends, strict=True)]:
        ahead = normalized(heading + left * np.cross(lift, heading) + rise * lift)
        lift = normalized(lift - rise * heading)
        lift = normalized(lift - dot(lift, ahead) * ahead)
        heading = ahead
        place = place + STEP * heading
        line.append(place)
    return np.stack(line)


def _arm(out: FloatArray, bends: Turns) -> Field:
    """Make a round arm that tapers from within the head to the tip."""
    line = _center_line(out, bends)
    radius = THICK - (THICK - THIN) * np.arange(len(line)) / (len(line) - 1)
    rows: list[Row] = [
        (float(p[0]), float(p[1]), float(p[2]), float(r), float(r))
        for p, r in zip(line, radius, strict=True)
    ]
    return loft(rows, side=None, steps=3)
