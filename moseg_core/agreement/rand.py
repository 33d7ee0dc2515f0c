"""The Rand Index: on how many pairs of elements two segmentations agree.

Two elements lie in one part or in two. The Rand Index is the share of pairs about which both
segmentations say the same; names and numbers of parts play no role, and no part of the one need
be matched with a part of the other. Reported is 1 - RI, so that 0 is best. Most pairs lie apart
in any segmentation into many parts, so that two fine ones agree by chance alone: compare values
only between segmentations into about as many parts.

Rand 1971, doi:10.1080/01621459.1971.10482356; for meshes, by faces, Chen, Golovinskiy and
Funkhouser 2009, doi:10.1145/1531326.1531379. It is the number by which the benchmark ranks.
"""

from __future__ import annotations

from moseg_core.agreement.overlap import Overlap, overlap, sums
from moseg_core.types import FloatArray, IntArray


def rand_index_error(first: IntArray, second: IntArray, weights: FloatArray | None = None) -> float:
    """1 - Rand Index of two segmentations.

    Parameters
    ----------
    first, second : (F,) int
        Part of each element.
    weights : (F,) float, optional
        A pair counts as the product of its elements' weights, such as their areas; all pairs
        alike by default.

    Returns
    -------
    float
        Share of pairs on which the two disagree, 0 to 1; 0 is best.

    Raises
    ------
    UsageError
        Arrays of different lengths, or no element with a label in both.

    Examples
    --------
    >>> import numpy as np
    >>> rand_index_error(np.array([0, 0, 1]), np.array([5, 5, 2]))
    0.0
    >>> round(rand_index_error(np.array([0, 0, 1]), np.array([0, 1, 1])), 6)
    0.666667
    """
    return rand_index_error_of(overlap(first, second, weights))


def rand_index_error_of(table: Overlap) -> float:
    """1 - Rand Index from a table; see :func:`rand_index_error`.

    Examples
    --------
    >>> import numpy as np
    >>> rand_index_error_of(overlap(np.array([0, 0]), np.array([0, 1])))
    1.0
    """
    # Ordered pairs, in the numerator as in the denominator. The two of a pair are in one
    # part of one segmentation, but not in one cell of the table. Taken part by part, so that the
    # difference is exactly 0 for a part that is one part of the other segmentation.
    squared = table.shared**2
    apart = (table.first_sizes**2 - sums(table.first, squared, 0)).sum()
    apart += (table.second_sizes**2 - sums(table.second, squared, 0)).sum()
    pairs = table.total**2 - table.squares
    return float(max(apart, 0.0) / pairs) if pairs > 0 else 0.0
