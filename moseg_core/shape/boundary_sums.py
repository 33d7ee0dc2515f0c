"""The boundaries of all parts of a labelling: sums over the links that cross from part to part.

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
    labels : (B, F) int32
        Part of each element, 0 to n - 1, in several labellings.
    first, second : (E,) int32
        The two elements of each link.
    values : (E,) float
        Of all links.
    whole : (B, n) float, written
    between : (B, n, n) float, written
        Symmetric; 0 on the diagonal.
    """
    whole[:] = 0.0
    between[:] = 0.0
    for b in range(labels.shape[0]):
        for e in range(first.shape[0]):
            i, j = labels[b, first[e]], labels[b, second[e]]
            if i != j:  # as few are
                whole[b, i] += values[e]
                whole[b, j] += values[e]
                between[b, i, j] += values[e]
                between[b, j, i] += values[e]
