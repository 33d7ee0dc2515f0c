"""The boundaries of all parts of a labelling, in one pass over the links.

The twin of :mod:`moseg_core.shape.part_sums` for links (:mod:`moseg_core.shape.links`). Sums run
in the order of the links, a part's own sum included, so that what is said of the boundary of a part
depends on its members alone, and of that between two parts on the members of these two.
"""

from __future__ import annotations

from moseg_core.shape.compiled import kernel
from moseg_core.types import FloatArray, Int32Array


@kernel
def sum_boundaries(
    labels: Int32Array,
    first: Int32Array,
    second: Int32Array,
    values: FloatArray,
    whole: FloatArray,
    between: FloatArray,
) -> None:
    """Sums over the links that leave each part, and over those between each two.

    Parameters
    ----------
    labels : (F,) int32
        Part of each element, 0 to n - 1.
    first, second : (E,) int32
        The two elements of each link.
    values : (E,) float
    whole : (n,) float, written
    between : (n, n) float, written
        Symmetric; 0 on the diagonal.
    """
    whole[:] = 0.0
    between[:] = 0.0
    for e in range(first.shape[0]):
        p, q = labels[first[e]], labels[second[e]]
        if p != q:
            whole[p] += values[e]
            whole[q] += values[e]
            between[p, q] += values[e]
            between[q, p] += values[e]
