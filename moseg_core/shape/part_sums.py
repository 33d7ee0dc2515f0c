"""What the core needs to know of every part of a labelling, in one pass over the elements.

For each part: how many elements it has, a 128-bit hash of which they are, and the sums of their
areas, first and second moments. The sums run in element order and never by difference from
another labelling, so that a part's measures depend on its members alone: a value remembered
under the part's hash equals one computed anew, to the last bit.

All kernels take several labellings of the same elements at once, as a search asks for them: to call
a kernel takes as long as it takes to go through a few hundred elements.

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
from moseg_core.types import BoolArray, FloatArray, Int32Array, IntArray


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
    """Counts, membership hashes and moment sums of every part of several labellings.

    Parameters
    ----------
    labels : (B, F) int32
        Part of each element, 0 to n - 1.
    areas : (F,) float
    first : (F, 3) float
        Area times centroid, about the shape's centre.
    second : (F, 6) float
        xx, xy, xz, yy, yz, zz.
    element_hashes : (F, 2) uint64
    counts : (B, n) int64, written
    hashes : (B, n, 2) uint64, written
    moments : (B, n, 10) float, written
        Area, first moments, second moments.
    """
    counts[:] = 0
    hashes[:] = 0
    moments[:] = 0.0
    for b in range(labels.shape[0]):
        for f in range(labels.shape[1]):
            k = labels[b, f]
            counts[b, k] += 1
            hashes[b, k, 0] += element_hashes[f, 0]
            hashes[b, k, 1] += element_hashes[f, 1]
            moments[b, k, 0] += areas[f]
            for j in range(3):
                moments[b, k, 1 + j] += first[f, j]
            for j in range(6):
                moments[b, k, 4 + j] += second[f, j]


@kernel
def find_empty(
    moments: FloatArray, least_area: float, least_spread: float, empty: BoolArray
) -> None:
    """Which parts have no area or no extent.

    Parameters
    ----------
    moments : (n, 10) float
        From :func:`summarize_parts`.
    least_area, least_spread : float
        An area, and a mean square distance from the centroid, that count as none.
    empty : (n,) bool, written
    """
    for k in range(moments.shape[0]):
        area = moments[k, 0]
        empty[k] = True
        if area > least_area:
            x, y, z = moments[k, 1] / area, moments[k, 2] / area, moments[k, 3] / area
            square = (moments[k, 4] + moments[k, 7] + moments[k, 9]) / area
            empty[k] = not square - (x * x + y * y + z * z) > least_spread


@kernel
def summarize_field(
    labels: Int32Array,
    wanted: BoolArray,
    weighted: FloatArray,
    squared: FloatArray,
    least: FloatArray,
    greatest: FloatArray,
    areas: FloatArray,
    middle: float,
    rows: FloatArray,
) -> None:
    """A field over several parts of several labellings: mean, spread and extremes.

    Parameters
    ----------
    labels : (B, F) int32
        Part of each element, 0 to n - 1.
    wanted : (B, n) bool
        The parts to summarize.
    weighted, squared, least, greatest : (F,) float
        Sums and extremes of each element (:class:`moseg_core.components.field.FieldSums`).
    areas : (B, n) float
        Of the parts.
    middle : float
        What the sums are about.
    rows : (B, n, 4) float, written
        Of every wanted part mean, standard deviation, least and greatest value; NaN for the first
        two where it has no area.
    """
    for b in range(labels.shape[0]):
        some = False
        for k in range(wanted.shape[1]):
            if wanted[b, k]:
                some = True
                rows[b, k, 0], rows[b, k, 1] = 0.0, 0.0
                rows[b, k, 2], rows[b, k, 3] = np.inf, -np.inf
        if not some:
            continue
        for f in range(labels.shape[1]):
            k = labels[b, f]
            if wanted[b, k]:
                rows[b, k, 0] += weighted[f]
                rows[b, k, 1] += squared[f]
                rows[b, k, 2] = min(rows[b, k, 2], least[f])
                rows[b, k, 3] = max(rows[b, k, 3], greatest[f])
        for k in range(wanted.shape[1]):
            if wanted[b, k]:
                if areas[b, k] == 0:
                    rows[b, k, 0], rows[b, k, 1] = np.nan, np.nan
                else:
                    mean = rows[b, k, 0] / areas[b, k]
                    variance = rows[b, k, 1] / areas[b, k] - mean * mean
                    rows[b, k, 0] = middle + mean
                    rows[b, k, 1] = np.sqrt(max(variance, 0.0))
