"""Objectives on the long axes of two parts: perpendicular (Sec. 10), parallel, coaxial (Sec. 3).

The paper gives a formula for ``perpendicular``, the cosine of the angle between the axes, which is
the sine of the angle that is missing to a right one, and names the others without one.
``parallel`` is the sine of the angle between them, so that ten degrees cost the same in both. The
difference ``1 - cosine`` would be the exact complement, but falls with the square of the angle:
where axes are nearly parallel it would say next to nothing. 0 is best.
"""

from __future__ import annotations

import numpy as np

from moseg_core import Part, objective


@objective(
    range=(0, 1), invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels")
)
def parallel(first: Part, second: Part) -> float:
    """``|axis_1 x axis_1'|``: the sine of the angle between the long axes.

    Parameters
    ----------
    first, second : Part
        In either order.

    Returns
    -------
    float
        0 where they are parallel, 1 at a right angle; 0 is
        best. ``parallel^2 + perpendicular^2 = 1``.

    Notes
    -----
    Named in Simari & Singh, Sec. 3. The long axis of a part means little where its two largest
    scales are equal: whether two square plates or two discs are parallel is not seen.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> rails = Shape.from_mesh(
    ...     [[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0],
    ...      [1, 5, 0], [9, 5, 0], [9, 5, 2], [1, 5, 2]],
    ...     [[0, 1, 2, 3], [4, 5, 6, 7]])
    >>> found = Problem(["a", "b"], "parallel(a, b)").evaluate(rails, [0, 1])
    >>> round(found.cost.value, 12)
    0.0
    """
    # A cosine near 1 has lost the angle's lower half of digits; the cross product has not.
    return min(1.0, float(np.linalg.norm(np.cross(first.axes[0], second.axes[0]))))


@objective(
    range=(0, 1), invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels")
)
def coaxial(first: Part, second: Part) -> float:
    """``1 - (1 - sine) (1 - offset)``: the angle between the long axes, and how far apart they are.

    Parameters
    ----------
    first, second : Part
        In either order.

    Returns
    -------
    float
        ``sine`` is :func:`parallel`; ``offset`` is the distance of each part's centroid from
        the line of the other's axis, the mean of both, over the diagonal of the whole shape's
        bounding box in its principal axes. 0 where both axes lie on one line; 0 is best. Both
        centroids are in the box, so that neither factor exceeds 1.

    Notes
    -----
    Named in Simari & Singh, Sec. 3. Parallel axes have the value ``offset``, axes that meet in
    both centroids the value ``sine``, and near 0 the two add up. The shortest distance between
    the lines would not do for an offset: lines that cross have none, however far from the parts
    they cross, and it jumps where they become parallel.

    The axis is the long one, as in ``perpendicular``: that of a shaft, not that of a wheel. It
    means little where the two largest scales are equal.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> for y in 0, 3:
    ...     shape = Shape.from_mesh(
    ...         [[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0],
    ...          [5, y, 0], [9, y, 0], [9, y + 1, 0], [5, y + 1, 0]],
    ...         [[0, 1, 2, 3], [4, 5, 6, 7]])
    ...     found = Problem(["a", "b"], "coaxial(a, b)").evaluate(shape, [0, 1])
    ...     print(round(found.cost.value, 4))
    0.0
    0.2912
    """
    between = second.centroid - first.centroid
    distances = [
        np.linalg.norm(between - (between @ axis) * axis)
        for axis in (first.axes[0], second.axes[0])
    ]
    offset = min(1.0, float(sum(distances)) / 2.0 / first.shape.box_diagonal)
    return 1.0 - (1.0 - parallel((first, second))) * (1.0 - offset)


@objective(
    range=(0, 1), invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels")
)
def perpendicular(first: Part, second: Part) -> float:
    """``|axis_1 . axis_1'|``: the cosine of the angle between the long axes.

    Parameters
    ----------
    first, second : Part
        In either order.

    Returns
    -------
    float
        0 at a right angle, 1 where they are parallel; 0
        is best. The long axis of a part means little where its two largest scales are equal.

    Notes
    -----
    Simari & Singh, Sec. 10.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> cross = Shape.from_mesh(
    ...     [[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0],
    ...      [9, 0, 0], [9, 0, 1], [9, 5, 1], [9, 5, 0]],
    ...     [[0, 1, 2, 3], [4, 5, 6, 7]])
    >>> Problem(["a", "b"], "perpendicular(a, b)").evaluate(cross, [0, 1]).cost.value
    0.0
    """
    return min(1.0, float(abs(first.axes[0] @ second.axes[0])))
