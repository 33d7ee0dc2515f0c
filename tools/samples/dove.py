"""The sample `dove`: a dove that glides with its wings spread, in millimetres.

x points forward, y up, z to the dove's right; the lowest point of the belly is at y = 0. The dove
is its own mirror image in the plane z = 0, and so is its mesh. Head and beak belong to the body.
The wings are flat, reach forward to the wrist and back to the tip, and rise a little outwards; the
tail is a flat fan.
"""

from __future__ import annotations

import numpy as np

from samples.fields import Field, FloatArray, blend, folded, loft, mirrored, smooth_min

GRID = 3.5
LOW = np.array([-240.0, -15.0, -350.0])
HIGH = np.array([220.0, 150.0, 350.0])
SYMMETRIC = True
FILLET = 12.0


def parts() -> dict[str, Field]:
    """Return the solids of the four parts, each without the others."""
    wing = _left_wing()
    return {"body": _body(), "wing1": wing, "wing2": mirrored(wing), "tail": _tail()}


def whole(points: FloatArray) -> FloatArray:
    """Blend the dove into one; wings and tail flow into the body."""
    return folded(_left)(points)


def size(points: FloatArray) -> FloatArray:
    """Give the length of edges: shorter towards the beak, which is small."""
    return np.clip(3.0 + 0.06 * (190.0 - points[:, 0]), 3.0, 5.7)


def _left(points: FloatArray) -> FloatArray:
    """Blend the parts that have a left half."""
    body = _body()(points)
    wing = smooth_min(body, _left_wing()(points), FILLET)
    tail = smooth_min(body, _tail()(points), FILLET)
    return smooth_min(wing, tail, 2.0)


def _body() -> Field:
    """A spindle from the rump to the neck, a round head, and a beak."""
    trunk = loft(
        [
            (-125.0, 50.0, 0.0, 10.0, 18.0),
            (-80.0, 46.5, 0.0, 24.0, 28.0),
            (-30.0, 43.0, 0.0, 35.0, 35.0),
            (25.0, 40.5, 0.0, 40.0, 38.0),
            (58.0, 40.5, 0.0, 36.0, 33.0),
        ],
        caps=(12.0, 30.0),
    )
    neck = loft(
        [
            (55.0, 46.0, 0.0, 34.0, 31.0),
            (96.0, 60.0, 0.0, 23.0, 21.0),
            (122.0, 70.0, 0.0, 18.0, 16.5),
        ],
        caps=(10.0, 12.0),
    )
    head = loft([(132.0, 75.0, 0.0, 22.0, 20.5), (145.0, 75.0, 0.0, 20.0, 19.0)], steps=1)
    beak = loft(
        [(156.0, 72.0, 0.0, 9.0, 8.0), (173.0, 68.0, 0.0, 5.5, 5.5), (185.0, 63.0, 0.0, 4.0, 4.0)],
    )
    return blend([blend([trunk, neck, head], 8.0), beak], 5.0)


def _left_wing() -> Field:
    """Make a thin plate from within the body to the tip."""
    return loft(
        [
            (20.0, 55.0, -5.0, 8.0, 50.0),
            (24.0, 59.0, -50.0, 7.5, 50.0),
            (33.0, 65.5, -110.0, 7.0, 48.0),
            (32.0, 72.5, -170.0, 6.5, 43.0),
            (14.0, 79.5, -230.0, 6.0, 34.0),
            (-20.0, 86.0, -290.0, 5.5, 21.0),
            (-48.0, 89.0, -322.0, 5.0, 10.0),
        ],
        side=(1.0, 0.0, 0.0),
        power=None,
    )


def _tail() -> Field:
    """Make a fan, flat, about as long as it is wide."""
    return loft(
        [
            (-75.0, 52.0, 0.0, 8.0, 18.0),
            (-115.0, 53.0, 0.0, 7.0, 24.0),
            (-155.0, 53.0, 0.0, 6.0, 37.0),
            (-194.0, 52.0, 0.0, 5.5, 51.0),
            (-208.0, 51.7, 0.0, 5.5, 51.0),
            (-218.0, 51.5, 0.0, 5.5, 36.0),
        ],
        power=None,
    )
