"""Boundaries into creases: the least cut in a narrow band around where the search has left them.

People cut a shape along its creases (Hoffman and Richards 1984, doi:10.1016/0010-0277(84)90022-2),
and straight across where there are none. In a band on both sides of the present boundaries
(:mod:`moseg_core.builtin.band`) the labels are chosen anew such that what is cut is least, a link
counting for its length times

    w = clip(1 - crease c, 0.15, 1.5),

``c`` being the concavity along the link, of a field that a bundle brings: a cut along a crease is
cheap, one along a ridge dear (Katz and Tal 2003, doi:10.1145/882262.882369, who search a band by a
minimum cut as well). Without such a field a link counts for its length. Elements outside of the
band keep their labels. On a smooth surface any cut that is a little shorter would do, however far
away, so that an element pays for another label:

    keep A d / band,

``A`` its area and ``d`` how far it is from the part that it goes to, from 0 to ``band``. All
lengths are in diagonals of the bounding box. Where the problem says of places how well a label fits
them (:mod:`moseg_core.builtin.data_term`), an element pays for that too, ``data`` times; by default
it does not. Labels are exchanged by :mod:`moseg_core.builtin.swaps`, one pair of parts that touch
after another; in a band of many elements by groups first (:mod:`moseg_core.builtin.grouped_band`),
and then by elements near the cut that was found.

The defaults were chosen on models of the Princeton Segmentation Benchmark. There they bring Voronoi
partitions nearer to what people say, on average from 0.157 to 0.128 by 1 - Rand Index, and take one
person's own segmentation a little away from the others', from 0.100 to 0.104: they are for
boundaries that are not where they should be. Where how likely places are had been learned from four
other models of a category, on average from 0.150 to 0.123; with ``band=0.2`` to 0.103, and with
``data=2`` besides to 0.093. Boundaries may move further where something is known of places.

Parts stay what they are, whatever is cheaper: the inner half of each keeps its label, and so do
pinned elements; what would break a part into more pieces than it has is not done.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.builtin.band import Band, depths
from moseg_core.builtin.data_term import place_costs, place_terms
from moseg_core.builtin.grouped_band import GroupedBand
from moseg_core.builtin.swaps import Energy
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import field_values
from moseg_core.components.parameters import Interval
from moseg_core.components.protocols import Evaluator, Progress, Report
from moseg_core.components.requirements import LackError, demand
from moseg_core.errors import ShapeError, UsageError
from moseg_core.shape.links import Links
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, IntArray

#: Least and greatest weight of a link for its length.
_WEIGHTS = (0.15, 1.5)
#: The field that is gone by where the user names none.
_CONCAVITY = "basic:concavity"
_LENGTHS_ALONE = "go by lengths alone with graph_cut(field=none)"
#: A band of more elements is cut in groups first, about so many as there are places of fields.
_MANY, _GROUPS = 20_000, 10_000
#: How far from a cut between groups elements may still change, in extents of a group.
_BESIDE = 2.0
#: Most times to go through all pairs of parts; it ends before when nothing changes any more.
_SWEEPS = 10


class GraphCut:
    """The least cut in a band around the boundaries, along creases where there are some.

    Parameters
    ----------
    band : float
        How far boundaries may move, in diagonals of the bounding box.
    keep : float
        How dear it is to move them: per area and distance over ``band``, in diagonals.
    crease : float
        How much cheaper a link is for its concavity.
    field : str or None
        The field that says how concave the surface is; none for lengths alone. ``auto`` is
        ``basic:concavity`` where that bundle is installed and the shape has what the field needs;
        elsewhere lengths alone, and a warning says so.
    data : float
        How much it counts what the problem says of places, per area: the terms whose value is the
        mean of a field, such as ``likely``, times their weights.
    """

    def __init__(
        self,
        *,
        band: Annotated[float, Interval(0, 1)] = 0.05,
        keep: Annotated[float, Interval(0)] = 2.0,
        crease: Annotated[float, Interval(0)] = 2.0,
        field: str | None = "auto",
        data: Annotated[float, Interval(0)] = 0.0,
    ) -> None:
        self.band = band
        self.keep = keep
        self.crease = crease
        self.field = field
        self.data = data

    def check(self, evaluator: Evaluator) -> str:
        """Refuse a shape of which nobody knows what touches, or that lacks a field asked for.

        Returns
        -------
        str
            Why lengths alone are gone by, where a field would be if it could, and that the problem
            says nothing of places, where it should count; else empty.

        Raises
        ------
        ShapeError
            No links, or a field needs what the shape does not have.
        UsageError
            No installed bundle has a field.
        PluginError
            An objective cannot say which field it is the mean of, or a field fails.
        """
        said = [self._weights(evaluator)[1]]
        if self.data > 0 and not place_terms(evaluator.problem):
            said.append(
                "refiner 'graph_cut' has no data to go by: no term of the problem is the mean of a"
                " field; 'data' counts for nothing"
            )
        elif self.data > 0:
            place_costs(evaluator.problem, _own(evaluator.shape), np.zeros(0, np.int64))
        return "; ".join(filter(None, said))

    def __call__(self, evaluator: Evaluator, labels: Int32Array, *, report: Report) -> Int32Array:
        """(F,) int32: the labels, boundaries moved within the band."""
        shape, n = _own(evaluator.shape), evaluator.parameterization.n_parts
        if shape.adjacency is None:
            return labels.copy()
        weights, _ = self._weights(evaluator)
        band = Band.of(shape, labels, n, width=self.band, pins=evaluator.pins)
        energy = Energy(
            costs=self._costs(evaluator, shape, band),
            first=band.first,
            second=band.second,
            weights=weights[band.links],
        )
        most = count_pieces(shape.links, labels, n)
        refined, elements = labels.copy(), band.elements
        if len(elements) > _MANY:
            groups = GroupedBand.of(shape, labels, band, energy, most=_GROUPS)
            found, stop = _divided(
                groups.labels, groups.elements, groups.energy, groups.links, most, report
            )
            refined = found[groups.members]
            if stop:
                return refined
            near = depths(shape, refined, _reach(shape))[elements] < np.inf
            kept, energy = energy.narrowed(refined[elements].astype(np.int64), near)
            elements = elements[kept]
        return _divided(refined, elements, energy, shape.links, most, report)[0]

    def _costs(self, evaluator: Evaluator, shape: Shape, band: Band) -> FloatArray:
        """(k, n) float: what each element of a band costs under each label; see :class:`Energy`."""
        allowed = np.isfinite(band.distances)
        size = shape.frame.scale ** (3 if shape.solid else 2)
        areas = self.keep / max(self.band, 1e-300) * shape.areas[band.elements] / size
        costs = areas[:, None] * np.where(allowed, band.distances, 0.0)
        if self.data > 0:
            data = place_costs(evaluator.problem, shape, band.elements)
            # What an element costs under any of its labels is no reason to choose one of them; and
            # an energy has no negative costs.
            data -= np.where(allowed, data, np.inf).min(axis=1, keepdims=True)
            costs += self.data * (shape.areas[band.elements] / size)[:, None] * data
        return np.where(allowed, costs, np.inf)

    def _weights(self, evaluator: Evaluator) -> tuple[FloatArray, str]:
        """(E,) float, what it costs to cut each link of the shape, in diagonals; what to say."""
        shape = _own(evaluator.shape)
        links = shape.links
        lengths = links.lengths / shape.frame.scale ** (2 if shape.solid else 1)
        if self.field is None:
            return lengths, ""
        name = _CONCAVITY if self.field == "auto" else self.field
        lookup = Lookup(evaluator.problem.registry)
        try:
            found = lookup.field(name)
            demand(shape, found.requires, f"field '{found.id}'", instead=_LENGTHS_ALONE)
            values = field_values(shape, name, lookup=lookup)
        except (ShapeError, UsageError) as error:
            if self.field == "auto":
                said = f"refiner 'graph_cut' goes by lengths alone, not along creases: {error}"
                return lengths, said
            said = f"refiner 'graph_cut' goes by the field '{self.field}': {error}"
            if not isinstance(error, LackError):
                said += f"; install the bundle that it is of, or {_LENGTHS_ALONE}"
            raise type(error)(said) from error
        concavity = (values[links.first] + values[links.second]) / 2
        weights: FloatArray = lengths * np.clip(1 - self.crease * concavity, *_WEIGHTS)
        return weights, ""


def _divided(
    labels: Int32Array,
    elements: IntArray,
    energy: Energy,
    links: Links,
    most: IntArray,
    report: Report,
) -> tuple[Int32Array, bool]:
    """The labels after swaps of all pairs of parts, until nothing changes any more.

    Parameters
    ----------
    labels : (F,) int32
    elements : (k,) int
        Those that the energy is of.
    energy : Energy
    links : Links
        Between all elements.
    most : (n,) int
        In how many pieces each part may be.
    report : callable

    Returns
    -------
    labels : (F,) int32
    stop : bool
        Whether the report asked to stop.
    """

    def unbroken(changed: Int32Array) -> bool:
        return bool((count_pieces(links, changed, len(most)) <= most).all())

    refined, stop = labels, False
    # How a pair is divided depends on which elements bear its two labels, and on nothing else,
    # and a cut that was carried out is found again. So a pair has its next turn when one of its
    # labels has changed: `changed` has the last turn at which each label did, `divided` the
    # last of each pair.
    turn, changed, divided = 0, np.zeros(len(most), np.int64), dict[tuple[int, int], int]()
    for sweep in range(_SWEEPS):
        before = refined
        for pair in energy.touching(refined[elements].astype(np.int64)):
            if divided.get(pair, -1) >= changed[[*pair]].max():
                continue
            turn += 1
            after, whole = _swapped(refined, elements, energy, pair, unbroken)
            if (after != refined).any():
                changed[[*pair]] = turn
            divided[pair] = turn if whole else turn - 1
            refined = after
        stop = report(Progress(stage="graph_cut", done=sweep + 1))
        if stop or (refined == before).all():
            break
    return refined, stop


def _swapped(
    labels: Int32Array,
    elements: IntArray,
    energy: Energy,
    pair: tuple[int, int],
    unbroken: Callable[[Int32Array], bool],
) -> tuple[Int32Array, bool]:
    """The elements of two parts divided anew, as far as that breaks no part.

    Returns
    -------
    labels : (F,) int32
    whole : bool
        Whether all of the cut that is an improvement was carried out: once more, nothing changes.
    """
    local = labels[elements].astype(np.int64)
    swapped = energy.swapped(local, *pair)
    groups = energy.improvements(local, swapped)

    def with_changes(before: Int32Array, chosen: IntArray) -> Int32Array:
        after = before.copy()
        after[elements[chosen]] = swapped[chosen]
        return after

    if not groups:
        return labels, True
    if unbroken(after := with_changes(labels, np.concatenate(groups))):
        return after, True
    for group in groups:
        if unbroken(after := with_changes(labels, group)):
            labels = after
    return labels, False


def _reach(shape: Shape) -> float:
    """How far from a cut between groups elements may change their label, in diagonals."""
    each = shape.area / _GROUPS
    extent = np.cbrt(each) if shape.solid else np.sqrt(each)
    return float(_BESIDE * extent / shape.frame.scale)


def _own(shape: Shape) -> Shape:
    """The shape as the user gave it, of an embedded one."""
    return shape if shape.original is None else shape.original


def count_pieces(links: Links, labels: Int32Array, n_parts: int) -> IntArray:
    """(n,) int: in how many connected pieces each part is.

    Examples
    --------
    >>> chain = Links(first=np.array([0, 1], np.int32), second=np.array([1, 2], np.int32),
    ...               lengths=np.ones(2))
    >>> count_pieces(chain, np.array([0, 1, 0], np.int32), 2).tolist()
    [2, 1]
    """
    whole = labels[links.first] == labels[links.second]
    first, second = links.first[whole], links.second[whole]
    graph = sparse.csr_array(
        (np.ones(len(first), np.int8), (first, second)), shape=(len(labels), len(labels))
    )
    count, piece = csgraph.connected_components(graph, directed=False)
    label_of = np.empty(count, labels.dtype)
    label_of[piece] = labels
    pieces: IntArray = np.bincount(label_of, minlength=n_parts)
    return pieces
