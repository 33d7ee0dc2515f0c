"""Objectives on how a part resembles an ideal: its mirror image, an ellipsoid (Sec. 10).

Both are a ``surfdist`` (:mod:`moseg_objectives_basic.surface`): the mean squared distance from the
part's surface to the ideal one, over the squared diagonal of the part's bounding box in its own
principal axes. 0 is best.
"""

from __future__ import annotations

import numpy as np

from moseg_core import Part, objective
from moseg_objectives_basic.ellipsoid import squared_distances_to_ellipsoid
from moseg_objectives_basic.surface import normalized_mean

_BLOCKS = 16


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    cost="expensive",
)
def planar_symmetric(part: Part) -> float:
    """Small for a part that is its own mirror image.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        Least surface distance between the part and its reflection about one of the three planes
        through its centroid across a principal axis. 0 for a symmetric part; 0 is best. No point
        is further from the part than from its own mirror image, at twice its distance from the
        plane; those square to ``4 s_i^2`` in the mean, at most the box's side squared.

    Notes
    -----
    Simari & Singh, Sec. 10: ``min_i surfdist(P, reflect(P, P.c, P.axis_i))``. A plane of symmetry
    that is not across a principal axis is not found; where scales coincide the axes, and with
    them the value, are arbitrary.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [9, 0, 0], [9, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> found = Problem(["a"], "planar_symmetric(a)").evaluate(strip, [0])
    >>> round(found.cost.value, 12)
    0.0
    """
    points, weights = part.measure("basic:surface_samples")
    tree = part.measure("basic:surface_tree")
    blocks = [slice(k, None, _BLOCKS) for k in range(min(_BLOCKS, len(points)))]
    squared = np.empty((3, len(points)))

    def add(i: int, block: slice) -> float:
        """Distances of one block of samples to the image across axis `i`; their weighted sum."""
        axis = part.axes[i]
        across = (points[block] - part.centroid) @ axis
        # The distance from x to the mirror image is that from the mirrored x to the part.
        mirrored = points[block] - 2.0 * across[:, None] * axis
        squared[i, block] = tree.squared_distances(mirrored)
        return float((weights[block] * squared[i, block]).sum())

    # The most promising axis first; another is given up once its sum is past the least, with
    # room for rounding. This leaves out most distances, and none that matter.
    sums = [add(i, blocks[0]) for i in range(3)]
    least, bound = np.inf, np.inf
    for i in sorted(range(3), key=sums.__getitem__):
        for block in blocks[1:]:
            if sums[i] > bound * (1.0 + 1e-6):
                break
            sums[i] += add(i, block)
        else:
            least = min(least, normalized_mean(part, squared[i], weights))
            bound = min(bound, sums[i])
    return least


@objective(
    range=(0, 1),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    cost="expensive",
)
def ellipsoidal(part: Part) -> float:
    """Small for a part close to the ellipsoid of its covariance.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        Surface distance from the part to the ellipsoid around its centroid with radii
        ``sqrt(3) * scales`` along its principal axes, or ``sqrt(5) * scales`` where the elements
        fill a solid. 0 for a sphere; 0 is best. A point ``x`` is within ``max(|x|, sqrt(3) s_3)``
        of the ellipsoid, hence at most 1/2 on a surface, and at most 1 on a solid.

    Notes
    -----
    Simari & Singh, Sec. 10: ``surfdist(P, covarellipsoid(P))``. The factor ``sqrt(3)`` is exact
    for a sphere's surface; the radii of a 3:1 ellipsoid come out 10 % short along its axis and
    5 % long across it, so that an elongated ellipsoid has a small positive value. Of a solid the
    scales are those of the volume, for which ``sqrt(5)`` is exact whatever the proportions; the
    distance is still that of the surface, the exposed faces.

    Examples
    --------
    >>> import trimesh
    >>> from moseg_core import Problem, Shape
    >>> ball = Shape.from_mesh(trimesh.creation.icosphere(subdivisions=4))
    >>> found = Problem(["a"], "ellipsoidal(a)").evaluate(ball, [0] * ball.n_elements)
    >>> found.cost.value < 1e-6
    True
    """
    points, weights = part.measure("basic:surface_samples")
    local = (points - part.centroid) @ part.axes.T
    factor = np.sqrt(5.0 if part.shape.solid else 3.0)
    squared = squared_distances_to_ellipsoid(local, factor * part.scales)
    return normalized_mean(part, squared, weights)
