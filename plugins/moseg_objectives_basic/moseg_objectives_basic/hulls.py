"""The volume of a convex hull: by manifold3d while searching, by Qhull where it is reported.

On the parts of real meshes manifold3d's quickhull takes a third to a half of Qhull's time. But
where many points lie in one plane up to rounding, the rule on a mesh that was turned, its hulls may
fold over themselves, be wrong by up to half of their volume, and say nothing
(https://github.com/elalish/manifold/issues/1785). So every point is moved by up to 1e-9 of the
hull's size, always in the same way, and no points lie in one plane any more. Of 5000 turned parts
of the Princeton Segmentation Benchmark none was then wrong by more than 1e-8 of its volume, 11
without it by more than 1e-6, and of 2400 moved by 1e-10 still 2.

That is enough for the many parts of super-elements that a search tries. A cost that is reported is
one of the input's own elements, and comes from Qhull, which merges facets that are nearly coplanar.
To prove a hull of manifold3d right, by looking for a point in front of any facet, takes as long as
manifold3d has saved.

:mod:`moseg_objectives_basic.convexity` measures parts with it; ``benchmarks/speed_jobs/hulls.py``
compares the two.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from manifold3d import Error, Manifold
from scipy.spatial import ConvexHull, QhullError

from moseg_core import MosegError

Floats: TypeAlias = npt.NDArray[np.float64]

#: How far points are moved, where they fill a unit cube.
_MOVE = 1e-9

#: A hull that touches all sides of a unit cube and has less volume is thin, along no axis; what
#: points are moved by may then be much of it.
_THIN = 1e-3


def moved_apart(points: Floats) -> Floats:
    """(n, 3) float: points of a unit cube with none in one plane any more, each moved by 1e-9.

    Parameters
    ----------
    points : (n, 3) float

    Examples
    --------
    >>> flat = np.zeros((4, 3))
    >>> bool(0 < np.abs(moved_apart(flat)).max() <= 1e-9)
    True
    """
    return points + _moves(1 << len(points).bit_length())[: len(points)]


def fast_hull_volume(points: Floats) -> float:
    """Volume of the convex hull of points that fill a unit cube, nearly.

    Parameters
    ----------
    points : (n, 3) float
        They span 1 in each coordinate, anywhere near the origin.

    Returns
    -------
    float
        By manifold3d; by Qhull where that fails, or points lie in a plane or close to one.

    Raises
    ------
    MosegError
        Qhull was needed and failed.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0.0, 1) for y in (0, 1) for z in (0, 1)])
    >>> round(fast_hull_volume(cube), 6)
    1.0
    """
    hull = Manifold.hull_points(moved_apart(points))
    volume = float(hull.volume())
    if hull.status() == Error.NoError and volume > _THIN:
        return volume
    return exact_hull_volume(points)


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


@lru_cache
def _moves(count: int) -> Floats:
    """(count, 3) float: how points are moved, the first ones alike whatever their number."""
    moves: Floats = np.random.default_rng(1785).uniform(-_MOVE, _MOVE, (count, 3))
    moves.flags.writeable = False
    return moves
