"""Objectives on motions that leave a part as it is: symmetric by mirror, by turns, by any turn.

``planar_symmetric`` (Sec. 10) is a surface distance
(:mod:`moseg_objectives_basic.surface_distance`) between the part and its reflection. The paper
names ``axial_symmetric`` and ``rotational_symmetric`` (Sec. 3) without a formula. They follow it:
the surface distance between the part and its image, turned instead of reflected, about the best of
the three principal axes through the centroid. A turn and its inverse always come together. The sign
of a principal axis means nothing and a mirror image turns the other way, so that either alone would
make the value depend on both.

An axis of symmetry, but for half a turn, forces the scales across it to be equal: it belongs to
the scale that differs, and is well defined just where the two others are arbitrary. Those are
left out then, lest the value hang on them. For the same reason the distances of turns are not
measured against the diagonal of a box along these axes, as those of the reflection are, but
against the diameter of the ball around the centroid that holds the part: the same for a brick,
and well defined for all. 0 is best.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from moseg_core import Interval, Part, objective
from moseg_objectives_basic.surface_distance import normalized_mean

FloatArray = npt.NDArray[np.float64]

_COINCIDENT = 1e-6
_MOST_PAIRS = 4
# Far from the turns that leave a regular prism of two to twelve sides as it is: for each number
# of sides the mean square of how far is about that of angles all over the circle.
_ROUND = np.radians([25.0, -25.0, 55.0, -55.0, 105.0, -105.0])


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    cost="expensive",
)
def axial_symmetric(part: Part) -> float:
    """``min_i mean_a dist^2(P, turn(P, i, a)) / 4 r^2``: the distance to the part turned.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        Mean squared distance between the part and itself turned by 25, 55 and 105 degrees either
        way, over ``4 r^2`` with ``r`` its greatest distance from its centroid, about the
        principal axis through that where it is least. 0 for a surface of revolution; 0 is best.
        No point is further from the part than from where its turn takes it, at most twice its
        distance from the axis. Hence at most 1.

    Notes
    -----
    ``min_i mean_a dist^2(P, turn(P, P.c, P.axis_i, a)) / 4 r^2``; named in Simari & Singh,
    Sec. 3. Six turns stand for all. They are fixed, so that the value does not fluctuate, and
    chosen so that no prism of few sides is taken for round.

    It does not see an axis of revolution that is no principal axis. A full one always is, unless
    all three scales coincide and the part is no sphere: a cylinder of one certain height. A part
    that is only a sector of a surface of revolution (a gutter) is not symmetric in this sense. A
    mesh approximates round surfaces by facets: a tube of 16 sides has 3e-6.

    Examples
    --------
    >>> import trimesh
    >>> from moseg_core import Problem, Shape
    >>> can, bar = (
    ...     Shape.from_mesh(trimesh.creation.cylinder(radius=1, height=4, sections=48)),
    ...     Shape.from_mesh(trimesh.creation.box(extents=(4, 2, 1))))
    >>> for shape in can, bar:
    ...     found = Problem(["a"], "axial_symmetric(a)").evaluate(shape, [0] * shape.n_elements)
    ...     print(round(found.cost.value, 4))
    0.0
    0.0036
    """
    return _least_mean_distance(part, _ROUND)


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    cost="expensive",
)
def rotational_symmetric(part: Part, *, n: Annotated[int, Interval(2)] = 2) -> float:
    """``min_i mean_k dist^2(P, turn(P, i, 2 pi k / n)) / 4 r^2``: the distance to the part turned.

    Parameters
    ----------
    part : Part
    n : int
        2 or more. A regular prism of six sides is symmetric for 6, 3 and 2.

    Returns
    -------
    float
        Mean squared distance between the part and itself turned by the multiples of
        ``2 pi / n`` that are not the whole circle, over ``4 r^2`` as for
        :func:`axial_symmetric`, about the principal axis through the centroid where it is
        least. 0 where the part is n-fold symmetric; 0 is best. At most 1.

    Notes
    -----
    ``min_i mean_k dist^2(P, turn(P, P.c, P.axis_i, 2 pi k / n)) / 4 r^2``; named in Simari &
    Singh, Sec. 3. One turn by ``2 pi / n`` says as well whether there is symmetry, but not how
    far from it a part is: as ``n`` grows the turn, and with it every part's distance, goes to
    nothing. The mean over all multiples approaches that of a full revolution instead. From ``n``
    = 10 on seven or eight of them stand for all, that by ``2 pi / n`` among them.

    The axes of a part are arbitrary where all three scales coincide, a cube's for instance, and
    its symmetry is then not found; where two coincide only the axis of the third is tried. With
    ``n`` = 2 an axis of symmetry that happens to be one of the two is then missed.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> plate = Shape.from_mesh([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], [[0, 1, 2, 3]])
    >>> for n in 2, 3, 4:
    ...     found = Problem(["a"], f"rotational_symmetric(a, n={n})").evaluate(plate, [0])
    ...     print(n, round(found.cost.value, 4))
    2 0.0
    3 0.0004
    4 0.0
    """
    # k and n - k are each other's inverse; half a turn is its own.
    half = n // 2
    multiples = np.unique(np.linspace(1, half, min(half, _MOST_PAIRS)).round())
    ahead = 2.0 * np.pi * multiples / n
    return _least_mean_distance(part, np.concatenate([ahead, -ahead[2 * multiples < n]]))


def _least_mean_distance(part: Part, angles: FloatArray) -> float:
    """Least over the axes of the mean over the angles of the distance to the turned part."""
    points, weights = part.measure("basic:surface_samples")
    tree = part.measure("basic:surface_tree")
    local = points - part.centroid
    turns = [
        Rotation.from_rotvec(angles[:, None] * axis).as_matrix()
        for axis in part.axes[_well_defined(part)]
    ]
    # The distance from x to a turned part is that from x, turned back, to the part; the inverse of
    # each turn is another one.
    images = ((local @ turn + part.centroid).reshape(-1, 3) for turn in turns)
    weights = np.tile(weights, len(angles))
    least = (weights * tree.least_distances(images, weights)).sum()
    reach = ((part.vertices - part.centroid) ** 2).sum(axis=1).max()
    return float(least / (weights.sum() * 4.0 * reach))


def _well_defined(part: Part) -> list[int]:
    """The axes whose scales differ from the others'; all three where none does."""
    s = part.scales**2
    apart = [
        i
        for i in range(3)
        if all(abs(s[i] - s[j]) > _COINCIDENT * max(s[i], s[j]) for j in range(3) if j != i)
    ]
    return apart or [0, 1, 2]


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    cost="expensive",
)
def planar_symmetric(part: Part) -> float:
    """``min_i surfdist(P, reflect(P, i))``: the distance to the part's mirror image.

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
    across = [(points - part.centroid) @ axis for axis in part.axes]
    # The distance from x to the mirror image is that from the mirrored x to the part.
    images = (points - 2.0 * x[:, None] * axis for x, axis in zip(across, part.axes, strict=True))
    return normalized_mean(part, tree.least_distances(images, weights), weights)
