"""The module of a bundle that imports a numerical library, and a measure with nothing wrong."""

from __future__ import annotations

import numpy as np

from moseg_core.components.discovery.hookspecs import hookimpl
from moseg_core.components.discovery.specs import MeasureSpec


@hookimpl
def moseg_measures():
    return [MeasureSpec(name="broken", target="tests.testing.broken.heavy:spread")]


def spread(part):
    """How far a part extends in all."""
    return float(np.sum(part.scales))
