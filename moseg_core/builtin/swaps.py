"""Swaps of two labels by a minimum cut: the best division between two parts of what both may have.

A labelling is judged by two sums: what each element costs under its label, and the weights of the
links that are cut, those between elements of different labels. For two labels the labelling of
least cost is a minimum cut of a graph: the elements, joined by their links, between a source that
stands for the one label and a sink that stands for the other. For more labels an *alpha-beta swap*
divides all elements of two labels between these two in the best way, the others left alone; swaps
of one pair after another never raise the cost (Boykov, Veksler and Zabih 2001,
doi:10.1109/34.969114, Sec. 4). An element that may not have a label has an infinite cost there.

:mod:`moseg_core.builtin.graph_cut` moves boundaries with it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.types import BoolArray, FloatArray, IntArray

#: What all capacities of a cut add up to, as whole numbers: scipy's flows are of 32 bits.
_CAPACITY = 2.0**30
#: What must be gained by a change, as a share of the cost, or it is none but of rounding.
_GAIN = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class Energy:
    """What labellings of k elements by n labels cost.

    Parameters
    ----------
    costs : (k, n) float
        Of each element under each label, 0 or more; infinite where it may not have it.
    first, second : (E,) int
        The elements that each link joins.
    weights : (E,) float
        What it costs to cut a link, 0 or more.

    Examples
    --------
    Three elements in a row; the link between the last two is cheaper to cut.

    >>> row = Energy(costs=np.array([[0, np.inf], [0, 0], [np.inf, 0]]),
    ...              first=np.array([0, 1]), second=np.array([1, 2]), weights=np.array([2.0, 1.0]))
    >>> row.of(np.array([0, 1, 1])), row.swapped(np.array([0, 1, 1]), 0, 1).tolist()
    (2.0, [0, 0, 1])
    """

    costs: FloatArray
    first: IntArray
    second: IntArray
    weights: FloatArray

    def of(self, labels: IntArray) -> float:
        """What a (k,) labelling costs."""
        own = self.costs[np.arange(len(labels)), labels].sum()
        cut = labels[self.first] != labels[self.second]
        return float(own + self.weights[cut].sum())

    def touching(self, labels: IntArray) -> list[tuple[int, int]]:
        """Pairs of labels, ascending, that some link joins."""
        ends = np.sort(np.stack([labels[self.first], labels[self.second]], axis=1), axis=1)
        pairs = np.unique(ends[ends[:, 0] != ends[:, 1]], axis=0)
        return [(a, b) for a, b in pairs.tolist()]

    def swapped(self, labels: IntArray, a: int, b: int) -> IntArray:
        """(k,) int: the elements of two labels divided between these in the best way.

        Capacities are rounded to whole numbers, so that a labelling may come out that is dearer
        than another by about a billionth of all weights.

        Parameters
        ----------
        labels : (k,) int
        a, b : int
            The two labels.
        """
        of_two = (labels == a) | (labels == b)
        free = of_two & np.isfinite(self.costs[:, a]) & np.isfinite(self.costs[:, b])
        elements = np.flatnonzero(free)
        if not len(elements):
            return labels
        number = np.full(len(labels), -1)
        number[elements] = np.arange(len(elements))
        as_a, as_b = self.costs[elements, a].copy(), self.costs[elements, b].copy()
        for one, other in ((self.first, self.second), (self.second, self.first)):
            rim = free[one] & ~free[other]  # links to what stays as it is
            beyond, weights = labels[other[rim]], self.weights[rim]
            as_a += np.bincount(number[one[rim]], weights * (beyond != a), len(elements))
            as_b += np.bincount(number[one[rim]], weights * (beyond != b), len(elements))
        inner = free[self.first] & free[self.second]
        cut = _cut(
            as_a,
            as_b,
            number[self.first[inner]],
            number[self.second[inner]],
            self.weights[inner],
        )
        swapped = labels.copy()
        swapped[elements] = np.where(cut, b, a)
        return swapped

    def narrowed(self, labels: IntArray, free: BoolArray) -> tuple[IntArray, Energy]:
        """The same of some elements and their neighbours, where no others may change.

        Parameters
        ----------
        labels : (k,) int
            What the others keep.
        free : (k,) bool
            Those that may change their label.

        Returns
        -------
        elements : (j,) int
            Those that are left, ascending.
        energy : Energy
            Of these: less than that of all by what the others cost.
        """
        inside = free.copy()
        inside[self.first[free[self.second]]] = True
        inside[self.second[free[self.first]]] = True
        elements = np.flatnonzero(inside)
        number = np.full(len(labels), -1)
        number[elements] = np.arange(len(elements))
        kept = inside[self.first] & inside[self.second]
        costs = np.where(free[elements, None], self.costs[elements], np.inf)
        rows = np.arange(len(elements))
        costs[rows, labels[elements]] = self.costs[elements, labels[elements]]
        return elements, Energy(
            costs=costs,
            first=number[self.first[kept]],
            second=number[self.second[kept]],
            weights=self.weights[kept],
        )

    def improvements(self, labels: IntArray, changed: IntArray) -> list[IntArray]:
        """The changes that are worth it, each for itself.

        Elements that change and are linked change together; of groups that are not, each lowers or
        raises the cost whatever becomes of the others.

        Parameters
        ----------
        labels, changed : (k,) int
            Before and after.

        Returns
        -------
        list of (j,) int
            Groups of elements whose change lowers the cost, the most first.
        """
        moved = labels != changed
        elements = np.flatnonzero(moved)
        if not len(elements):
            return []
        joint = moved[self.first] & moved[self.second]
        size = len(labels)
        graph = sparse.csr_array(
            (np.ones(int(joint.sum()), np.int8), (self.first[joint], self.second[joint])),
            shape=(size, size),
        )
        count, group = csgraph.connected_components(graph, directed=False)
        saved = self.costs[elements, labels[elements]] - self.costs[elements, changed[elements]]
        found = np.bincount(group[elements], saved, count)
        before = labels[self.first] != labels[self.second]
        after = changed[self.first] != changed[self.second]
        ends = np.where(moved[self.first], self.first, self.second)
        found += np.bincount(group[ends], self.weights * (before * 1.0 - after), count)
        worth = np.flatnonzero(found > _GAIN * self.of(labels))
        return [
            elements[group[elements] == g] for g in worth[np.argsort(-found[worth], kind="stable")]
        ]


def _cut(
    as_a: FloatArray, as_b: FloatArray, first: IntArray, second: IntArray, weights: FloatArray
) -> BoolArray:
    """(k,) bool: which elements are on the second side of a minimum cut.

    Elements are numbered from 0; the source, k, is the first label and the sink, k + 1, the second:
    to take the second means to cut the edge from the source, which costs what it costs under it.
    """
    k = len(as_a)
    both = np.minimum(as_a, as_b)
    elements, source, sink = np.arange(k), np.full(k, k), np.full(k, k + 1)
    rows = np.concatenate([source, elements, first, second])
    columns = np.concatenate([elements, sink, second, first])
    values = np.concatenate([as_b - both, as_a - both, weights, weights])
    total = values.sum()
    if total <= 0:
        return np.zeros(k, np.bool_)
    capacity = sparse.csr_array(
        (np.rint(values * (_CAPACITY / total)).astype(np.int32), (rows, columns)),
        shape=(k + 2, k + 2),
    )
    capacity.sum_duplicates()
    capacity.eliminate_zeros()
    flow = csgraph.maximum_flow(capacity, k, k + 1).flow
    left = capacity - flow
    left.eliminate_zeros()
    reached = csgraph.breadth_first_order(left, k, return_predecessors=False)
    beyond = np.ones(k + 2, np.bool_)
    beyond[reached] = False
    return beyond[:k]
