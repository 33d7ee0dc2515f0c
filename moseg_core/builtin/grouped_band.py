"""The band of a large shape in groups, for a first cut in large steps.

A minimum cut takes longer than its elements are many, and a wide band has most elements of a shape.
So the cut is found on groups of elements first, and then, element by element, in a narrow band
around it (Lombaert, Sun, Grady and Xu 2005, doi:10.1109/ICCV.2005.13). A group is connected, and
its elements have one label and are all free to change it or all not; what it costs under a label,
and what it costs to cut between two groups, are sums over elements and links: a labelling of groups
costs what the labelling of their elements does.

:mod:`moseg_core.builtin.graph_cut` goes by way of groups where a band (:class:`Band`) has many
elements; :mod:`moseg_core.builtin.swaps` makes the cuts on either.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.builtin.band import Band
from moseg_core.builtin.swaps import Energy
from moseg_core.shape.adjacency import Adjacency
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.links import Links
from moseg_core.shape.shape import Shape
from moseg_core.types import BoolArray, Int32Array, IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class GroupedBand:
    """Groups of all elements of a shape, those of a band among them.

    Parameters
    ----------
    members : (F,) int
        The group of each element.
    labels : (G,) int32
        The label of each group.
    links : Links
        Between groups, with the summed lengths.
    elements : (k,) int
        The groups in the band, ascending.
    energy : Energy
        Of these.
    """

    members: IntArray
    labels: Int32Array
    links: Links
    elements: IntArray
    energy: Energy

    @classmethod
    def of(
        cls, shape: Shape, labels: Int32Array, band: Band, energy: Energy, *, most: int
    ) -> GroupedBand:
        """The groups for a labelling and its band.

        Parameters
        ----------
        shape : Shape
        labels : (F,) int32
        band : Band
            Of the labelling.
        energy : Energy
            Of the elements in the band.
        most : int
            About how many groups of elements there would be if labels played no role.

        Examples
        --------
        >>> corners = [[x, y, 0] for x in range(11) for y in (0, 1)]
        >>> row = Shape.from_mesh(corners, [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1]
        ...                                 for k in range(10)])
        >>> labels = np.array([0] * 4 + [1] * 6, np.int32)
        >>> from moseg_core.shape.pins import NO_PINS
        >>> band = Band.of(row, labels, 2, width=1.0, pins=NO_PINS)
        >>> energy = Energy(costs=band.distances, first=band.first, second=band.second,
        ...                 weights=np.ones(len(band.links)))
        >>> found = GroupedBand.of(row, labels, band, energy, most=2)
        >>> found.labels[found.members].tolist() == labels.tolist()
        True
        """
        free = np.zeros(shape.n_elements, np.bool_)
        free[band.elements] = np.isfinite(energy.costs).sum(axis=1) > 1
        members = _groups(shape, labels, free, coarsen(shape, most))
        count = int(members.max()) + 1
        of_group = np.empty(count, labels.dtype)
        of_group[members] = labels
        elements, own = np.unique(members[band.elements], return_inverse=True)
        within = Links(
            first=energy.first.astype(np.int32),
            second=energy.second.astype(np.int32),
            lengths=energy.weights,
        ).grouped(own, energy.weights, len(elements))
        costs = [np.bincount(own, column, len(elements)) for column in energy.costs.T]
        return cls(
            members=members,
            labels=of_group,
            links=shape.links.grouped(members, shape.links.lengths, count),
            elements=elements,
            energy=Energy(
                costs=np.stack(costs, axis=1),
                first=within.first.astype(np.int64),
                second=within.second.astype(np.int64),
                weights=within.lengths,
            ),
        )


def _groups(shape: Shape, labels: Int32Array, free: BoolArray, coarse: Shape) -> IntArray:
    """(F,) int: connected groups of elements of one super-element, with one label, free or not."""
    assert coarse.members is not None  # a coarse shape
    kinds = np.stack([coarse.members, labels, free], axis=1)
    first, second = shape.links.first, shape.links.second
    alike = (kinds[first] == kinds[second]).all(axis=1)
    pairs = np.stack([first[alike], second[alike]], axis=1)
    return Adjacency.from_pairs(pairs, len(labels)).components()[1]
