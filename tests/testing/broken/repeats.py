"""Measures that do not do the same again, or something on the side.

Measures, because nothing else is asked of them.
"""

from __future__ import annotations

import sys
import threading
import time

import numpy as np

from moseg_core.components.discovery.specs import MeasureSpec

_NAMES = {
    "runs-on-the-zoo": "first_triangle",
    "pickles": "with_a_lambda",
    "inputs-untouched": "moves_points",
    "same-in-every-process": "by_hash",
    "random-state-untouched": "draws",
    "silent": "prints",
    "usable-from-two-threads": "with_a_global",
}

BROKEN = {
    id: MeasureSpec(name="broken", target=f"tests.testing.broken.repeats:{name}")
    for id, name in _NAMES.items()
}


def first_triangle(part):
    """A cloud has none."""
    return part.triangles[0].tolist()


class WithALambda:
    """It cannot be pickled."""

    def __init__(self):
        self.function = lambda part: part.area

    def __call__(self, part):
        return self.function(part)


with_a_lambda = WithALambda()


def moves_points(part):
    """It shifts what all other components look at."""
    points = part.shape.points
    points.flags.writeable = True
    points[0] += 1e-3
    points.flags.writeable = False
    return part.area


def by_hash(part):
    """Texts have other hashes in another process."""
    return hash("area") % 1000 * part.area


def draws(part):
    """It takes a number from everybody's generator, to no purpose."""
    np.random.rand()  # noqa: NPY002  # that is what is wrong
    return part.area


def prints(part):
    """It says what it is doing."""
    print(f"measuring {part}")
    return part.area


scratch = {}


def with_a_global(part):
    """It puts something down in the middle of a call and hopes to find it again."""
    scratch["part"] = part
    time.sleep(0.002)
    return scratch["part"].area


def ends_its_thread(part):
    """It ends the thread that it is on, unless that is the main one."""
    if threading.current_thread() is not threading.main_thread():
        sys.exit()
    return part.area
