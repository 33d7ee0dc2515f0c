"""Which part of one segmentation meets which part of another, and how much they share.

The contingency table is all that the measures by regions look at: the Rand Index, the consistency
errors and the Hamming distance are sums over it. It is kept as a list of the pairs of parts that
do meet. Two segmentations of a mesh into a part per face would fill a square of billions
otherwise, nearly all of it zeros; the list is never longer than the mesh.

An element that bears no label in either segmentation (:data:`moseg_core.types.UNLABELLED`, -1) is
left out of the table, and so of all measures that follow from it.

An element counts as 1, or as its weight: with the elements' areas as weights nothing depends on
how finely a region happens to be meshed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.errors import UsageError
from moseg_core.types import UNLABELLED, BoolArray, FloatArray, IntArray

# Labels that span at most so many times their number are numbered by counting, not by sorting.
_DENSE = 4


@dataclass(frozen=True, eq=False, kw_only=True)
class Overlap:
    """The pairs of parts that have elements in common; build one with :func:`overlap`.

    Parameters
    ----------
    first, second : (K,) int
        A part of either segmentation, numbered from 0 without gaps; no pair twice.
    shared : (K,) float
        Weight of the elements that the two have in common.
    first_sizes, second_sizes : (A,) and (B,) float
        Weight of each part.
    squares : float
        Sum of the squared weights of the elements: the pairs of an element with itself.
    """

    first: IntArray
    second: IntArray
    shared: FloatArray
    first_sizes: FloatArray
    second_sizes: FloatArray
    squares: float

    @property
    def total(self) -> float:
        """Weight of all elements."""
        return float(self.shared.sum())


def overlap(first: IntArray, second: IntArray, weights: FloatArray | None = None) -> Overlap:
    """Tabulate two segmentations against each other.

    Parameters
    ----------
    first, second : (F,) int
        Part of each element; any integers, of which -1 says that it is in none.
    weights : (F,) float, optional
        What each element counts, such as its area, not negative; 1 by default.

    Returns
    -------
    Overlap

    Raises
    ------
    UsageError
        Arrays of different lengths, or no element with a label in both.

    Examples
    --------
    >>> import numpy as np
    >>> table = overlap(np.array([0, 0, 0, 1]), np.array([7, 7, 9, 9]))
    >>> list(zip(table.first.tolist(), table.second.tolist(), table.shared.tolist()))
    [(0, 0, 2.0), (0, 1, 1.0), (1, 1, 1.0)]
    >>> table.first_sizes.tolist(), table.second_sizes.tolist()
    ([3.0, 1.0], [2.0, 2.0])
    """
    mass = np.ones(len(first)) if weights is None else np.asarray(weights, np.float64)
    if not len(first) == len(second) == len(mass):
        raise UsageError(
            f"labellings of one shape have a label for each of its elements, and weights too;"
            f" these have {len(first)}, {len(second)} and {len(mass)}"
        )
    known = labelled(first, second)
    if not known.any():
        raise UsageError("nothing has a label in both labellings; there is nothing to compare")
    mass = mass[known]
    _, a = _numbered(np.asarray(first)[known])
    kinds, b = _numbered(np.asarray(second)[known])
    width = len(kinds)
    cells, cell = _numbered(a * width + b)
    shared = sums(cell, mass, len(cells))
    row, column = np.divmod(cells, width)
    return Overlap(
        first=row,
        second=column,
        shared=shared,
        # From the cells and not from the elements: a part that is one part of the other has then
        # the very size of its only cell, and differs from it by exactly 0.
        first_sizes=sums(row, shared, 0),
        second_sizes=sums(column, shared, 0),
        squares=float((mass**2).sum()),
    )


def labelled(first: IntArray, second: IntArray) -> BoolArray:
    """Which elements bear a label in both of two labellings.

    Parameters
    ----------
    first, second : (F,) int
        -1 for an element without a label.

    Returns
    -------
    (F,) bool

    Examples
    --------
    >>> import numpy as np
    >>> labelled(np.array([0, -1, 2]), np.array([1, 1, -1])).tolist()
    [True, False, False]
    """
    return np.asarray((np.asarray(first) != UNLABELLED) & (np.asarray(second) != UNLABELLED))


def sums(group: IntArray, values: FloatArray, n_groups: int) -> FloatArray:
    """The sum of the values in each group.

    Parameters
    ----------
    group : (n,) int
        From 0.
    values : (n,) float
    n_groups : int
        How many groups there are at least.

    Returns
    -------
    (n_groups or more,) float
        0 for a group without values.

    Examples
    --------
    >>> import numpy as np
    >>> sums(np.array([0, 2, 0]), np.array([1.0, 2.0, 3.0]), 4).tolist()
    [4.0, 0.0, 2.0, 0.0]
    """
    return np.bincount(group, weights=values, minlength=n_groups).astype(np.float64)


def _numbered(values: IntArray) -> tuple[IntArray, IntArray]:
    """The distinct values, ascending, and for each value its place among them."""
    if len(values) and values.dtype.kind in "iu":
        low = int(values.min())
        span = int(values.max()) - low + 1
        if span <= _DENSE * len(values):
            above = (values - low).astype(np.int64)
            present = np.bincount(above, minlength=span) > 0
            return np.flatnonzero(present) + low, (np.cumsum(present) - 1)[above]
    distinct, place = np.unique(values, return_inverse=True)
    return distinct, place.astype(np.int64)
