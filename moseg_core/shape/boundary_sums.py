"""The boundaries of all parts of a labelling: the links that cross, and sums over these.

The twin of :mod:`moseg_core.shape.part_sums` for links (:mod:`moseg_core.shape.links`). Sums run
in the order of the links, a part's own sum included, so that what is said of the boundary of a part
depends on its members alone, and of that between two parts on the members of these two.
"""

from __future__ import annotations

from moseg_core.shape.compiled import kernel
from moseg_core.types import FloatArray, Int32Array


@kernel
def find_crossings(
    labels: Int32Array,
    first: Int32Array,
    second: Int32Array,
    crossings: Int32Array,
    sides: Int32Array,
) -> int:
    """The links between elements of two parts, in their order, and how many they are.

    Few links cross, and several quantities are summed over them.

    Parameters
    ----------
    labels : (F,) int32
        Part of each element, 0 to n - 1.
    first, second : (E,) int32
        The two elements of each link.
    crossings : (E,) int32, written
        Numbers of the links that cross.
    sides : (E, 2) int32, written
        The two parts of each of them.
    """
    count = 0
    for e in range(first.shape[0]):
        p, q = labels[first[e]], labels[second[e]]
        if p != q:
            crossings[count] = e
            sides[count, 0], sides[count, 1] = p, q
            count += 1
    return count


@kernel
def sum_boundaries(
    count: int,
    crossings: Int32Array,
    sides: Int32Array,
    values: FloatArray,
    whole: FloatArray,
    between: FloatArray,
) -> None:
    """Sums over the links that leave each part, and over those between each two.

    Parameters
    ----------
    count : int
        How many links cross.
    crossings, sides : (E,) and (E, 2) int32
        From :func:`find_crossings`.
    values : (E,) float
        Of all links.
    whole : (n,) float, written
    between : (n, n) float, written
        Symmetric; 0 on the diagonal.
    """
    whole[:] = 0.0
    between[:] = 0.0
    for c in range(count):
        p, q, value = sides[c, 0], sides[c, 1], values[crossings[c]]
        whole[p] += value
        whole[q] += value
        between[p, q] += value
        between[q, p] += value
