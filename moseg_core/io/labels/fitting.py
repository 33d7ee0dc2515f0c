"""From what a file lists to the elements of a shape.

In this order:

1. Labels of *pieces*, each of which says what it was cut from, go to the element that they are
   pieces of: that label which most of its area has.
2. Labels that come with the *places* of faces belong to the elements that lie there, when most
   elements lie at one: the order of the file plays no role then, which differs where a program
   has sorted faces by part, as a GLB file does. Where the places are others, the shape having
   been moved or scaled, the order counts.
3. As many labels as elements: one each, in order.
4. Labels of *vertices* (as many as there are, or said to be so) go to the faces: each has the
   label that most of its corners have. Corners without a label do not vote; of labels with as
   many corners the one of that corner counts which the face names first.

Anything else is refused, and what the number of labels would fit is said.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.io.labels.listing import Listing, middles
from moseg_core.io.read.checked import file_error
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.types import UNLABELLED, FloatArray, IntArray

# Places that differ by less than this share of the size, or of the greatest coordinate where single
# precision leaves no more, are one.
_CLOSE = 1e-6
_SINGLE = 2.5e-7
# So many elements must lie at places of the file for places to count.
_MOST = 0.5


def fitted(path: Path, listing: Listing, shape: Shape | int) -> tuple[IntArray, tuple[str, ...]]:
    """One label for each element, and what is to be said of how they came there.

    Parameters
    ----------
    path : Path
        For messages.
    listing : Listing
    shape : Shape or int
        Or the number of its elements, where nothing more is known of it.

    Returns
    -------
    labels : (F,) int
        -1 for elements without a label.
    notes : tuple of str

    Raises
    ------
    ShapeError
        The number of labels does not fit; says what it would fit.

    Examples
    --------
    >>> tile = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    >>> labels, notes = fitted(Path("a.seg"), Listing(labels=np.array([5, 5, 2, 2])), tile)
    >>> labels.tolist(), notes
    ([5, 2], ('a.seg: labels of 4 vertices; each face has that of most of its corners',))
    """
    labels = listing.labels
    if isinstance(shape, int | np.integer):
        if len(labels) == shape and listing.of != "vertices":
            return labels, ()
        raise _misfit(path, listing, int(shape), None)
    mesh, n, noun = shape.geometry, shape.n_elements, shape.noun
    source, weights = listing.source, listing.weights
    if (
        source is not None
        and weights is not None
        and len(labels) != n
        and _names_elements(source, n)
    ):
        note = (
            f"{path.name}: labels of {len(labels)} pieces; each {noun} has that of most of its area"
        )
        return heaviest(source, labels, weights, n), (note,)
    placed = _by_place(listing, mesh)
    if placed is not None:
        return _taken(path, labels, placed, noun)
    if len(labels) == n and listing.of != "vertices":
        return labels, ()
    if len(labels) == len(mesh.vertices) and listing.of != "elements":
        if n == len(labels) and not isinstance(mesh, PolygonMesh):
            return labels, ()
        note = f"{path.name}: labels of {len(labels)} vertices; each {noun} has that of most"
        return by_corners(mesh.corners, mesh.offsets, labels), (f"{note} of its corners",)
    raise _misfit(path, listing, n, shape)


def by_corners(corners: IntArray, offsets: IntArray, labels: IntArray) -> IntArray:
    """The label that most corners of each face have.

    Parameters
    ----------
    corners : (C,) int
    offsets : (F + 1,) int
        Face ``f`` has the corners ``corners[offsets[f]:offsets[f + 1]]``.
    labels : (V,) int
        Of vertices; -1 for those without one, which do not count.

    Returns
    -------
    (F,) int
        Of labels that as many corners have, that of the first corner; -1 where no corner has one.

    Examples
    --------
    >>> by_corners(np.array([0, 1, 2, 3]), np.array([0, 4]), np.array([7, 3, -1, 3])).tolist()
    [3]
    """
    face = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    return heaviest(face, labels[corners], np.ones(len(corners)), len(offsets) - 1)


def heaviest(group: IntArray, labels: IntArray, weights: FloatArray, n: int) -> IntArray:
    """Of each group the label of most weight; of labels of equal weight the first.

    Parameters
    ----------
    group : (k,) int
    labels : (k,) int
        -1 has no weight.
    weights : (k,) float
    n : int
        How many groups there are.

    Returns
    -------
    (n,) int
        -1 for a group without a label.

    Examples
    --------
    >>> heaviest(np.array([0, 0, 2]), np.array([4, 1, 1]), np.array([1.0, 2.0, 1.0]), 3).tolist()
    [1, -1, 1]
    """
    known = np.flatnonzero(labels != UNLABELLED)
    found = np.full(n, UNLABELLED, np.int64)
    if not known.size:
        return found
    kinds, kind = np.unique(labels[known], return_inverse=True)
    code = group[known] * len(kinds) + kind.reshape(-1)
    cells, first, cell = np.unique(code, return_index=True, return_inverse=True)
    weight = np.bincount(cell.reshape(-1), weights[known])
    owner = cells // len(kinds)
    order = np.lexsort((first, -weight, owner))
    leads = np.concatenate([[True], owner[order][1:] != owner[order][:-1]])
    best = order[leads]
    found[owner[best]] = kinds[cells[best] % len(kinds)]
    return found


def _names_elements(source: IntArray, n: int) -> bool:
    return bool(source.size) and source.min() >= 0 and source.max() < n


def _by_place(listing: Listing, mesh: Geometry) -> IntArray | None:
    """(F,) int: the listed face at the place of each element, -1 where there is none.

    In order where each listed face lies at its element already; None where places do not count.
    """
    places = listing.places
    if places is None or not len(places) or not isinstance(mesh, PolygonMesh):
        return None
    if not np.isfinite(places).all():
        return None
    points = middles(mesh)
    reach = _CLOSE * float(np.linalg.norm(np.ptp(mesh.vertices[mesh.corners], axis=0)))
    reach += _SINGLE * float(np.abs(points).max())
    if len(points) == len(places) and _near(places - points, reach).all():
        return np.arange(len(places))
    found = _at(places, points, reach)
    if not mesh.is_triangular and (found < 0).any():
        # Polygons that a program cut into triangles: the label of the first that is there.
        pieces = _at(places, mesh.vertices[mesh.triangles].mean(axis=1), reach)
        there = np.flatnonzero((pieces >= 0) & (found[mesh.triangle_polygon] < 0))[::-1]
        found[mesh.triangle_polygon[there]] = pieces[there]
    return found if (found >= 0).mean() >= _MOST else None


def _near(apart: FloatArray, reach: float) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    near: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = np.linalg.norm(apart, axis=1) <= reach
    return near


def _at(places: FloatArray, points: FloatArray, reach: float) -> IntArray:
    """(n,) int: the nearest place to each point, -1 where that is out of reach."""
    from scipy.spatial import cKDTree

    apart, found = cKDTree(places).query(points, distance_upper_bound=max(reach, 1e-300))
    return np.where(np.isfinite(apart), found, -1).astype(np.int64)


def _taken(
    path: Path, labels: IntArray, placed: IntArray, noun: str
) -> tuple[IntArray, tuple[str, ...]]:
    taken = np.where(placed >= 0, labels[placed], UNLABELLED)
    if len(labels) == len(placed) and (placed == np.arange(len(placed))).all():
        return taken, ()
    note = f"{path.name}: its faces are in another order; each {noun} has the label of its place"
    return taken, (note,)


def _misfit(path: Path, listing: Listing, n: int, shape: Shape | None) -> ShapeError:
    """The error that says what the number of labels does not fit, and what it would."""
    count = len(listing.labels)
    if shape is None:
        what = f"has {count} labels but the shape has {n} elements"
        if listing.of == "vertices":
            what = f"has {count} labels of vertices, and how many the shape has is not known"
        return file_error(path, f"{what}; give the labels of this very shape")
    mesh, noun = shape.geometry, shape.noun
    said = "labels of vertices" if listing.of == "vertices" else "labels"
    what = f"has {count} {said} but the shape has {n} {noun}s"
    if not isinstance(mesh, PolygonMesh):
        return file_error(path, f"{what}; give the labels of this very shape")
    n_vertices = len(mesh.vertices)
    ends = np.sort(mesh.edges[0], axis=1)
    n_edges = len(np.unique(ends[:, 0] * (int(mesh.merged.max()) + 1) + ends[:, 1]))
    what = f"{what}, {n_vertices} vertices and {n_edges} edges"
    advice = "give the labels of this very shape"
    if count == n_vertices:
        advice = "its number of vertices, but the file says that these are labels of faces; save"
        advice += " them as labels of vertices"
    elif count == n_edges:
        advice = "so these are labels of edges, as MeshCNN has them; give labels of faces"
    elif count == len(mesh.triangles):
        advice = f"so these are labels of the {count} triangles that its polygons can be cut into;"
        advice += " give a label for each polygon, or the mesh of triangles"
    elif count == int(mesh.merged.max()) + 1:
        advice = f"so these are labels of the {count} vertices that are left where equal ones are"
        advice += " joined; give a label for each face"
    elif abs(count - n) == 1:
        advice = "one is missing or over, perhaps a header; " + advice
    return file_error(path, f"{what}; {advice}")
