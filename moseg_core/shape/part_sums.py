"""What the core needs to know of every part of a labelling, in one pass over the elements.

For each part: how many elements it has, a 128-bit hash of which they are, and the sums of their
areas, first and second moments. The sums run in element order and never by difference from
another labelling, so that a part's measures depend on its members alone: a value remembered
under the part's hash equals one computed anew, to the last bit.

The hash is the sum, modulo 2**64 and twice with different constants, of a mixed element number (the
finaliser of SplitMix64; Steele, Lea, Flood 2014, doi:10.1145/2660193.2660195). It does not depend
on the order of the elements or on the process. Since it is a sum, the hash of a super-element
(:mod:`moseg_core.shape.coarse`) is that of its members, and equal parts have equal hashes on every
level.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.shape.compiled import kernel
from moseg_core.types import FloatArray, Int32Array, IntArray


@kernel
def _mix(x: Any) -> Any:
    """SplitMix64's finaliser, a bijection of the 64-bit integers."""
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return x ^ (x >> np.uint64(31))


@kernel
def hash_elements(hashes: npt.NDArray[np.uint64]) -> None:
    """The two hashes of each element's number.

    Parameters
    ----------
    hashes : (F, 2) uint64, written
    """
    for f in range(hashes.shape[0]):
        number = np.uint64(f + 1)
        hashes[f, 0] = _mix(number * np.uint64(0x9E3779B97F4A7C15))
        hashes[f, 1] = _mix(number * np.uint64(0xD1B54A32D192ED03) + np.uint64(1))


@kernel
def summarize_parts(
    labels: Int32Array,
    areas: FloatArray,
    first: FloatArray,
    second: FloatArray,
    element_hashes: npt.NDArray[np.uint64],
    counts: IntArray,
    hashes: npt.NDArray[np.uint64],
    moments: FloatArray,
) -> None:
    """Counts, membership hashes and moment sums of every part.

    Parameters
    ----------
    labels : (F,) int32
        Part of each element, 0 to n - 1.
    areas : (F,) float
    first : (F, 3) float
        Area times centroid, about the shape's centre.
    second : (F, 6) float
        xx, xy, xz, yy, yz, zz.
    element_hashes : (F, 2) uint64
    counts : (n,) int64, written
    hashes : (n, 2) uint64, written
    moments : (n, 10) float, written
        Area, first moments, second moments.
    """
    counts[:] = 0
    hashes[:] = 0
    moments[:] = 0.0
    for f in range(labels.shape[0]):
        k = labels[f]
        counts[k] += 1
        hashes[k, 0] += element_hashes[f, 0]
        hashes[k, 1] += element_hashes[f, 1]
        moments[k, 0] += areas[f]
        for j in range(3):
            moments[k, 1 + j] += first[f, j]
        for j in range(6):
            moments[k, 4 + j] += second[f, j]


@kernel
def summarize_field(
    labels: Int32Array,
    weighted: FloatArray,
    squared: FloatArray,
    least: FloatArray,
    greatest: FloatArray,
    sums: FloatArray,
) -> None:
    """Sums and extremes of a field over every part (:mod:`moseg_core.components.field`).

    Parameters
    ----------
    labels : (F,) int32
        Part of each element, 0 to n - 1.
    weighted, squared : (F,) float
        Area times value, area times value squared, of each element.
    least, greatest : (F,) float
        Of the values in each element; infinite where an element has no area.
    sums : (n, 4) float, written
        The two sums, the least and the greatest value.
    """
    sums[:, 0] = 0.0
    sums[:, 1] = 0.0
    sums[:, 2] = np.inf
    sums[:, 3] = -np.inf
    for f in range(labels.shape[0]):
        k = labels[f]
        sums[k, 0] += weighted[f]
        sums[k, 1] += squared[f]
        sums[k, 2] = min(sums[k, 2], least[f])
        sums[k, 3] = max(sums[k, 3], greatest[f])
