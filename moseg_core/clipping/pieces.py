"""Faces divided between their corners, along the cuts of their edges.

A triangle with two labels has two cut edges: the line between the cuts parts one corner from the
other two. One with three labels has three, and is divided about the *junction*, the point that is
equally near to the three centres, or about a point towards it where that lies outside.
A triangle with one cut, next to where a boundary goes over to mesh edges, is divided from the cut
to the corner across: it has to share its neighbour's new vertex.

A cut very near to a vertex is made at the vertex, and the pieces between the two, which have no
extent, are left out. So the divisions below name their corners freely, and a triangle that names
one corner twice is none.

Where an edge stays whole though its ends belong to different parts, the flood has decided
(:mod:`moseg_core.clipping.net`), and what the cuts leave open goes by the face's own label.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.clipping.net import Cuts, Net
from moseg_core.shape.geometry import ranges
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.types import BoolArray, FloatArray, IntArray

#: A cut this near to an end of its edge, in lengths of the edge, is made at the vertex.
_SNAP = 1e-4

#: How far from the sides to divide a triangle whose junction lies outside; barycentric.
_ROOM = 0.05


@dataclass(frozen=True, eq=False, kw_only=True)
class Pieces:
    """A divided mesh.

    Parameters
    ----------
    mesh : PolygonMesh
    labels, source : (K,) int
        The part of each polygon and the polygon that it was cut from.
    """

    mesh: PolygonMesh
    labels: IntArray
    source: IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class _Cut:
    """Triangles with equally many cuts.

    Parameters
    ----------
    triangle : (T,) int
        Their numbers in the mesh.
    corner : (T, 3) int
        Vertices, turned so that the cuts are where a division expects them.
    node : (T, 3) int
        The vertex at the cut between each corner and the next; meaningless where there is none.
    label : (T, 3) int
        The part of each corner; may be -1.
    own : (T,) int
        The label of the face.
    """

    triangle: IntArray
    corner: IntArray
    node: IntArray
    label: IntArray
    own: IntArray

    def turned(self, first: IntArray) -> _Cut:
        """The same triangles, each from another first corner on."""
        turn = (first[:, None] + np.arange(3)) % 3
        corner, node, label = (
            np.take_along_axis(array, turn, axis=1)
            for array in (self.corner, self.node, self.label)
        )
        return _Cut(triangle=self.triangle, corner=corner, node=node, label=label, own=self.own)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Division:
    """What triangles are divided into: as many smaller ones for each of them.

    Parameters
    ----------
    triangle : (T,) int
    corners : (T, k, 3) int
    labels : (T, k) int
    """

    triangle: IntArray
    corners: IntArray
    labels: IntArray

    @classmethod
    def of(cls, cut: _Cut, *pieces: tuple[tuple[IntArray, ...], IntArray]) -> _Division:
        """From the three corners and the label of each piece."""
        corners = [np.stack(piece, axis=1) for piece, _ in pieces]
        labels = [label for _, label in pieces]
        return cls(
            triangle=cut.triangle,
            corners=np.stack(corners, axis=1),
            labels=np.stack(labels, axis=1),
        )


def divide(net: Net, cuts: Cuts) -> Pieces:
    """Divide the faces of a mesh along cuts of its edges."""
    mesh = net.mesh
    sides = cuts.cut[net.edge]
    count = sides.sum(axis=1)
    label = cuts.label[net.corner]
    own = net.label[mesh.triangle_polygon]

    fresh = cuts.cut & (cuts.where > _SNAP) & (cuts.where < 1.0 - _SNAP)
    t = cuts.where[fresh][:, None]
    low, high = mesh.vertices[net.vertex[net.ends[fresh]]].swapaxes(0, 1)
    vertices = np.concatenate([mesh.vertices, (1.0 - t) * low + t * high])
    node = _nodes(net, cuts, fresh)

    def having(k: int) -> _Cut:
        chosen = np.flatnonzero(count == k)
        return _Cut(
            triangle=chosen,
            corner=mesh.triangles[chosen],
            node=node[chosen],
            label=label[chosen],
            own=own[chosen],
        )

    one, two, three = having(1), having(2), having(3)
    one = one.turned(sides[one.triangle].argmax(axis=1))
    two = two.turned((sides[two.triangle].argmin(axis=1) + 2) % 3)
    share = _junctions(net, three, cuts)
    middle = len(vertices) + np.arange(len(share))
    inner = np.einsum("tk,tkd->td", share, mesh.vertices[three.corner])
    vertices = np.concatenate([vertices, inner])
    divisions = [
        _divide_once(one),
        _divide_twice(two, vertices, net.near_face[mesh.triangle_polygon[two.triangle]]),
        _divide_thrice(three, middle),
    ]

    settled = (label == label[:, :1]).all(axis=1) & (label[:, 0] >= 0)
    whole = np.where(settled, label[:, 0], own)
    return _assembled(mesh, vertices, whole, divisions)


def _nodes(net: Net, cuts: Cuts, fresh: BoolArray) -> IntArray:
    """(T, 3) int: the vertex at the cut of each side, a corner where the cut is at one."""
    number = np.full(len(fresh), -1, np.int64)
    number[fresh] = len(net.mesh.vertices) + np.arange(int(fresh.sum()))
    triangles = net.mesh.triangles
    at_low = cuts.where[net.edge] < 0.5
    starts_low = net.corner == net.ends[net.edge, 0]
    snapped = np.where(at_low == starts_low, triangles, np.roll(triangles, -1, axis=1))
    return np.where(fresh[net.edge], number[net.edge], snapped)


def _junctions(net: Net, cut: _Cut, cuts: Cuts) -> FloatArray:
    """(T, 3) float: barycentric coordinates of a point inside each triangle with three cuts."""
    starts_low = net.corner[cut.triangle] == net.ends[net.edge[cut.triangle], 0]
    where = cuts.where[net.edge[cut.triangle]]
    along = np.where(starts_low, where, 1.0 - where)
    # The mean of corners and cuts: never on a side, wherever the cuts are.
    middle = (2.0 - along + np.roll(along, 1, axis=1)) / 6.0
    corners = net.places[net.corner[cut.triangle]]
    found = net.boundaries.junction(corners, cut.label, middle)
    # Where it lies outside, as far towards it as there is room.
    found = np.where(np.isfinite(found).all(axis=1, keepdims=True), found, middle)
    beyond = found < _ROOM
    room = np.divide(middle - _ROOM, middle - found, out=np.ones_like(found), where=beyond)
    towards = middle + room.min(axis=1, keepdims=True) * (found - middle)
    return np.where(found.min(axis=1, keepdims=True) > _SNAP, found, towards)


def _divide_once(cut: _Cut) -> _Division:
    """From the cut between corners 0 and 1 to corner 2.

    Corner 2 belongs to neither side, so that only the label of the face can tell whether it has
    to do with this boundary at all.
    """
    (a, b, c), p = cut.corner.T, cut.node[:, 0]
    concerned = (cut.own[:, None] == cut.label[:, :2]).any(axis=1)
    first, second = (np.where(concerned, cut.label[:, k], cut.own) for k in (0, 1))
    return _Division.of(cut, ((a, p, c), first), ((p, b, c), second))


def _divide_twice(cut: _Cut, vertices: FloatArray, near: FloatArray) -> _Division:
    """Corner 0 from the other two, which leaves a quadrangle.

    Corners 1 and 2 mostly have one label. If not, the flood parted them; the face's own label
    decides or, if it is that of neither, the nearer centre.
    """
    (a, b, c), p, q = cut.corner.T, cut.node[:, 0], cut.node[:, 2]
    # The shorter diagonal; but one from a cut that was made at corner 0 runs along a side, and
    # would leave the other cut in the middle of a triangle's edge.
    shorter = _lengths(vertices, b, q) < _lengths(vertices, p, c)
    other = np.where(p == a, q != a, (q != a) & shorter)
    first, second = cut.label[:, 1], cut.label[:, 2]
    rows = np.arange(len(cut.own))
    nearer = np.where(near[rows, first] <= near[rows, second], first, second)
    rest = np.where((cut.own == first) | (cut.own == second), cut.own, nearer)
    rest = np.where(first == second, first, rest)
    return _Division.of(
        cut,
        ((a, p, q), cut.label[:, 0]),
        ((p, b, np.where(other, q, c)), rest),
        ((np.where(other, b, p), c, q), rest),
    )


def _divide_thrice(cut: _Cut, middle: IntArray) -> _Division:
    """Each corner with a quadrangle that reaches to the middle."""
    pieces = []
    for k in range(3):
        corner, label = cut.corner[:, k], cut.label[:, k]
        pieces.append(((corner, cut.node[:, k], middle), label))
        pieces.append(((cut.node[:, k - 1], corner, middle), label))
    return _Division.of(cut, *pieces)


def _lengths(vertices: FloatArray, one: IntArray, other: IntArray) -> FloatArray:
    apart = vertices[one] - vertices[other]
    lengths: FloatArray = np.einsum("td,td->t", apart, apart)
    return lengths


def _assembled(
    mesh: PolygonMesh,
    vertices: FloatArray,
    whole: IntArray,
    divisions: list[_Division],
) -> Pieces:
    """Polygons that nothing divides as they were, of others their triangles or pieces of these.

    Parameters
    ----------
    mesh : PolygonMesh
    vertices : (W, 3) float
    whole : (T,) int
        The label of each triangle that is not divided; written.
    divisions : list of _Division
    """
    pieces = np.concatenate([d.corners.reshape(-1, 3) for d in divisions])
    label = np.concatenate([d.labels.reshape(-1) for d in divisions])
    triangle = np.concatenate([np.repeat(d.triangle, d.labels.shape[1]) for d in divisions])
    # What lies between a vertex and a cut that was made at it has no extent.
    proper = (pieces != np.roll(pieces, -1, axis=1)).all(axis=1)
    parted = np.bincount(triangle[proper], minlength=len(mesh.triangles)) > 1
    # One piece is all of its triangle: the cuts were made at corners, or two corners are in one
    # place and there is no inside to divide.
    only = proper & ~parted[triangle]
    whole[triangle[only]] = label[only]

    face = mesh.triangle_polygon
    first = np.searchsorted(face, np.arange(mesh.n_polygons))
    touched = np.zeros(mesh.n_polygons, np.bool_)
    touched[face[parted | (whole != whole[first][face])]] = True
    untouched = np.flatnonzero(~touched)
    loose = np.flatnonzero(touched[face] & ~parted)
    kept = proper & parted[triangle]
    pieces = np.concatenate([mesh.triangles[loose], pieces[kept]])
    label = np.concatenate([whole[loose], label[kept]])
    triangle = np.concatenate([loose, triangle[kept]])

    source = np.concatenate([untouched, face[triangle]])
    order = np.lexsort((np.concatenate([first[untouched], triangle]), source))
    sizes = np.concatenate([np.diff(mesh.offsets)[untouched], np.full(len(pieces), 3)])
    corners = np.concatenate([mesh.corners[ranges(mesh.offsets, untouched)], pieces.reshape(-1)])
    triangles = np.concatenate([mesh.triangles[~touched[face]], pieces])
    return Pieces(
        mesh=PolygonMesh(
            vertices=vertices,
            corners=corners[ranges(_starts(sizes), order)],
            offsets=_starts(sizes[order]),
            triangles=triangles[ranges(_starts(sizes - 2), order)],
            triangle_polygon=np.repeat(np.arange(len(order)), sizes[order] - 2),
        ),
        labels=np.concatenate([whole[first[untouched]], label])[order],
        source=source[order],
    )


def _starts(sizes: IntArray) -> IntArray:
    """(k + 1,) int: where rows of these sizes begin, and the last ends."""
    starts = np.zeros(len(sizes) + 1, np.int64)
    np.cumsum(sizes, out=starts[1:])
    return starts
