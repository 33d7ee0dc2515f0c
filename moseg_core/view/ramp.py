"""A ramp of colours for numbers: from dark violet over teal to light yellow.

Equal steps of a number are equal steps to the eye: the ramp is a curve in Oklab (Ottosson 2020,
:mod:`moseg_core.view.palette`), walked at a constant speed. Lightness grows all the way, so that
the order is seen with every kind of colour vision, and in print; hue turns by half a circle at a
constant chroma, the greatest for which every colour on the way can be shown.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt

from moseg_core.types import FloatArray
from moseg_core.view.palette import from_oklab

#: From the dark end to the light one.
_LIGHTNESS, _HUES, _CHROMA = (0.36, 0.93), (290.0, 105.0), 0.1


@cache
def ramp(n: int = 256) -> npt.NDArray[np.uint8]:
    """Colours from low to high.

    Parameters
    ----------
    n : int
        How many, 2 or more.

    Returns
    -------
    (n, 3) uint8
        Red, green and blue, sRGB; read-only.

    Examples
    --------
    >>> ramp(3).tolist()
    [[62, 49, 109], [41, 160, 163], [241, 236, 157]]
    """
    colors = from_oklab(curve(n))
    colors.setflags(write=False)
    return colors


def curve(n: int) -> FloatArray:
    """(n, 3) float: places on the ramp at equal distances along it, in Oklab."""
    share = np.linspace(0.0, 1.0, 4096)
    hue = np.radians(_HUES[0] + share * (_HUES[1] - _HUES[0]))
    lightness = _LIGHTNESS[0] + share * (_LIGHTNESS[1] - _LIGHTNESS[0])
    places = np.column_stack([lightness, _CHROMA * np.cos(hue), _CHROMA * np.sin(hue)])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    walked = np.concatenate([[0.0], steps.cumsum()])
    wanted = np.linspace(0.0, walked[-1], n)
    return np.column_stack([np.interp(wanted, walked, column) for column in places.T])


def shades(values: FloatArray, n: int = 256) -> npt.NDArray[np.int64]:
    """For each value the number of its colour, 0 for the least and ``n - 1`` for the greatest.

    Where all values are equal, the middle one.

    Examples
    --------
    >>> shades(np.array([1.0, 3.0, 2.0]), 5).tolist(), shades(np.ones(2), 5).tolist()
    ([0, 4, 2], [2, 2])
    """
    low, high = float(values.min()), float(values.max())
    if not high > low:
        return np.full(len(values), n // 2, np.int64)
    found: npt.NDArray[np.int64] = np.rint((values - low) / (high - low) * (n - 1)).astype(np.int64)
    return found
