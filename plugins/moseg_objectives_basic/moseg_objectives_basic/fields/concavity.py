"""Concavity: how sharply the surface turns in, where people see the end of a part.

Along such creases the mind divides shapes into parts, the minima rule of Hoffman and Richards 1984
(doi:10.1016/0010-0277(84)90022-2). Two steps make it a property of the shape rather than of its
triangles:

1. The normals ``N`` of the elements are smoothed over a radius ``r`` by one implicit step of heat
   flow, ``(A + r^2 L) N' = A N``, with the elements' areas ``A`` and the Laplacian ``L`` of finite
   volumes, whose weights are the length of a link over the distance between its ends. Of a crease
   between two planes that leaves ``exp(-|x| / r) / 2 r`` times the difference of their normals.
2. How ``N'`` changes around an element is fitted by a symmetric shape operator ``S``, by least
   squares over its links and its neighbours' (as Rusinkiewicz 2004, doi:10.1109/TDPVT.2004.1335277,
   does over the sides of a triangle).

The value is ``-2 r k`` with the least eigenvalue ``k`` of ``S``, the curvature in the most concave
direction: in a crease that turns by the angle ``t`` about ``2 sin(t / 2)``, on a ball of radius
``R`` it is ``-2 r / R``, on a cylinder and a plane 0.

Of a surface of many elements it is that of some forty thousand groups of them
(:mod:`moseg_objectives_basic.fields.places`), which are smaller than the radius.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import linalg

from moseg_core import Interval, Shape, field_values
from moseg_objectives_basic.fields.places import Places
from moseg_objectives_basic.fields.rays import outward_normals

FloatArray = npt.NDArray[np.float64]

CHEAP, DEAR = 0.15, 1.5
"""Least and greatest weight of a piece of boundary, by its concavity."""

_MOST = 40_000
"""A larger surface is looked at in so many groups: an eighth to a third of the usual radius across,
on a hammer, a cow and a cup."""

_LARGE = 1.5 * _MOST


def concavity(shape: Shape, *, radius: Annotated[float, Interval(1e-4, 1)] = 0.02) -> FloatArray:
    """How concave the surface is, in its most concave direction.

    Parameters
    ----------
    shape : Shape
        A surface of which is known which elements touch, its faces oriented alike.
    radius : float
        Over which distance normals are smoothed, in diagonals of the bounding box. Smaller
        dents do not count.

    Returns
    -------
    (F,) float
        -2 to 2: about 1.4 in a crease where two planes meet at a right angle, 0 on a plane and
        on a cylinder, negative where the surface bulges in all directions.

    Notes
    -----
    The minima rule of Hoffman and Richards 1984, doi:10.1016/0010-0277(84)90022-2. A crease shows
    in the elements along it; it comes out lower where these are larger than the radius.

    On more than 60,000 elements it is that of 40,000 groups of them, whose value all elements of a
    group have.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = moseg.load(moseg.sample_path("horse"))
    >>> values = moseg.field_values(horse, "basic:concavity")
    >>> bool(values.min() >= -2 and 0.3 < values.max() <= 2)
    True
    """
    if shape.n_elements <= _LARGE:
        return _concavity(shape, outward_normals(shape), radius * shape.box_diagonal)
    places = Places.of(shape, _MOST)
    weighted = shape.areas[:, None] * outward_normals(shape)
    count = places.shape.n_elements
    normals: FloatArray = np.stack(
        [np.bincount(places.members, column, count) for column in weighted.T], 1, dtype=np.float64
    )
    normals /= np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None]
    return _concavity(places.shape, normals, radius * shape.box_diagonal)[places.members]


def _concavity(shape: Shape, normals: FloatArray, reach: float) -> FloatArray:
    """(F,) float: :func:`concavity` of elements with these normals; the radius in model units."""
    links = shape.links
    first, second = links.first, links.second
    step = shape.points[second] - shape.points[first]
    apart = np.maximum(np.linalg.norm(step, axis=1), 1e-9 * shape.frame.scale)
    weights = links.lengths / apart
    smooth = _smoothed(shape, normals, weights, reach)
    return np.clip(-2.0 * reach * _least_curvature(shape, smooth, step, weights), -2.0, 2.0)


def uncreased(shape: Shape, *, radius: Annotated[float, Interval(1e-4, 1)] = 0.02) -> FloatArray:
    """How little a boundary is expected here: ``(clip(1 - c, 0.15, 1.5) - 0.15) / 1.35``.

    Parameters
    ----------
    shape : Shape
        As for :func:`concavity`, which is ``c``.
    radius : float
        See :func:`concavity`.

    Returns
    -------
    (F,) float
        0 in a sharp crease (``c`` 0.85 or more), 0.63 where the surface is flat, 1 on a ridge
        that bulges in all directions.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = moseg.load(moseg.sample_path("horse"))
    >>> values = moseg.field_values(horse, "basic:uncreased")
    >>> bool(values.min() >= 0 and values.max() <= 1)
    True
    """
    weight = np.clip(1.0 - field_values(shape, "basic:concavity", radius=radius), CHEAP, DEAR)
    scaled: FloatArray = (weight - CHEAP) / (DEAR - CHEAP)
    return scaled


def _smoothed(shape: Shape, normals: FloatArray, weights: FloatArray, reach: float) -> FloatArray:
    """(F, 3) float: normals after one implicit step of heat flow over the links."""
    first, second, count = shape.links.first, shape.links.second, shape.n_elements
    areas = np.maximum(shape.areas, 1e-9 * shape.areas.mean())
    off = reach**2 * weights
    flow = sparse.csr_array(
        (
            np.concatenate([-off, -off]),
            (np.concatenate([first, second]), np.concatenate([second, first])),
        ),
        shape=(count, count),
    )
    matrix = flow + sparse.diags_array(areas - flow.sum(axis=1))
    # The matrix is symmetric and dominated by its diagonal: no pivots, and little fill.
    factors = linalg.splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    smooth: FloatArray = factors.solve(areas[:, None] * normals)
    return smooth


def _least_curvature(
    shape: Shape, normals: FloatArray, step: FloatArray, weights: FloatArray
) -> FloatArray:
    """(F,) float: least eigenvalue of the shape operator fitted around each element.

    With the steps ``d`` to neighbours, ``M = sum w d d'`` and ``B = sum w dn d'`` in the tangent
    plane, the symmetric ``S`` that fits ``dn = S d`` best solves ``S M + M S = B + B'``: in the
    eigenvectors of ``M`` it is a quotient, entry by entry.
    """
    links = shape.links
    turn = normals[links.second] - normals[links.first]
    adjacency = shape.adjacency
    assert adjacency is not None  # the shape has links
    count = shape.n_elements

    def around(values: FloatArray) -> FloatArray:
        own = np.bincount(links.first, values, count) + np.bincount(links.second, values, count)
        total: FloatArray = own + adjacency.matrix @ own
        return total

    steps = np.empty((count, 3, 3))
    turns = np.empty((count, 3, 3))
    for i in range(3):
        for j in range(3):
            steps[:, i, j] = around(weights * step[:, i] * step[:, j])
            turns[:, i, j] = around(weights * turn[:, i] * step[:, j])
    basis = _tangents(normals)
    spread = basis @ steps @ basis.transpose(0, 2, 1)
    change = basis @ turns @ basis.transpose(0, 2, 1)
    sizes, axes = np.linalg.eigh(spread)
    change = axes.transpose(0, 2, 1) @ (change + change.transpose(0, 2, 1)) @ axes
    # Along a direction in which there are no neighbours nothing is known, and 0 is assumed.
    least = 1e-3 * sizes[:, 1] + np.finfo(float).tiny
    operator = change / (sizes[:, :, None] + sizes[:, None, :] + least[:, None, None])
    curvature: FloatArray = np.linalg.eigvalsh(operator)[:, 0]
    return curvature


def _tangents(normals: FloatArray) -> FloatArray:
    """(F, 2, 3) float: two unit vectors at right angles to each normal."""
    away = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(normals, away)
    first /= np.maximum(np.linalg.norm(first, axis=1), np.finfo(float).tiny)[:, None]
    second = np.cross(normals, first)
    second /= np.maximum(np.linalg.norm(second, axis=1), np.finfo(float).tiny)[:, None]
    return np.stack([first, second], axis=1)
