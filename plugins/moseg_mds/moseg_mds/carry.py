"""Carrying a surface along with its landmarks: as rigidly as possible, each piece for itself.

The landmarks have moved; where do the vertices between them go? Each follows the rotation and
shift that moves the landmarks around it best: *rigid moving least squares* (S. Schaefer,
T. McPhail, J. Warren 2006, "Image deformation using moving least squares",
doi:10.1145/1179352.1141920). What is around it is measured along the surface, and weighs
``distance^-4``: an arm does not follow the arm that it touches. So a limb is unbent and not
crumpled, and an outside stays an outside: distances alone would leave it open which is which.

With the weighted means ``p`` of the landmarks before and ``r`` after, the rotation of a vertex is
the one of ``sum w (a - p)(b - r)^T`` over the landmarks ``a`` that went to ``b`` (W. Kabsch 1976,
doi:10.1107/S0567739476001873).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

_FALL_OFF = 4.0

#: Share of the longest distance below which weights do not grow any more.
_NEAR = 1e-3

_ROWS = 4096


def carry_along(
    points: FloatArray, distances: FloatArray, before: FloatArray, after: FloatArray
) -> FloatArray:
    """Move points as the landmarks around them have moved.

    Parameters
    ----------
    points : (n, 3) float
    distances : (k, n) float
        From each landmark to each point, along the surface.
    before, after : (k, 3) float
        Where the landmarks were, and are.

    Returns
    -------
    (n, 3) float

    Examples
    --------
    Where all landmarks are turned alike, so is everything:

    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> turned = corners[:, [1, 2, 0]] + 5.0
    >>> point = np.array([[0.2, 0.3, 0.4]])
    >>> distances = np.linalg.norm(corners[:, None] - point, axis=2)
    >>> carry_along(point, distances, corners, turned).round(9).tolist()
    [[5.3, 5.4, 5.2]]
    """
    moved = np.empty_like(points)
    for start in range(0, len(points), _ROWS):
        some = slice(start, start + _ROWS)
        u, sizes, vt, old, new = _local_fits(distances[:, some], before, after)
        sizes[:, 2] *= np.sign(np.linalg.det(u) * np.linalg.det(vt))
        u[:, :, 2] *= np.where(sizes[:, 2] < 0.0, -1.0, 1.0)[:, None]
        moved[some] = np.einsum("ni,nij->nj", points[some] - old, u @ vt) + new
    return moved


def handedness(distances: FloatArray, before: FloatArray, after: FloatArray) -> float:
    """Whether landmarks have moved like a body, or like its mirror image.

    Parameters
    ----------
    distances : (k, k) float
        Between landmarks, along the surface.
    before, after : (k, 3) float

    Returns
    -------
    float
        Positive where, summed over the surroundings of all landmarks, rotations fit better than
        reflections; 0 where it makes no difference, as on a plane.
    """
    u, sizes, vt, _, _ = _local_fits(distances, before, after)
    return float((sizes[:, 2] * np.sign(np.linalg.det(u) * np.linalg.det(vt))).sum())


def turned_like(points: FloatArray, model: FloatArray) -> FloatArray:
    """Points, centred and rotated to lie as the model does; never mirrored.

    Parameters
    ----------
    points, model : (n, 3) float

    Returns
    -------
    (n, 3) float
        The rotation about the mean with the least sum of squared distances to the model.

    Examples
    --------
    >>> model = np.array([[2, 0, 0], [-2, 0, 0], [0, 1, 0], [0, -1, 0.0]])
    >>> turned_like(model[:, [2, 0, 1]] + 7.0, model).round(9).tolist() == model.tolist()
    True
    """
    centred = points - points.mean(axis=0)
    u, _, vt = np.linalg.svd(np.einsum("ni,nj->ij", centred, model - model.mean(axis=0)))
    u[:, 2] *= 1.0 if np.linalg.det(u) * np.linalg.det(vt) > 0.0 else -1.0
    return np.asarray(np.einsum("ni,ij->nj", centred, np.einsum("ij,jk->ik", u, vt)))


def _local_fits(
    distances: FloatArray, before: FloatArray, after: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Around each of n points the SVD of the landmarks' covariance, and both weighted means."""
    share = np.maximum(distances / distances.max(), _NEAR) ** -_FALL_OFF
    share /= share.sum(axis=0)
    old = np.einsum("kn,kd->nd", share, before)
    new = np.einsum("kn,kd->nd", share, after)
    products = (before[:, :, None] * after[:, None, :]).reshape(-1, 9)
    covariance = np.einsum("kn,kd->nd", share, products).reshape(-1, 3, 3)
    u, sizes, vt = np.linalg.svd(covariance - old[:, :, None] * new[:, None, :])
    return u, sizes, vt, old, new
