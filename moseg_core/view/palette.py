"""How parts are told apart: a colour for each.

The first twelve colours are picked by hand and then moved until they stay apart for all readers:
any two of them differ by at least 0.13 in Oklab (Ottosson 2020), and by at least 0.07 as seen
with protanopia, deuteranopia or tritanopia (after Machado, Oliveira and Fernandes 2009,
doi:10.1109/TVCG.2009.113); ``tests/view/test_palette.py`` holds them to it. They differ in
lightness as well as in hue, and none is close to white, black or grey.

From the thirteenth on, each colour is the one furthest from all before it. The colours of n
parts are the first n of one fixed sequence, so that adding a part does not recolour the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError
from moseg_core.types import FloatArray

_PICKED = (
    0x4170D8,  # blue
    0xF5992B,  # orange
    0x12A68D,  # teal
    0xE4E04E,  # yellow
    0xA63A98,  # purple
    0x90C5F5,  # sky
    0xC2371A,  # red
    0x27445A,  # slate
    0xEEB0BC,  # rose
    0xA18A38,  # olive
    0x703222,  # brown
    0xA9EFDB,  # mint
)

# Linear sRGB to cone response, and its cube root to Oklab (Ottosson 2020).
_TO_CONES = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_TO_OKLAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


def part_colors(n: int) -> npt.NDArray[np.uint8]:
    """Colours for n parts, distinct up to several hundred; beyond that they repeat.

    Parameters
    ----------
    n : int
        Number of parts, not negative.

    Returns
    -------
    (n, 3) uint8
        Red, green and blue, sRGB; equal for equal n, and the beginning of those for a larger n.

    Examples
    --------
    >>> part_colors(2).tolist()
    [[65, 112, 216], [245, 153, 43]]
    """
    sequence = _sequence(max(n, len(_PICKED)))
    return sequence[np.arange(n) % len(sequence)]


def linear_light(colors: npt.NDArray[np.uint8]) -> FloatArray:
    """Light in proportion to which sRGB values of 0 to 255 shine, 0 to 1, of the same shape.

    Light is shaded, averaged and stored in glTF files on this scale; sRGB values are not
    proportional to it.

    Examples
    --------
    >>> import numpy as np
    >>> linear_light(np.array([0, 128, 255], np.uint8)).round(3).tolist()
    [0.0, 0.216, 1.0]
    """
    value = np.arange(256) / 255.0
    table = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    light: FloatArray = table[colors]
    return light


def checked_colors(colors: npt.ArrayLike, names: Sequence[str]) -> npt.NDArray[np.uint8]:
    """Colours as a (n, 3) uint8 array, one for each name.

    Parameters
    ----------
    colors : (n, 3) array_like of int, 0 to 255
    names : sequence of str

    Raises
    ------
    UsageError
        Not three integers of 0 to 255 for each name.

    Examples
    --------
    >>> checked_colors([[255, 0, 0]], ["head"]).tolist()
    [[255, 0, 0]]
    """
    array = np.asarray(colors)
    integers = np.issubdtype(array.dtype, np.integer) or array.size == 0
    if array.size != 3 * len(names) or not integers or ((array < 0) | (array > 255)).any():
        raise UsageError(
            f"{len(names)} parts need as many colours, each of three integers of 0 to 255;"
            f" not an array of {array.dtype} of shape {array.shape}"
        )
    return array.reshape(-1, 3).astype(np.uint8)


@cache
def _sequence(n: int) -> npt.NDArray[np.uint8]:
    """List the picked colours and then those furthest from all before, n or all there are."""
    picked = np.array([[c >> 16, c >> 8 & 255, c & 255] for c in _PICKED], np.uint8)
    levels = np.arange(0, 256, 15, dtype=np.uint8)
    grid = np.stack(np.meshgrid(levels, levels, levels, indexing="ij"), axis=-1).reshape(-1, 3)
    oklab = _oklab(grid)
    chroma = np.hypot(oklab[:, 1], oklab[:, 2])
    fit = (oklab[:, 0] > 0.35) & (oklab[:, 0] < 0.9) & (chroma > 0.05) & (chroma < 0.17)
    grid, places = grid[fit], _distance_coordinates(oklab[fit])

    def from_place(place: FloatArray) -> FloatArray:
        gap: FloatArray = np.linalg.norm(places - place, axis=1)
        return gap

    gap = np.full(len(grid), np.inf)
    for place in _distance_coordinates(_oklab(picked)):
        gap = np.minimum(gap, from_place(place))
    colors = list(picked)
    while len(colors) < n and gap.max() > 0.0:
        furthest = int(np.argmax(gap))
        colors.append(grid[furthest])
        gap = np.minimum(gap, from_place(places[furthest]))
    sequence = np.array(colors, np.uint8)
    sequence.setflags(write=False)
    return sequence


def from_oklab(places: FloatArray) -> npt.NDArray[np.uint8]:
    """Oklab to sRGB of 0 to 255; what cannot be shown is cut off at 0 and 255.

    Parameters
    ----------
    places : (n, 3) float
        Lightness, green to red, blue to yellow.

    Examples
    --------
    >>> from_oklab(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])).tolist()
    [[255, 255, 255], [0, 0, 0]]
    """
    cones = (places @ np.linalg.inv(_TO_OKLAB).T) ** 3
    light = np.clip(cones @ np.linalg.inv(_TO_CONES).T, 0.0, 1.0)
    value = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.rint(value * 255.0).astype(np.uint8)


def _oklab(colors: npt.NDArray[np.uint8]) -> FloatArray:
    """(n, 3) sRGB values to Oklab: lightness, green to red, blue to yellow."""
    oklab: FloatArray = np.cbrt(linear_light(colors) @ _TO_CONES.T) @ _TO_OKLAB.T
    return oklab


def _distance_coordinates(oklab: FloatArray) -> FloatArray:
    """Oklab with the axis from green to red halved, of which many readers see little."""
    coordinates: FloatArray = oklab * [1.0, 0.5, 1.0]
    return coordinates
