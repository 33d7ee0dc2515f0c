r"""The Hamming distance: how much lies outside the best match of each part.

The directional Hamming distance from S1 to S2 matches every part of S2 with the part of S1 that
overlaps it most, and sums what lies outside::

    D(S1 => S2) = sum over the parts P of S2 of |P \ Q|,  Q the part of S1 that shares most with P

It is 0 where S1 does not cut any part of S2. With S2 the truth this is what S1 fails to hold
together, the *missing rate*; the other way round it is what S1 puts together that the truth holds
apart, the *false alarm rate*; the distance is the mean of the two. Too many parts show as
missing, too few as false alarm. Several parts may be matched with the same one, so that for very
coarse or very fine results one of the two rates is 0 by itself: look at both.

Huang and Dom, "Quantitative methods of evaluating image segmentation", ICIP 1995; by area and for
meshes Chen, Golovinskiy and Funkhouser 2009, doi:10.1145/1531326.1531379.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.agreement.overlap import Overlap, overlap
from moseg_core.types import FloatArray, IntArray


@dataclass(frozen=True)
class Hamming:
    """The two rates of a found segmentation against a true one, and their mean.

    Parameters
    ----------
    distance : float
        Mean of the rates, 0 to below 1; 0 is best.
    missing : float
        Share of the weight in true parts that lies outside the found part that fits each best.
    false_alarm : float
        Share of the weight in found parts that lies outside the true part that fits each best.
    """

    distance: float
    missing: float
    false_alarm: float


def hamming_distance(
    found: IntArray, truth: IntArray, weights: FloatArray | None = None
) -> Hamming:
    """Hamming distance of a segmentation from a true one, with its two rates.

    Parameters
    ----------
    found, truth : (F,) int
        Part of each element. Exchanging them exchanges the rates.
    weights : (F,) float, optional
        What each element counts; the benchmark takes the areas. 1 by default.

    Returns
    -------
    Hamming
        All 0 where all weights are 0.

    Raises
    ------
    UsageError
        Arrays of different lengths, or no element with a label in both.

    Examples
    --------
    >>> import numpy as np
    >>> hamming_distance(np.array([0, 1, 2, 2]), np.array([0, 0, 1, 1]))
    Hamming(distance=0.125, missing=0.25, false_alarm=0.0)
    """
    return hamming_distance_of(overlap(found, truth, weights))


def directional_hamming(
    first: IntArray, second: IntArray, weights: FloatArray | None = None
) -> float:
    """Directional Hamming distance from one segmentation to another.

    Parameters
    ----------
    first, second : (F,) int
        Part of each element.
    weights : (F,) float, optional
        What each element counts; 1 by default.

    Returns
    -------
    float
        Weight, in the unit of `weights`, that in some part of `second` lies outside the part of
        `first` that overlaps it most; 0, where `second` refines `first`, to the total weight.

    Raises
    ------
    UsageError
        Arrays of different lengths, or no element with a label in both.

    Examples
    --------
    >>> import numpy as np
    >>> directional_hamming(np.array([0, 1, 2, 2]), np.array([0, 0, 1, 1]))
    1.0
    """
    table = overlap(first, second, weights)
    return _outside(table.second, table.shared, table.second_sizes)


def hamming_distance_of(table: Overlap) -> Hamming:
    """All three from a table of found against true parts; see :func:`hamming_distance`.

    Examples
    --------
    >>> import numpy as np
    >>> hamming_distance_of(overlap(np.array([0, 1]), np.array([0, 0]))).missing
    0.5
    """
    if table.total <= 0:
        return Hamming(0.0, 0.0, 0.0)
    missing = _outside(table.second, table.shared, table.second_sizes) / table.total
    false_alarm = _outside(table.first, table.shared, table.first_sizes) / table.total
    return Hamming((missing + false_alarm) / 2.0, missing, false_alarm)


def _outside(part: IntArray, shared: FloatArray, sizes: FloatArray) -> float:
    """Weight of all parts without the greatest cell of each."""
    greatest = np.zeros(len(sizes))
    np.maximum.at(greatest, part, shared)
    return float((sizes - greatest).sum())
