"""Light and lines; what they come to on a picture is in test_picture.py."""

from __future__ import annotations

import numpy as np

from moseg_core.view.shading import _hollows, _lines


def test_hollows_are_darker_near_what_stands_out():
    depth = np.zeros((120, 120))
    depth[40:80, 40:80] = 60
    depth[:, 110:] = -np.inf
    factor = _hollows(depth, np.isfinite(depth), 3)
    assert factor[60, 36] < 0.9
    assert factor[60, 10] > 0.98
    assert factor[60, 60] == 1.0
    assert (factor[:, 110:] == 1.0).all()


def test_lines_follow_the_samples():
    part = np.zeros((100, 100), np.int32)
    part[:, 50:] = 1
    part[:, 90:] = -1
    depth = np.where(part >= 0, np.arange(100.0)[:, None], -np.inf)
    depth[60:] += 30
    factor = _lines(part, depth, 3)
    # Parts meet at 49 | 50, the outline is 89 | 90, and the step in depth 59 | 60.
    assert np.flatnonzero(factor[20] < 0.2).tolist() == [48, 49, 50, 51]
    assert np.flatnonzero(factor[20] < 1.0).tolist() == [48, 49, 50, 51, 89, 90]
    assert np.flatnonzero(factor[:, 20] < 1.0).tolist() == [59, 60]
