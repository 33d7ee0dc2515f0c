"""A shape in fewer, larger elements, so that the search does not grow with the mesh.

Partitions (Sec. 4) need of an element only where it is and which it touches, and the measures of a
part only sums over its elements. So elements can be grouped: :func:`coarsen` contracts the element
graph into about `n` connected super-elements of similar size, each with the sums of its members'
areas and moments, and the sum of their hashes. The result is a
:class:`~moseg_core.shape.shape.Shape` again, over which parameterizations, seeders and the
evaluator work unchanged.

Nothing is lost but the choice of boundaries: a part made of super-elements consists of certain
input elements, and :mod:`moseg_core.components.part` says about it what it would say of a part made
of those. :mod:`moseg_core.search.segment` searches on the coarse shape and finishes on the whole
one.

Pieces grow from seeds along the graph (:mod:`moseg_core.shape.grow`). Seeds are first spread
over the surface by area along a space-filling curve, then moved to the middle of their pieces a
few times. Where the adjacency is not known, or the surface is in very many bits, elements
near each other in space count as touching for this purpose. A large mesh is grouped in two steps,
by way of :data:`MIDDLE` super-elements, and what was grouped is kept with the shape: fields, search
and polish ask for several numbers of super-elements of one shape.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_array, csgraph

from moseg_core.shape.adjacency import Adjacency
from moseg_core.shape.nearest import nearest_points
from moseg_core.shape.pins import NO_PINS, Pins
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, IntArray

MIDDLE = 40_000
"""By way of so many super-elements shapes of clearly more elements are grouped."""

WORTH = 1.5
"""Super-elements are used where there are fewer of them by this factor."""

_ROUNDS = 3
_NEAR = 6


def coarsen(shape: Shape, n_elements: int = 2000, *, pins: Pins = NO_PINS) -> Shape:
    """A shape whose elements are connected groups of the given shape's.

    Parameters
    ----------
    shape : Shape
        Of input elements.
    n_elements : int
        About how many super-elements to make; there is at least one for each connected component,
        unless the components are more than half as many.
    pins : Pins, optional
        Elements pinned to different labels do not come into one super-element.

    Returns
    -------
    Shape
        With :attr:`~moseg_core.shape.shape.Shape.fine` and
        :attr:`~moseg_core.shape.shape.Shape.members`. The same for the same shape in every run.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = moseg.load(moseg.sample_path("horse"))
    >>> coarse = coarsen(horse, 500)
    >>> coarse.n_elements, coarse.resolution, int(coarse.sizes.sum()) == horse.n_elements
    (500, 'coarse500', True)
    """
    key = ("coarse", n_elements, pins.elements.tobytes(), pins.labels.tobytes())
    if key not in shape.made_from:
        resolution = f"coarse{n_elements}"
        middle = _middle(shape, n_elements, pins)
        if middle is None:
            members = _in_one_step(shape, n_elements, pins)
            made = grouped(shape, members, resolution)
        else:
            assert middle.members is not None  # a coarse shape
            groups = _in_one_step(middle, n_elements, coarse_pins(pins, middle))
            made = grouped(shape, groups[middle.members], resolution, by_way_of=(middle, groups))
        shape.made_from[key] = made
    kept: Shape = shape.made_from[key]
    return kept


def _middle(shape: Shape, n: int, pins: Pins) -> Shape | None:
    """By way of which groups a large shape is grouped; None where that is done in one step."""
    if shape.n_elements <= WORTH * MIDDLE or n > MIDDLE // 2:
        return None
    middle = coarsen(shape, MIDDLE, pins=pins)
    # Else a surface in very many bits.
    return middle if shape.n_elements > WORTH * middle.n_elements else None


def _in_one_step(shape: Shape, n: int, pins: Pins) -> IntArray:
    """(F,) int: the group of each element, numbered from 0."""
    from moseg_core.shape.grow import grow_pieces, middle_elements

    points = np.ascontiguousarray(shape.unit_points)
    graph = _graph(shape, n)
    members = np.empty(shape.n_elements, np.int64)
    seeds = _spread(points, shape.areas, n)
    for _ in range(_ROUNDS):
        pieces = grow_pieces(points, graph.indptr, graph.indices, seeds, members)
        seeds = middle_elements(points, shape.areas, members, pieces)
    grow_pieces(points, graph.indptr, graph.indices, seeds, members)
    return _separate(members, pins, graph)


def grouped(
    shape: Shape,
    members: IntArray,
    resolution: str,
    *,
    by_way_of: tuple[Shape, IntArray] | None = None,
) -> Shape:
    """The shape over given groups of its elements.

    Parameters
    ----------
    shape : Shape
        Of input elements.
    members : (F,) int
        The group of each element, 0 to K - 1, each at least once.
    resolution : str
        What to call it in memo keys.
    by_way_of : (Shape, (K',) int), optional
        A shape of smaller groups, and the group that each of those is in: what groups touch is
        found faster so.
    """
    count = int(members.max()) + 1
    areas = _sums(members, shape.areas[:, None], count)[:, 0]
    first = _sums(members, shape.first_moments, count)
    mean = _sums(members, shape.points - shape.frame.center, count)
    mean /= np.bincount(members, minlength=count)[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        middle = np.where(areas[:, None] > 0, first / areas[:, None], mean)
    adjacency = None
    if shape.adjacency is not None:
        finer, of_finer = (shape, members) if by_way_of is None else by_way_of
        assert finer.adjacency is not None  # that of groups of the shape
        adjacency = finer.adjacency.grouped(of_finer, count)
    return replace(
        shape,
        points=middle + shape.frame.center,
        areas=areas,
        first_moments=first,
        second_moments=_sums(members, shape.second_moments, count),
        adjacency=adjacency,
        resolution=resolution,
        original=None if shape.original is None else grouped(shape.original, members, resolution),
        fine=shape,
        members=members,
    )


def coarse_pins(pins: Pins, coarse: Shape) -> Pins:
    """Pins on the super-elements that hold pinned elements.

    Parameters
    ----------
    pins : Pins
        On input elements.
    coarse : Shape
        Made by :func:`coarsen` with these pins, so that no super-element gets two labels.
    """
    assert coarse.members is not None  # a coarse shape
    elements, first = np.unique(coarse.members[pins.elements], return_index=True)
    return Pins(elements=elements, labels=pins.labels[first])


def _sums(members: IntArray, rows: FloatArray, count: int) -> FloatArray:
    """(count, k) float: sums of (F, k) rows by group, in element order."""
    columns = [np.bincount(members, column, count) for column in rows.T]
    return np.ascontiguousarray(np.stack(columns, axis=1))


def _spread(points: FloatArray, areas: FloatArray, n: int) -> IntArray:
    """(k,) int: up to `n` different elements, with equal areas between them along a curve.

    The curve goes through the cells of a grid in Morton order, so that what is near along it is
    near in space.
    """
    cell = np.clip((points + 0.5) * 1024, 0, 1023).astype(np.int64)
    place = _spaced(cell[:, 0]) | _spaced(cell[:, 1]) << 1 | _spaced(cell[:, 2]) << 2
    order = np.argsort(place, kind="stable")
    run = np.cumsum(areas[order])
    wanted = (np.arange(n) + 0.5) / n * run[-1]
    places = np.unique(np.searchsorted(run, wanted).clip(max=len(points) - 1))
    chosen: IntArray = order[places]
    return chosen


def _spaced(x: IntArray) -> IntArray:
    """The ten bits of each number, two zeros between neighbours."""
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        x = (x | (x << shift)) & mask
    return x


def _graph(shape: Shape, n: int) -> Adjacency:
    """Along which pieces grow: the adjacency, or nearness where that would give too many."""
    known = shape.adjacency
    if known is not None and known.components()[0] <= n // 2:
        return known
    near = min(_NEAR + 1, shape.n_elements)
    found = nearest_points(shape.unit_points, near)[1]
    pairs = np.stack([np.repeat(np.arange(len(found)), near), found.reshape(-1)], axis=1)
    if known is not None:
        rows = np.repeat(np.arange(shape.n_elements), np.diff(known.indptr))
        pairs = np.concatenate([pairs, np.stack([rows, known.indices], axis=1)])
    return Adjacency.from_pairs(pairs, shape.n_elements)


def _separate(members: IntArray, pins: Pins, graph: Adjacency) -> IntArray:
    """The groups, those that hold pins of several labels cut into connected pieces that do not."""
    pinned = np.unique(np.stack([members[pins.elements], pins.labels], axis=1), axis=0)
    groups, labels = np.unique(pinned[:, 0], return_counts=True)
    if not (labels > 1).any():
        return members
    kind = np.full(len(members), -1, np.int64)
    kind[pins.elements] = pins.labels
    kind[~np.isin(members, groups[labels > 1])] = -1
    rows = np.repeat(np.arange(len(members)), np.diff(graph.indptr)).astype(np.int32)
    columns: Int32Array = graph.indices
    same = (members[rows] == members[columns]) & (kind[rows] == kind[columns])
    edges = (np.ones(int(same.sum()), np.int8), (rows[same], columns[same]))
    whole = coo_array(edges, shape=(len(members), len(members)))
    component: IntArray = csgraph.connected_components(whole, directed=False)[1].astype(np.int64)
    return component
