r"""Consistency errors: how far either segmentation is from refining the other.

People cut a shape more or less finely: where one sees an arm, another sees a hand, a forearm and
an upper arm. These measures forgive that. At an element f, the *local refinement error* is the
share of its part in the first segmentation, R(S1, f), that lies outside its part in the second::

    E(S1, S2, f) = |R(S1, f) \ R(S2, f)| / |R(S1, f)|

which is 0 where the part of the first lies within that of the second. Of n elements,

- the global consistency error (GCE) asks that one of the two be the finer everywhere:
  ``min(sum_f E(S1, S2, f), sum_f E(S2, S1, f)) / n``;
- the local one (LCE) lets either be the finer at each place:
  ``sum_f min(E(S1, S2, f), E(S2, S1, f)) / n``, so that it is never greater.

What they forgive they cannot see: one part for everything, and a part for every element, agree
with any segmentation. Read them beside a measure that counts this, such as the Rand Index.

Martin, Fowlkes, Tal and Malik 2001, doi:10.1109/ICCV.2001.937655; for meshes Chen, Golovinskiy
and Funkhouser 2009, doi:10.1145/1531326.1531379. By area, sizes and mean are both weighted here;
the benchmark's own program weights the sizes alone and takes the mean over faces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.agreement.overlap import Overlap, overlap
from moseg_core.types import FloatArray, IntArray


@dataclass(frozen=True)
class Consistency:
    """The two consistency errors of a pair of segmentations.

    Parameters
    ----------
    global_error : float
        GCE, 0 to below 1; 0 is best, where one segmentation refines the other.
    local_error : float
        LCE, 0 to `global_error`; 0 is best, where at each place one refines the other.
    """

    global_error: float
    local_error: float


def consistency_errors(
    first: IntArray, second: IntArray, weights: FloatArray | None = None
) -> Consistency:
    """Global and local consistency error of two segmentations.

    Parameters
    ----------
    first, second : (F,) int
        Part of each element; the order of the two plays no role.
    weights : (F,) float, optional
        What each element counts, in the sizes of parts and in the mean; 1 by default.

    Returns
    -------
    Consistency
        Both 0 where all weights are 0.

    Raises
    ------
    UsageError
        Arrays of different lengths, or no element with a label in both.

    Examples
    --------
    Cutting one of two parts again costs nothing; moving the cut does.

    >>> import numpy as np
    >>> halves = np.array([0, 0, 1, 1])
    >>> consistency_errors(halves, np.array([0, 0, 1, 2]))
    Consistency(global_error=0.0, local_error=0.0)
    >>> consistency_errors(halves, np.array([0, 1, 1, 1]))
    Consistency(global_error=0.25, local_error=0.125)
    """
    return consistency_errors_of(overlap(first, second, weights))


def consistency_errors_of(table: Overlap) -> Consistency:
    """Both errors from a table; see :func:`consistency_errors`.

    Examples
    --------
    >>> import numpy as np
    >>> consistency_errors_of(overlap(np.array([0, 0, 1, 1]), np.array([0, 1, 1, 1]))).global_error
    0.25
    """
    if table.total <= 0:
        return Consistency(0.0, 0.0)
    # All elements of a cell have the same two errors; cells without weight drop out.
    real = table.shared > 0
    shared = table.shared[real]
    forth = 1.0 - shared / table.first_sizes[table.first[real]]
    back = 1.0 - shared / table.second_sizes[table.second[real]]
    whole = min(float(shared @ forth), float(shared @ back))
    return Consistency(whole / table.total, float(shared @ np.minimum(forth, back)) / table.total)
