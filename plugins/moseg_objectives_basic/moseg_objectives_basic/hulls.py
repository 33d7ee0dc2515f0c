"""The volume of a convex hull: by Qhull where it is reported, by a faster one while searching.

:mod:`moseg_objectives_basic.quickhull` takes a quarter of Qhull's time on parts of real meshes, and
half of what manifold3d takes, whose hulls may fold over themselves where many points lie in one
plane up to rounding (https://github.com/elalish/manifold/issues/1785). It differs from Qhull by
1e-14 of the volume as a rule, by 1e-9 at most where many points are in a plane up to that. That is
enough for the many parts of super-elements that a search tries. A cost that is reported is one of
the input's own elements, and comes from Qhull.

:mod:`moseg_objectives_basic.convexity` measures parts with it; ``benchmarks/speed_jobs/hulls.py``
compares the two.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from scipy.spatial import ConvexHull, QhullError

from moseg_core import MosegError
from moseg_objectives_basic.quickhull import quickhull_volume

Floats: TypeAlias = npt.NDArray[np.float64]

#: A hull that touches all sides of a unit cube and has less volume is thin, along no axis; the
#: cells of a grid may then be much of it.
_THIN = 1e-3


def fast_hull_volume(points: Floats) -> float:
    """Volume of the convex hull of points that fill a unit cube, nearly.

    Parameters
    ----------
    points : (n, 3) float
        They span 1 in each coordinate, anywhere near the origin.

    Returns
    -------
    float
        By Qhull where points lie in a plane or close to one.

    Raises
    ------
    MosegError
        Qhull was needed and failed.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0.0, 1) for y in (0, 1) for z in (0, 1)])
    >>> fast_hull_volume(cube)
    1.0
    """
    volume = quickhull_volume(points)
    return volume if volume > _THIN else exact_hull_volume(points)


def exact_hull_volume(points: Floats) -> float:
    """Volume of the convex hull of points that fill a unit cube, by Qhull.

    Parameters
    ----------
    points : (n, 3) float
        Four or more.

    Returns
    -------
    float
        0 for points in a plane.

    Raises
    ------
    MosegError
        The hull could not be computed.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0.0, 1) for y in (0, 1) for z in (0, 1)])
    >>> exact_hull_volume(cube)
    1.0
    """
    try:
        return float(ConvexHull(points).volume)
    except QhullError as error:
        if str(error).startswith("QH6154"):  # flat, though along no axis
            return 0.0
        reason = str(error).partition("\n")[0]
        raise MosegError(f"the convex hull of a part cannot be computed: {reason}") from error
