"""Signed distances to smooth solids: lofts along curves, and their blends.

A shape is made of one primitive, the *loft*: an oval swept along a curve, whose two half-axes
change on the way. Limbs, trunks, handles and hammer heads are all lofts. Blending two of them by
a smooth minimum leaves a fillet in the joint, as in a grown or a cast thing.

A field takes (n, 3) points and gives (n,) distances, negative inside. The distances are exact to
first order: an implicit function divided by the length of its gradient. So they can be trusted
near the surface, where the smallest of them decides which part a face belongs to.

Only ``+ - * /``, ``sqrt`` and comparisons are used, without matrix products: these are rounded
alike on all machines, so that the samples can be made again byte for byte.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
Field: TypeAlias = Callable[[FloatArray], FloatArray]
Row: TypeAlias = tuple[float, float, float, float, float]


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Row-wise scalar product of (..., 3) arrays, summed in a fixed order."""
    product: FloatArray = a * b
    return product[..., 0] + product[..., 1] + product[..., 2]


def normalized(a: FloatArray) -> FloatArray:
    """Rows of a (..., 3) array brought to length 1."""
    return a / np.sqrt(dot(a, a))[..., None]


def smooth_min(a: FloatArray, b: FloatArray, width: float) -> FloatArray:
    """Take the smaller of a and b, rounded off where they differ by less than `width`."""
    overlap = np.maximum(width - np.abs(a - b), 0.0)
    return np.minimum(a, b) - overlap * overlap / (4.0 * width)


def smooth_max(a: FloatArray, b: FloatArray, width: float) -> FloatArray:
    """Take the larger of a and b, rounded off where they differ by less than `width`."""
    return -smooth_min(-a, -b, width)


def blend(fields: Sequence[Field], width: float) -> Field:
    """Union of solids with fillets of about `width` in the joints."""

    def field(points: FloatArray) -> FloatArray:
        distance = fields[0](points)
        for other in fields[1:]:
            distance = smooth_min(distance, other(points), width)
        return distance

    return field


def loft(
    rows: Sequence[Row],
    *,
    side: tuple[float, float, float] | None = (0.0, 0.0, 1.0),
    power: int | None = 2,
    caps: tuple[float | None, float | None] = (None, None),
    flat: tuple[float | None, float | None] = (None, None),
    steps: int = 6,
) -> Field:
    """Make a solid with oval cross-sections along a curve.

    Parameters
    ----------
    rows : sequence of (x, y, z, up, across)
        Points on the centre line, at least two, and the half-axes of the section there;
        everything is interpolated by cubics.
    side : (3,) float
        Direction of the half-axis `across`, made orthogonal to the curve; `up` is orthogonal to
        both. None carries any direction along the curve without twist: for round sections on
        curves that turn every way.
    power : {2, 4, None}
        2 for ellipses, 4 for squares with well rounded corners, None for a plate: a thin section
        with parallel sides `up` from the middle, and a half-round rim.
    caps : pair of float or None
        How far the rounded start and end reach beyond the curve; by default as far as the smaller
        half-axis there.
    flat : pair of float or None
        A number cuts the start or end flat instead and rounds the rim by about that much.
    steps : int
        Straight pieces per interval between two rows.

    Returns
    -------
    Field
    """
    stations = _interpolate(np.array(rows, dtype=np.float64), steps)
    centers, axes = stations[:, :3], stations[:, 3:]
    tangents = _tangents(centers)
    across = _carried(tangents) if side is None else _orthogonal(np.array(side), tangents)
    up = np.cross(across, tangents)
    reach = tuple(
        float(axes[end].min()) if cap is None else cap
        for end, cap in zip((0, -1), caps, strict=True)
    )

    def field(points: FloatArray) -> FloatArray:
        place = _nearest_place(points, centers)
        first = np.minimum(place.astype(np.int64), len(centers) - 2)
        t = (place - first)[:, None]

        def at(values: FloatArray) -> FloatArray:
            value: FloatArray = values[first] * (1.0 - t) + values[first + 1] * t
            return value

        delta = points - at(centers)
        half = at(axes)
        local = np.zeros_like(points)
        local[:, 0] = dot(delta, normalized(at(up)))
        local[:, 1] = dot(delta, normalized(at(across)))
        scale = np.concatenate([half, np.ones((len(points), 1))], axis=1)
        before, after = place <= 0.0, place >= len(centers) - 1.0
        for beyond, end, rim, length in zip((before, after), (0, -1), flat, reach, strict=True):
            if rim is None:
                local[beyond, 2] = dot(delta[beyond], tangents[end])
                scale[beyond, 2] = length
        if power is None:
            distance = _plate_distance(local, scale)
        else:
            distance = _oval_distance(local, scale, power)
        for end, sign, rim in zip((0, -1), (-1.0, 1.0), flat, strict=True):
            if rim is not None:
                height = sign * dot(points - centers[end], tangents[end])
                distance = smooth_max(distance, height, rim)
        return distance

    return field


def mirrored(field: Field) -> Field:
    """Image of a solid in the plane z = 0."""
    return lambda points: field(points * np.array([1.0, 1.0, -1.0]))


def folded(field: Field) -> Field:
    """Make the half of a solid at negative z, and its image, into one solid."""

    def symmetric(points: FloatArray) -> FloatArray:
        left = points.copy()
        left[:, 2] = -np.abs(points[:, 2])
        return field(left)

    return symmetric


def bounded(field: Field, low: FloatArray, high: FloatArray, beyond: float) -> Field:
    """Give a field within a box, and `beyond` out of it, where the true distance is no less.

    For solids in one corner of a large box: what is far from the surface need not be exact.
    """

    def within(points: FloatArray) -> FloatArray:
        inside = ((points >= low) & (points <= high)).all(axis=1)
        distance = np.full(len(points), beyond)
        distance[inside] = field(points[inside])
        return distance

    return within


def gradient(field: Field, points: FloatArray, step: float) -> FloatArray:
    """(n, 3) central differences of a field."""
    result = np.empty_like(points)
    for axis in range(3):
        shift = np.zeros(3)
        shift[axis] = step
        result[:, axis] = (field(points + shift) - field(points - shift)) / (2.0 * step)
    return result


def _oval_distance(local: FloatArray, scale: FloatArray, power: int) -> FloatArray:
    """First-order distance to ``|x/a|^p + |y/b|^p + |z/c|^p = 1``: (norm - 1) / |gradient|."""
    ratio = np.abs(local) / scale
    square = ratio * ratio
    if power == 2:
        norm = np.sqrt(square[:, 0] + square[:, 1] + square[:, 2])
        slopes = ratio
    elif power == 4:
        norm = np.sqrt(np.sqrt(dot(square, square)))
        slopes = ratio * square
    else:
        raise ValueError(f"power must be 2 or 4, not {power}")
    norm = np.maximum(norm, 1e-6)
    slopes = slopes / scale / (norm if power == 2 else norm * norm * norm)[:, None]
    # On the axis itself the gradient of the norm is not defined: the widest half-axis stands in.
    length = np.maximum(np.sqrt(dot(slopes, slopes)), 1.0 / scale.max(axis=1))
    distance: FloatArray = (norm - 1.0) / length
    return distance


def _plate_distance(local: FloatArray, scale: FloatArray) -> FloatArray:
    """Distance to a flat rectangle, less the half thickness."""
    rest = np.abs(local)
    rest[:, 1:] = np.maximum(rest[:, 1:] - np.maximum(scale[:, 1:] - scale[:, :1], 0.0), 0.0)
    distance: FloatArray = np.sqrt(dot(rest, rest)) - scale[:, 0]
    return distance


def _nearest_place(points: FloatArray, centers: FloatArray) -> FloatArray:
    """(n,) float: station number, with fraction, of the nearest point on a polyline."""
    best = np.full(len(points), np.inf)
    place = np.zeros(len(points))
    for i in range(len(centers) - 1):
        along = centers[i + 1] - centers[i]
        delta = points - centers[i]
        t = np.clip(dot(delta, along) / dot(along, along), 0.0, 1.0)
        rest = delta - t[:, None] * along
        distance = dot(rest, rest)
        closer = distance < best
        best[closer] = distance[closer]
        place[closer] = i + t[closer]
    return place


def _orthogonal(direction: FloatArray, tangents: FloatArray) -> FloatArray:
    """Directions of length 1 orthogonal to each tangent, nearest to a given one."""
    return normalized(direction - dot(direction, tangents)[..., None] * tangents)


def _carried(tangents: FloatArray) -> FloatArray:
    """Directions orthogonal to each tangent, each nearest to the one before."""
    least = np.abs(tangents[0]).argmin()
    across = [_orthogonal(np.eye(3)[least], tangents[0])]
    for tangent in tangents[1:]:
        across.append(_orthogonal(across[-1], tangent))
    return np.stack(across)


def _interpolate(rows: FloatArray, steps: int) -> FloatArray:
    """Cubic Hermite curve through the rows, spaced by chord length."""
    chord = np.diff(rows[:, :3], axis=0)
    spacing = np.sqrt(dot(chord, chord))[:, None]
    slope = np.diff(rows, axis=0) / spacing
    inner = (slope[:-1] * spacing[1:] + slope[1:] * spacing[:-1]) / (spacing[:-1] + spacing[1:])
    slopes = np.concatenate([slope[:1], inner, slope[-1:]])
    t = (np.arange(steps) / steps)[:, None]
    pieces = []
    for i in range(len(rows) - 1):
        rise, h = rows[i + 1] - rows[i], spacing[i]
        c = 3.0 * rise - h * (2.0 * slopes[i] + slopes[i + 1])
        d = h * (slopes[i] + slopes[i + 1]) - 2.0 * rise
        pieces.append(rows[i] + t * (h * slopes[i] + t * (c + t * d)))
    return np.concatenate([*pieces, rows[-1:]])


def _tangents(centers: FloatArray) -> FloatArray:
    """Take unit tangents of a polyline at its stations, by central differences."""
    ahead = np.concatenate([centers[1:], 2.0 * centers[-1:] - centers[-2:-1]])
    behind = np.concatenate([2.0 * centers[:1] - centers[1:2], centers[:-1]])
    return normalized(ahead - behind)
