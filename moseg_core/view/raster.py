"""A z-buffer: which triangle is in front at each pixel, and values interpolated over it.

Pictures are drawn on machines without a screen, a GPU or GL, so the scan conversion is here,
orthographic and one sample per pixel; :mod:`moseg_core.view.picture` draws at a multiple of the
final size and averages, which is all the anti-aliasing there is.

Pixel ``(row, column)`` is sampled at ``(column + 1/2, row + 1/2)``, x to the right and y down,
and a triangle covers the samples inside it and on its border, whichever way it is wound. Corners
are first rounded to 1/256 of a pixel, as graphics hardware does: the inside test is then exact in
double precision, so that neighbouring triangles leave no gap on the edge that they share. Of
triangles at equal depth the first is seen.

Both kernels are compared in ``tests/view/test_raster.py`` with loops over every pixel.
"""

from __future__ import annotations

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.types import FloatArray, Int32Array

#: Corners are rounded to this part of a pixel.
SUBPIXELS = 256.0


@kernel
def rasterize(corners: FloatArray, width: int, height: int) -> tuple[Int32Array, FloatArray]:
    """Draw triangles into a z-buffer.

    Parameters
    ----------
    corners : (T, 3, 3) float
        For each corner x and y in pixels and the depth, which grows towards the viewer. Triangles
        may lie anywhere, also outside the picture, and may have no area: those cover nothing.
    width, height : int, pixels

    Returns
    -------
    triangle : (height, width) int32
        The triangle seen at each pixel, -1 where there is none.
    depth : (height, width) float64
        Its depth there, minus infinity where there is none.

    Examples
    --------
    >>> import numpy as np
    >>> triangle, depth = rasterize(np.array([[[0.0, 0, 5], [3, 0, 5], [0, 3, 5]]]), 3, 2)
    >>> triangle.tolist()
    [[0, 0, 0], [0, 0, -1]]
    """
    triangle = np.full((height, width), -1, np.int32)
    depth = np.full((height, width), -np.inf, np.float64)
    for t in range(len(corners)):
        ax, ay = _snap(corners[t, 0, 0]), _snap(corners[t, 0, 1])
        bx, by = _snap(corners[t, 1, 0]), _snap(corners[t, 1, 1])
        cx, cy = _snap(corners[t, 2, 0]), _snap(corners[t, 2, 1])
        area = _cross(ax, ay, bx, by, cx, cy)
        # Corners so far outside that the area overflows are not ones that a camera makes.
        if area == 0.0 or not np.isfinite(area):
            continue
        az, bz, cz = corners[t, 0, 2], corners[t, 1, 2], corners[t, 2, 2]
        # Bounds are clipped as floats: a corner far outside does not fit into an integer.
        low, high = min(ax, bx, cx), max(ax, bx, cx)
        first = int(min(max(np.ceil(min(ay, by, cy) - 0.5), 0.0), float(height)))
        last = int(max(min(np.floor(max(ay, by, cy) - 0.5), height - 1.0), -1.0))
        for row in range(first, last + 1):
            y = row + 0.5
            left, right = low, high
            left, right = _clip(ax, ay, bx, by, y, area, left, right)
            left, right = _clip(bx, by, cx, cy, y, area, left, right)
            left, right = _clip(cx, cy, ax, ay, y, area, left, right)
            # One pixel more on either side, for rounding; the test below is the exact one.
            start = int(min(max(np.floor(left - 0.5) - 1.0, 0.0), float(width)))
            stop = int(max(min(np.ceil(right - 0.5) + 2.0, float(width)), 0.0))
            for column in range(start, stop):
                x = column + 0.5
                u = _cross(bx, by, cx, cy, x, y)
                v = _cross(cx, cy, ax, ay, x, y)
                w = _cross(ax, ay, bx, by, x, y)
                if area > 0.0:
                    inside = u >= 0.0 and v >= 0.0 and w >= 0.0
                else:
                    inside = u <= 0.0 and v <= 0.0 and w <= 0.0
                if inside:
                    z = (u * az + v * bz + w * cz) / area
                    if z > depth[row, column]:
                        depth[row, column] = z
                        triangle[row, column] = t
    return triangle, depth


@kernel
def interpolate(triangle: Int32Array, corners: FloatArray, values: FloatArray) -> FloatArray:
    """Interpolate values at the corners of triangles over the pixels that show them.

    Parameters
    ----------
    triangle : (height, width) int32
        From :func:`rasterize`, of the same `corners`.
    corners : (T, 3, 3) float
    values : (T, 3, k) float
        k numbers for each corner of each triangle.

    Returns
    -------
    (height, width, k) float
        Zero where no triangle is seen.

    Examples
    --------
    >>> import numpy as np
    >>> corners = np.array([[[0.0, 0, 5], [4, 0, 5], [0, 4, 5]]])
    >>> triangle, _ = rasterize(corners, 2, 1)
    >>> interpolate(triangle, corners, np.array([[[0.0], [4.0], [0.0]]])).tolist()
    [[[0.5], [1.5]]]
    """
    height, width = triangle.shape
    count = values.shape[2]
    result = np.zeros((height, width, count), np.float64)
    for row in range(height):
        for column in range(width):
            t = triangle[row, column]
            if t < 0:
                continue
            ax, ay = _snap(corners[t, 0, 0]), _snap(corners[t, 0, 1])
            bx, by = _snap(corners[t, 1, 0]), _snap(corners[t, 1, 1])
            cx, cy = _snap(corners[t, 2, 0]), _snap(corners[t, 2, 1])
            area = _cross(ax, ay, bx, by, cx, cy)
            x, y = column + 0.5, row + 0.5
            u = _cross(bx, by, cx, cy, x, y)
            v = _cross(cx, cy, ax, ay, x, y)
            w = _cross(ax, ay, bx, by, x, y)
            for k in range(count):
                result[row, column, k] = (
                    u * values[t, 0, k] + v * values[t, 1, k] + w * values[t, 2, k]
                ) / area
    return result


@kernel
def _snap(coordinate: float) -> float:
    return float(np.rint(coordinate * SUBPIXELS) / SUBPIXELS)


@kernel
def _cross(ax: float, ay: float, bx: float, by: float, px: float, py: float) -> float:
    """Twice the signed area of the triangle a, b, p."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel
def _clip(
    ax: float,
    ay: float,
    bx: float,
    by: float,
    y: float,
    area: float,
    left: float,
    right: float,
) -> tuple[float, float]:
    """Narrow the interval of x in which row y is inside the edge from a to b."""
    rise = by - ay
    if rise == 0.0:
        return left, right
    crossing = ax + (bx - ax) * ((y - ay) / rise)
    # The inside is where rise * (x - crossing) has the opposite sign of the area.
    if (rise > 0.0) == (area > 0.0):
        return left, min(right, crossing)
    return max(left, crossing), right
