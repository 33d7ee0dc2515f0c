"""Remoteness: how far an element is from everywhere else, along the surface.

The mean distance to the whole surface over its least value (Hilaga, Shinagawa, Kohmura and Kunii
2001, doi:10.1145/383259.383282): 1 in the middle, and largest at the tips. It does not change when
a limb bends, as distances along the surface do not.

Distances go from middle to middle of neighbouring groups of elements
(:mod:`moseg_objectives_basic.fields.places`), also to the neighbours' neighbours: along a grid of
squares alone, a diagonal would be 1.41 times too long. The surface that they go to is taken at
fewer places than those that they come from: each stands for the area around it, which changes a
mean by some two thousandths at most, on models of nine kinds. Elements have a mean over the groups
around them, the nearer the more, so that values do not jump from one group to the next.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core import Shape
from moseg_objectives_basic.fields.places import Places

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_MOST = 1500
"""From how many places distances are found at most."""

_TO = 400
"""To how many of them."""

_BEYOND = 1.5
"""How far what is not connected is, in greatest distances."""


def remoteness(shape: Shape) -> FloatArray:
    """Mean distance to the whole surface over its least value.

    Parameters
    ----------
    shape : Shape
        Of which is known which elements touch.

    Returns
    -------
    (F,) float
        1 in the middle, and as a rule not above 3: on a long rod it is 2 at the ends. What is in
        another component counts as 1.5 times the greatest distance there is. 1 everywhere on a
        shape of one element.

    Notes
    -----
    After Hilaga et al. 2001, doi:10.1145/383259.383282, who subtract the least value instead of
    dividing by it. On more than 1500 elements distances come from as many groups, and on more
    than 400 they go to so many of these.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = moseg.load(moseg.sample_path("horse"))
    >>> values = moseg.field_values(horse, "basic:remoteness")
    >>> bool(0.99 < values.min() < 1.1 < 1.5 < values.max() < 3)
    True
    """
    places = Places.of(shape, _MOST)
    groups = places.shape
    graph = _distances_to_neighbours(groups)
    to = Places.of(groups, _TO)
    distances = csgraph.dijkstra(graph, indices=to.chosen)  # both ways alike
    reached = np.isfinite(distances)
    distances[~reached] = _BEYOND * distances[reached].max()
    means = to.shape.areas @ distances
    least = means.min()
    if not least > 0:
        return np.ones(shape.n_elements)
    means /= least
    return means if groups is shape else _spread(shape, places, means)


def _distances_to_neighbours(groups: Shape) -> sparse.csr_array:
    """(K, K) sparse: straight distances to neighbours and to theirs, model units."""
    assert groups.adjacency is not None  # required of the shape
    touching = groups.adjacency.matrix.astype(np.int32)
    near = (touching + touching @ touching).tocoo()
    apart = near.row != near.col
    rows, columns = near.row[apart], near.col[apart]
    lengths = np.linalg.norm(groups.points[rows] - groups.points[columns], axis=1)
    # A length of 0 would be no link at all.
    lengths = np.maximum(lengths, 1e-12 * groups.frame.scale)
    return sparse.csr_array((lengths, (rows, columns)), shape=near.shape)


def _spread(shape: Shape, places: Places, values: FloatArray) -> FloatArray:
    """(F,) float: for each element the mean over its group and the groups beside it.

    By the inverse of the squared distance to their middles.
    """
    adjacency = places.shape.adjacency
    assert adjacency is not None
    members = places.members
    beside = np.diff(adjacency.indptr)[members]
    element = np.concatenate([np.arange(len(members)), np.repeat(np.arange(len(members)), beside)])
    start = np.repeat(adjacency.indptr[members] - np.cumsum(beside) + beside, beside)
    group = np.concatenate([members, adjacency.indices[start + np.arange(len(start))]])
    squared = ((shape.points[element] - places.shape.points[group]) ** 2).sum(axis=1)
    weights = 1.0 / np.maximum(squared, 1e-12 * shape.frame.scale**2)
    total = np.bincount(element, weights, len(members))
    spread: FloatArray = np.bincount(element, weights * values[group], len(members)) / total
    return spread
