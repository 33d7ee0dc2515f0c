"""Geodesic distances between vertices of a triangle mesh: the first half of Sec. 9.

Three methods, behind one function of a source vertex:

=========  ===================================  ==========================  ==================
method     what it is                           error on usual meshes       asks of the mesh
=========  ===================================  ==========================  ==================
``exact``  windows on edges (libigl)            none                        manifold, no needles
``graph``  shortest paths over Steiner points   0.2 to 1 % too long         nothing
``heat``   a heat flow and a Poisson equation   1 to 2 % on average,        well-shaped triangles
           (libigl)                             10 % in places
=========  ===================================  ==========================  ==================

``exact`` costs more than in proportion to the size of the mesh, ``heat`` next to nothing once its
matrices are factorised. ``auto`` takes ``exact`` on small meshes and ``heat`` on huge ones, where
these meshes allow it, and ``graph`` (:mod:`moseg_mds.paths`) otherwise.

Sources: J. Mitchell, D. Mount, C. Papadimitriou 1987, "The discrete geodesic problem",
doi:10.1137/0216045; K. Crane, C. Weischedel, M. Wardetzky 2013, "Geodesics in heat",
doi:10.1145/2516971.2516977.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import igl
import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core import ShapeError, UsageError
from moseg_mds.paths import path_graph

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

METHODS = ("auto", "exact", "heat", "graph")
"""What may be asked for."""

#: Up to so many triangles ``auto`` can afford exact distances: 30 ms a source.
_SMALL = 2_000

#: From so many triangles on ``auto`` cannot afford shortest paths: 0.5 s a source.
_HUGE = 400_000

#: The least height of a triangle over its longest side that exact geodesics are trusted with.
_SLIM = 1e-6

#: How far distances by heat may be from the shortest paths, in the median, of those.
_TRUST = 0.1


@dataclass(frozen=True, eq=False)
class Solver:
    """A method made ready for one mesh.

    Parameters
    ----------
    method : str
        ``exact``, ``heat`` or ``graph``.
    distances : callable
        From a vertex to the (V,) float distances of all, in the mesh's units.
    """

    method: str
    distances: Callable[[int], FloatArray]


class _UnsuitableError(Exception):
    """Why a method cannot be used on a mesh; ends a sentence that begins with the method."""


def geodesic_distances(
    vertices: npt.ArrayLike,
    triangles: npt.ArrayLike,
    sources: npt.ArrayLike,
    *,
    method: str = "auto",
) -> FloatArray:
    """How far it is from some vertices to all, along the surface.

    Parameters
    ----------
    vertices : (V, 3) array_like of float, model units
        Each position once: a path does not jump from a vertex to another at the same place.
    triangles : (T, 3) array_like of int
    sources : (k,) array_like of int
        Vertices to measure from.
    method : {"auto", "exact", "heat", "graph"}

    Returns
    -------
    (k, V) float, model units
        Not negative, 0 at the source; inf where the surface does not lead.

    Raises
    ------
    UsageError
        There is no such method.
    ShapeError
        The mesh is not good enough for the method asked for, and why; never with ``auto`` or
        ``graph``.

    Examples
    --------
    Over the ridge of a roof:

    >>> roof = [[0, 0, 0], [0, 1, 0], [1, 0, 1], [1, 1, 1], [2, 0, 0], [2, 1, 0]]
    >>> slopes = [[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]]
    >>> geodesic_distances(roof, slopes, [0]).round(6).tolist()
    [[0.0, 1.0, 1.414214, 1.732051, 2.828427, 3.0]]
    """
    points = np.ascontiguousarray(vertices, dtype=np.float64)
    corners = np.ascontiguousarray(triangles, dtype=np.int64)
    solve = distance_solver(points, corners, method)
    numbers = np.asarray(sources, dtype=np.int64).tolist()
    return np.array([solve.distances(source) for source in numbers]).reshape(-1, len(points))


def distance_solver(vertices: FloatArray, triangles: IntArray, method: str = "auto") -> Solver:
    """Make a method ready for a mesh; see :func:`geodesic_distances`.

    Parameters
    ----------
    vertices : (V, 3) float
    triangles : (T, 3) int64
    method : {"auto", "exact", "heat", "graph"}

    Returns
    -------
    Solver
        Of ``auto``, of the method that was chosen.
    """
    if method not in METHODS:
        raise UsageError(f"geodesics='{method}' is not known; allowed are {', '.join(METHODS)}")
    for name in _candidates(len(triangles)) if method == "auto" else [method]:
        try:
            return Solver(name, _MAKERS[name](vertices, triangles))
        except _UnsuitableError as reason:
            if method != "auto":
                raise ShapeError(
                    f"geodesics='{method}' cannot be used: {reason}; take 'graph' or 'auto'"
                ) from None
    raise AssertionError("the graph takes every mesh")


def _candidates(size: int) -> Iterator[str]:
    """What ``auto`` tries, the best first."""
    if size <= _SMALL:
        yield "exact"
    if size >= _HUGE:
        yield "heat"
    yield "graph"


def _exact(vertices: FloatArray, triangles: IntArray) -> Callable[[int], FloatArray]:
    _check_mesh(vertices, triangles)
    everything, nothing = np.arange(len(vertices)), np.empty(0, np.int64)

    def distances(source: int) -> FloatArray:
        at = np.array([source])
        found = igl.exact_geodesic(vertices, triangles, at, nothing, everything, nothing)
        return np.asarray(found)

    return distances


def _heat(vertices: FloatArray, triangles: IntArray) -> Callable[[int], FloatArray]:
    _check_mesh(vertices, triangles)
    data = igl.HeatGeodesicsData()
    igl.heat_geodesics_precompute(vertices, triangles, data)

    def distances(source: int) -> FloatArray:
        found = np.asarray(igl.heat_geodesics_solve(data, np.array([source])))
        return np.asarray(np.maximum(found - found[source], 0.0))

    # A flow over bad triangles goes wrong without a sign of it: compare with paths that cannot.
    paths = path_graph(vertices, triangles, budget=0).distances(0)
    far = paths > 0.05 * paths.max()
    error = float(np.median(np.abs(distances(0)[far] / paths[far] - 1.0)))
    if not error <= _TRUST:  # or not a number
        raise _UnsuitableError(f"on this mesh its distances are {100 * error:.0f} % off")
    return distances


def _graph(vertices: FloatArray, triangles: IntArray) -> Callable[[int], FloatArray]:
    return path_graph(vertices, triangles).distances


_MAKERS = {"exact": _exact, "heat": _heat, "graph": _graph}


def _check_mesh(vertices: FloatArray, triangles: IntArray) -> None:
    """Refuse what libigl would stumble over: its functions check nothing."""
    used = np.zeros(len(vertices), np.bool_)
    used[triangles] = True
    if not used.all():
        raise _UnsuitableError(f"{int((~used).sum())} vertices belong to no triangle")
    ends = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, edge, uses = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    if uses.max() > 2:
        raise _UnsuitableError(f"{int((uses > 2).sum())} edges belong to more than two triangles")
    # Neither leads through a single vertex; libigl says 0 of what it does not reach.
    rows = np.repeat(np.arange(len(triangles)), 3)
    sides = sparse.coo_array((np.ones(len(rows), np.int8), (rows, edge.reshape(-1))))
    pieces, _ = csgraph.connected_components(sides @ sides.T, directed=False)
    if pieces > 1:
        raise _UnsuitableError(f"its triangles are {pieces} pieces that share no edge")
    corners = vertices[triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    slim = np.linalg.norm(normal, axis=1) <= _SLIM * longest**2
    if slim.any():
        raise _UnsuitableError(f"{int(slim.sum())} triangles have almost no area")
