"""How convex parts are: convex_parts of them all (Sec. 10), convex of a single one (Sec. 3).

Hulls are those of :mod:`moseg_objectives_basic.hulls`: exact for parts made of the input's own
elements, and nearly so, and faster, for parts of super-elements, which only a search ever sees.

The paper names ``convex`` without a formula. A part that was cut out of a surface encloses no
volume by itself; it is closed first, by a cap over each loop of its boundary
(:func:`moseg_core.capped_volume`). Over a plane loop the cap is the flat lid, whatever the loop's
outline. So a convex part that was cut along planes is exactly convex.
"""

from __future__ import annotations

import math

import numpy as np

from moseg_core import Part, PartArray, Segmentation, ShapeError, capped_volume, objective
from moseg_objectives_basic.arrays import FloatArray, row_sums
from moseg_objectives_basic.hulls import exact_hull_volume, fast_hull_volume

_FLAT = 1e-12


def hull_volume(part: Part) -> float:
    """Volume of the convex hull of a part's vertices, model units cubed.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        0 for a part that lies in a plane, or within 1e-12 of its length of one.

    Raises
    ------
    MosegError
        The hull could not be computed.

    Examples
    --------
    >>> from moseg_core import Shape
    >>> tetrahedron = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> from moseg_core.components.segmentation import Segmentation
    >>> part = Segmentation.from_labels(tetrahedron, [0, 0, 0, 0], 1).parts[0]
    >>> round(part.measure("basic:hull_volume"), 6)
    0.166667
    """
    # Stretched to a cube along its principal axes, a part does not depend on units and place, and
    # a thin one has no facets that are narrower than the tolerances of a hull.
    # One row per axis: along rows numpy finds extremes some ten times as fast.
    local = part.axes @ (part.extreme_vertices - part.centroid).T
    size = np.ptp(local, axis=1)
    if local.shape[1] < 4 or size.min() <= _FLAT * size.max():
        return 0.0
    volume = exact_hull_volume if part.level is part.shape else fast_hull_volume
    return volume((local / size[:, None]).T) * float(size.prod())


def least_convex_parts(parts: PartArray) -> FloatArray:
    """Lower bounds of :func:`convex_parts` for several calls, (k,) float.

    Where hulls that are too small add up to the enclosed volume, the hulls are above it by more;
    else nothing is known.
    """
    volume = parts.shape.volume
    if volume is None:
        return np.zeros(len(parts))
    hulls = parts.remembered("basic:hull_volume")
    unknown = np.isnan(hulls)
    hulls = np.where(unknown, parts.least_hull_volumes(unknown), hulls)
    # Less by more than sums of the same hulls differ by rounding.
    excess: FloatArray = np.maximum(0.0, (1.0 - 1e-12) * row_sums(hulls) - volume) / volume
    return excess * excess


@objective(
    range=(0, math.inf),
    requires=("volume",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels"),
    cost="moderate",
    at_least=least_convex_parts,
)
def convex_parts(segmentation: Segmentation) -> float:
    """``((sum H(P) - V) / V)^2``: the volume of the hulls against that which the shape encloses.

    Parameters
    ----------
    segmentation : Segmentation

    Returns
    -------
    float
        0 where the volumes ``H(P)`` of the hulls add up to the enclosed volume ``V``; 0 is best.
        Hulls that overlap or reach across gaps raise it.

    Raises
    ------
    ShapeError
        The shape encloses no volume.

    Notes
    -----
    Simari & Singh, Sec. 10.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> tetrahedron = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> found = Problem(["a"], "convex_parts").evaluate(tetrahedron, [0, 0, 0, 0])
    >>> round(found.cost.value, 12)
    0.0
    """
    volume = segmentation.shape.volume
    if volume is None:
        raise ShapeError("'convex_parts' needs a shape that encloses a volume; leave out the term")
    hulls = 0.0
    for part in segmentation.parts:
        hulls += part.measure("basic:hull_volume")
    return ((hulls - volume) / volume) ** 2


def closed_volume(part: Part) -> float:
    """Volume of a part after its boundary loops are capped, model units cubed.

    Parameters
    ----------
    part : Part
        Its faces should be oriented alike, all outward or all inward; no matter which. Of faces
        that are not, the volumes cancel.

    Returns
    -------
    float
        Not negative. Pieces add up, and a piece that is turned inside out within another, the
        wall of a cavity, is subtracted.

    Examples
    --------
    >>> from moseg_core import Shape, Segmentation
    >>> tent = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                        [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> part = Segmentation.from_labels(tent, [0, 0, 0], 1).parts[0]
    >>> round(part.measure("basic:closed_volume"), 6)
    0.166667
    """
    return capped_volume(part.vertices - part.centroid, part.triangles, part.merged)


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    cost="moderate",
)
def convex(part: Part) -> float:
    """``(H(P) - V(P)) / H(P)``: the share of its hull that the part leaves empty.

    Parameters
    ----------
    part : Part
        May be open and in several pieces.

    Returns
    -------
    float
        ``H(P)`` is the volume of the hull, ``V(P)`` that of the part once each loop of its
        boundary is capped (:func:`closed_volume`). 0 for a convex part, also for one that is cut
        off along planes, and for one in a plane; up to 1 the less of its hull a part fills; 0 is
        best. Rounding, or faces that overlap, can make ``V`` greater than ``H``: 0 then.

    Notes
    -----
    Named in Simari & Singh, Sec. 3. Unlike ``convex_parts`` it is about one part, bounded, and
    needs no shape that encloses a volume; the hulls of two convex parts may well overlap.

    A boundary that runs in a zigzag along the faces has teeth that push the hull outward
    and a cap with dents between them, which count: each half of an ellipsoid of 300, 1300 and
    5000 faces has 0.16, 0.10 and 0.06. That is a floor below which differences mean nothing. A
    dent by itself, the inside of a bowl, is as convex as a bump. A part thinner than 1e-7 of its
    length counts as plane.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> ell = Shape.from_mesh(
    ...     [[x, y, z] for z in (0, 1)
    ...      for x, y in ((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2))],
    ...     [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11], [0, 1, 7, 6], [1, 2, 8, 7],
    ...      [2, 3, 9, 8], [3, 4, 10, 9], [4, 5, 11, 10], [5, 0, 6, 11]])
    >>> found = Problem(["a"], "convex(a)").evaluate(ell, [0] * 8)
    >>> round(found.cost.value * 7, 9)  # 3 of 3.5
    1.0
    """
    hull = part.measure("basic:hull_volume")
    if part.scales[2] == 0.0 or hull == 0.0:
        return 0.0
    return float(min(1.0, max(0.0, 1.0 - part.measure("basic:closed_volume") / hull)))
