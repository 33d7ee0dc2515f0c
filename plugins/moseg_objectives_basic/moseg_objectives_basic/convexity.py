"""How well convex hulls of the parts fill the shape: convex_parts (Sec. 10)."""

from __future__ import annotations

import math

import manifold3d
import numpy as np

from moseg_core import MosegError, Part, Segmentation, objective


def hull_volume(part: Part) -> float:
    """Volume of the convex hull of a part's vertices, model units cubed.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        0 for a part that lies in a plane.

    Raises
    ------
    MosegError
        The hull could not be computed.

    Examples
    --------
    >>> from moseg_core import Shape
    >>> tetrahedron = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> from moseg_core.segmentation import Segmentation
    >>> part = Segmentation.from_labels(tetrahedron, [0, 0, 0, 0], 1).parts[0]
    >>> round(part.measure("basic:hull_volume"), 6)
    0.166667
    """
    # In the part's own box the hull does not depend on units or place.
    low, size = part.vertices.min(axis=0), float(np.ptp(part.vertices, axis=0).max())
    hull = manifold3d.Manifold.hull_points((part.vertices - low) / size)
    if hull.status() != manifold3d.Error.NoError:
        raise MosegError(f"the convex hull of a part cannot be computed: {hull.status()}")
    return float(hull.volume()) * size**3


@objective(
    range=(0, math.inf),
    requires=("volume",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    cost="moderate",
)
def convex_parts(segmentation: Segmentation) -> float:
    """Small where the parts' convex hulls fill the volume once: ``((sum H(P) - V) / V)^2``.

    Parameters
    ----------
    segmentation : Segmentation

    Returns
    -------
    float
        0 where the volumes ``H(P)`` of the hulls add up to the enclosed volume ``V``; 0 is best.
        Hulls that overlap or reach across gaps raise it.

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
        raise MosegError("convex_parts needs a shape that encloses a volume")
    hulls = 0.0
    for part in segmentation.parts:
        hulls += part.measure("basic:hull_volume")
    return ((hulls - volume) / volume) ** 2
