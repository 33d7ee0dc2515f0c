"""The sample `hammer`: an engineer's hammer with a cross peen, in millimetres.

It lies on its side: x runs along the handle towards the head, z along the head towards the
striking face, and y is up from the ground. The handle is oval, swells at the grip and curves a
little. It goes through the eye of the head and shows beyond it; that end is held by the wedge and
counts as head, so that either part is one piece of surface.
"""

from __future__ import annotations

import numpy as np

from samples.fields import Field, FloatArray, blend, loft

GRID = 2.0
LOW = np.array([-225.0, -15.0, -75.0])
HIGH = np.array([120.0, 45.0, 75.0])
SYMMETRIC = False
FILLET = 3.0


def parts() -> dict[str, Field]:
    """Return the solids of the two parts, each without the other."""
    return {"handle": _handle(), "head": _head()}


def whole(points: FloatArray) -> FloatArray:
    """Blend the hammer into one: both parts with a small fillet where they meet."""
    return blend(list(parts().values()), FILLET)(points)


def size(points: FloatArray) -> FloatArray:
    """Give the length of edges: the same everywhere."""
    return np.full(len(points), 2.85)


def _handle() -> Field:
    """From the butt to within the head; wide in the plane in which the hammer swings."""
    return loft(
        [
            (-204.0, 13.1, 5.0, 12.0, 16.0),
            (-185.0, 13.2, 3.6, 13.2, 17.6),
            (-150.0, 13.5, 0.8, 12.6, 16.4),
            (-105.0, 13.9, -1.8, 11.0, 13.8),
            (-50.0, 14.3, -2.8, 9.6, 12.2),
            (10.0, 14.6, -1.8, 8.6, 11.2),
            (55.0, 14.6, -0.4, 8.8, 11.6),
            (75.0, 14.6, 0.0, 9.2, 12.4),
            (90.0, 14.6, 0.0, 8.4, 11.0),
        ],
        caps=(8.0, 5.0),
    )


def _head() -> Field:
    """Round face and neck, square cheeks around the eye, a wedge for a peen."""
    side = (0.0, 1.0, 0.0)
    face = loft(
        [
            (88.0, 14.6, 10.0, 11.5, 11.5),
            (88.0, 14.6, 26.0, 10.4, 10.6),
            (88.0, 14.6, 36.0, 12.2, 12.4),
            (88.0, 14.6, 42.0, 14.2, 14.2),
            (88.0, 14.6, 54.0, 14.4, 14.4),
        ],
        side=side,
        flat=(None, 3.0),
    )
    peen = loft(
        [
            (88.0, 14.6, 17.0, 12.5, 12.0),
            (88.0, 14.6, 0.0, 14.5, 14.6),
            (88.0, 14.6, -17.0, 12.8, 12.4),
            (88.6, 14.6, -36.0, 8.6, 12.4),
            (89.6, 14.6, -57.0, 3.6, 13.2),
        ],
        side=side,
        power=4,
        caps=(4.0, 3.4),
    )
    wedge = loft(
        [(84.0, 14.6, 0.0, 8.0, 10.4), (107.0, 14.6, 0.0, 8.4, 10.8)],
        flat=(None, 2.5),
        steps=1,
    )
    return blend([face, peen, wedge], 3.0)
