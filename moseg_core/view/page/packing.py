"""Geometry as a page carries it: small whole numbers, in base64.

A coordinate is one of 65,536 places between the ends of the bounding box, so that an error is below
a hundredth of a pixel on any screen; vertices at one position are one, from which the page works
out normals and edges. Numbers are written least byte first, as one (``u1``), two or four bytes
each.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry
from moseg_core.types import FloatArray, IntArray
from moseg_core.view.page.thinning import Triangles, thinned

#: More triangles than these turn no longer smoothly on a small computer or a phone.
MOST_TRIANGLES = 200_000
#: The same of points, of which one is one vertex, not three.
MOST_POINTS = 300_000

_STEPS = 65535
#: Points that the direction of a surface is estimated from.
_NEAREST = 14


@dataclass(frozen=True, eq=False, kw_only=True)
class Packed:
    """A geometry for the page.

    Parameters
    ----------
    document : dict
        Plain data; ``unpack.js`` reads it.
    corners : (T, 3, 3) float, model units
        The corners of the triangles that are drawn; of points three times the point.
    labels : (T,) int
        Of each triangle or point that is drawn.
    elements : (T,) int
        The element of the shape that each of them is of.
    drawn, known : int
        How many triangles or points are drawn, and how many the shape has.
    """

    document: dict[str, Any]
    corners: FloatArray
    labels: IntArray
    elements: IntArray
    drawn: int
    known: int


def packed(
    geometry: Geometry,
    labels: IntArray,
    *,
    elements: IntArray | None = None,
    most_triangles: int = MOST_TRIANGLES,
    most_points: int = MOST_POINTS,
) -> Packed:
    """Pack a labelled geometry.

    Parameters
    ----------
    geometry : Geometry
    labels : (F,) int
        Of each element, from 0.
    elements : (F,) int, optional
        The element of the shape that each element here is a piece of; itself by default.
    most_triangles, most_points : int
        How many to draw; others are thinned out.
    """
    own = np.arange(geometry.n_elements) if elements is None else elements
    if isinstance(geometry, PointCloud):
        return _packed_points(geometry, labels, own, most_points)
    numbers = geometry.merged[geometry.triangles]
    _, first, corners = np.unique(numbers, return_index=True, return_inverse=True)
    every = Triangles(
        vertices=geometry.vertices[geometry.triangles.reshape(-1)[first]],
        triangles=corners.reshape(-1, 3),
        labels=labels[geometry.triangle_polygon],
        source=np.arange(len(geometry.triangles)),
    )
    left = thinned(every, most=most_triangles)
    kept = np.unique(left.triangles)
    places = left.vertices[kept]
    triangles = np.searchsorted(kept, left.triangles)
    source = own[geometry.triangle_polygon[left.source]]
    document = {
        **_placed(places),
        "triangles": _encoded(triangles.reshape(-1)),
        "labels": _encoded(left.labels),
    }
    if not np.array_equal(source, np.arange(len(source))):
        document["elements"] = _encoded(source)
    return Packed(
        document=document,
        corners=places[triangles],
        labels=left.labels,
        elements=source,
        drawn=len(triangles),
        known=len(geometry.triangles),
    )


def _packed_points(cloud: PointCloud, labels: IntArray, own: IntArray, most: int) -> Packed:
    """The points of a cloud, in file order; of a large one some at equal distances in it."""
    count = cloud.n_elements
    kept = np.arange(count) if count <= most else np.linspace(0, count - 1, most).astype(np.int64)
    # As wide as in point_bodies.py, so that a cloud of even density looks closed.
    size = 2.0 * float(np.sqrt(np.median(cloud.areas) * count / len(kept)))
    document = {
        **_placed(cloud.vertices[kept]),
        "labels": _encoded(labels[kept]),
        "point_size": size,
        "normals": _encoded(np.rint((_normals(cloud, kept) + 1.0) * 127.5).astype(np.int64)),
    }
    if len(kept) < count or not np.array_equal(own, kept):
        document["elements"] = _encoded(own[kept])
    return Packed(
        document=document,
        corners=np.repeat(cloud.vertices[kept][:, None], 3, axis=1),
        labels=labels[kept],
        elements=own[kept],
        drawn=len(kept),
        known=count,
    )


def _normals(cloud: PointCloud, kept: IntArray) -> FloatArray:
    """(3 n,) unit directions across the surface at some points of a cloud, either way.

    Where they are not known, those in which the nearest points are least spread (Hoppe et al. 1992,
    doi:10.1145/133994.134011).
    """
    if cloud.normals is not None:
        given = cloud.normals[kept]
        lengths = np.linalg.norm(given, axis=1, keepdims=True)
        return (given / np.where(lengths > 0.0, lengths, 1.0)).reshape(-1)
    places = cloud.vertices[kept]
    near = cKDTree(places).query(places, k=min(_NEAREST, len(places)))[1].reshape(len(places), -1)
    around = places[near] - places[near].mean(axis=1, keepdims=True)
    around /= max(float(np.abs(around).max()), np.finfo(np.float64).tiny)
    spread = np.einsum("pki,pkj->pij", around, around)
    directions: FloatArray = np.linalg.eigh(spread)[1][:, :, 0]
    return directions.reshape(-1)


def _placed(places: FloatArray) -> dict[str, Any]:
    """The bounding box, and places as steps within it."""
    low, size = places.min(axis=0), np.ptp(places, axis=0)
    steps = np.rint((places - low) / np.where(size > 0.0, size, 1.0) * _STEPS).astype(np.int64)
    return {
        "frame": {"low": low.tolist(), "size": size.tolist()},
        "positions": _encoded(steps.reshape(-1), least_type="u2"),
    }


def _encoded(numbers: IntArray, *, least_type: str = "u1") -> dict[str, str]:
    """Whole numbers in as few bytes each as the largest takes.

    Examples
    --------
    >>> import numpy as np
    >>> _encoded(np.array([1, 2, 258]))
    {'type': 'u2', 'data': 'AQACAAIB'}
    """
    largest = int(numbers.max()) if len(numbers) else 0
    kind = "u1" if largest < 1 << 8 else "u2" if largest < 1 << 16 else "u4"
    kind = max(kind, least_type)
    data = base64.b64encode(numbers.astype(f"<{kind}").tobytes()).decode("ascii")
    return {"type": kind, "data": data}
