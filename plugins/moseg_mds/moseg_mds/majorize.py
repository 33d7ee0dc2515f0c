"""Stress majorisation: places that follow given distances better, step by step (SMACOF).

The *stress* of places ``x`` is ``sum w_ij (|x_i - x_j| - d_ij)^2`` over all pairs. It has no closed
form, but at any places ``z`` a parabola touches it from above, and the least of that one is easy
to find: the Guttman transform ``x = V^+ B(z) z``. So no step raises the stress (J. de Leeuw 1977;
E. Gansner, Y. Koren, S. North 2005, "Graph drawing by stress majorization",
doi:10.1007/978-3-540-31843-9_25). Alone it unbends a limb slowly, since hardly any distance
changes at first. So steps start from a point ahead in the direction of the last ones (Y. Nesterov
1983), and from where they are when that would raise the stress (B. O'Donoghue, E. Candès 2015,
doi:10.1007/s10208-013-9150-3).

The weights ``w_ij = d_ij^-q`` say what counts: with ``q = 0`` absolute errors, so that long
distances rule and thin limbs shrink to lines; with ``q = 2`` relative errors, so that limbs keep
their thickness, and long distances are hardly worse for it.

:func:`majorize` moves landmarks. :func:`place` moves other points among landmarks that stay, each
by itself: then ``V`` is a number. All points take equally many steps, so that what was connected
stays so.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

#: Shares of the longest distance below which weights do not grow any more.
_NEAR = 1e-3

#: So many points at a time are placed: their distances to the landmarks fit into a cache.
_ROWS = 256

_TINY = 1e-300


def stress_weights(distances: FloatArray, exponent: float) -> FloatArray:
    """Weights ``d^-q`` of distances ``d``, for the stress.

    Parameters
    ----------
    distances : (k, n) float
    exponent : float
        The ``q`` above, 0 or more.

    Returns
    -------
    (k, n) float
        1 for the longest distance, more for shorter ones, and no more than for a thousandth of it.

    Examples
    --------
    >>> stress_weights(np.array([[1.0, 2.0, 4.0]]), 2.0).tolist()
    [[16.0, 4.0, 1.0]]
    """
    longest = float(distances.max())
    if longest <= 0.0:
        return np.ones_like(distances)
    return np.asarray(np.maximum(distances / longest, _NEAR) ** -exponent)


def stress(distances: FloatArray, places: FloatArray, weights: FloatArray) -> float:
    """``sum w_ij (|x_i - x_j| - d_ij)^2`` over all ordered pairs; 0 is best."""
    off = _pairwise(places) - distances
    return float((weights * off**2).sum())


def majorize(
    distances: FloatArray,
    start: FloatArray,
    *,
    weights: FloatArray | None = None,
    steps: int = 300,
    tolerance: float = 1e-8,
) -> FloatArray:
    """Improve places by all their distances.

    Parameters
    ----------
    distances : (k, k) float
        Symmetric.
    start : (k, d) float
        Not all in one place.
    weights : (k, k) float, optional
        Symmetric and positive off the diagonal; all equal by default.
    steps : int
        The most to take.
    tolerance : float
        End when a step lowers the stress by less than this share of it.

    Returns
    -------
    (k, d) float
        Centred; the stress is not above that of the start.

    Examples
    --------
    Three points, pulled apart to an equilateral triangle:

    >>> apart = np.ones((3, 3)) - np.eye(3)
    >>> found = majorize(apart, np.array([[0, 0], [1, 0.1], [2, 0.0]]), steps=1000, tolerance=0)
    >>> np.linalg.norm(found - np.roll(found, 1, axis=0), axis=1).round(4).tolist()
    [1.0, 1.0, 1.0]
    """
    off_diagonal = 1.0 - np.eye(len(distances))
    w = off_diagonal if weights is None else weights * off_diagonal
    # V is singular along shifts of all points; adding 1/k there makes it regular.
    shift = np.full_like(w, 1.0 / len(w))
    inverse = _inverse(np.diag(w.sum(axis=1)) - w + shift) - shift
    target = w * distances

    def measured(places: FloatArray) -> tuple[FloatArray, float]:
        d = _pairwise(places)
        return d, float((w * (d - distances) ** 2).sum())

    def transform(places: FloatArray, d: FloatArray) -> FloatArray:
        pull = np.divide(target, d, out=np.zeros_like(d), where=d > _TINY)
        bz = places * pull.sum(axis=1)[:, None] - np.einsum("ij,jk->ik", pull, places)
        return np.asarray(np.einsum("ij,jk->ik", inverse, bz))

    x: FloatArray = start - start.mean(axis=0)
    d, value = measured(x)
    z, d_z = x, d
    run = 0  # steps since momentum was lost
    for _ in range(steps):
        moved = transform(z, d_z)
        d_moved, after = measured(moved)
        if after > value:
            if run == 0:  # nothing but rounding is left
                break
            run, z, d_z = 0, x, d
            continue
        run += 1
        z = moved + (run - 1.0) / (run + 2.0) * (moved - x)
        gain, x, d, value = value - after, moved, d_moved, after
        if gain <= tolerance * value:
            break
        d_z = _pairwise(z)
    return x


def place(
    distances: FloatArray,
    landmarks: FloatArray,
    start: FloatArray,
    *,
    weights: FloatArray | None = None,
    steps: int = 40,
) -> FloatArray:
    """Improve the places of points by their distances to landmarks that stay.

    Parameters
    ----------
    distances : (k, n) float
        From each landmark to each point.
    landmarks : (k, d) float
    start : (n, d) float
    weights : (k, n) float, optional
        Positive; all equal by default.
    steps : int

    Returns
    -------
    (n, d) float

    Examples
    --------
    >>> corners = np.array([[0, 0], [2, 0], [0, 2.0]])
    >>> distances = np.full((3, 1), 2**0.5)
    >>> place(distances, corners, np.array([[0.5, 0.2]]), steps=100).round(4).tolist()
    [[1.0, 1.0]]
    """
    placed = np.empty_like(start)
    for begin in range(0, len(start), _ROWS):
        some = slice(begin, begin + _ROWS)
        d = np.ascontiguousarray(distances[:, some].T)
        w = np.ones_like(d) if weights is None else np.ascontiguousarray(weights[:, some].T)
        total = w.sum(axis=1)[:, None]
        anchor = np.einsum("nk,kd->nd", w, landmarks)
        target = w * d
        x = start[some]
        for _ in range(steps):
            gap = np.zeros_like(d)
            for axis in range(x.shape[1]):
                gap += (x[:, axis, None] - landmarks[:, axis]) ** 2
            np.sqrt(gap, out=gap)
            pull = np.divide(target, gap, out=np.zeros_like(gap), where=gap > _TINY)
            away = x * pull.sum(axis=1)[:, None] - np.einsum("nk,kd->nd", pull, landmarks)
            x = (anchor + away) / total
        placed[some] = x
    return placed


def _pairwise(places: FloatArray) -> FloatArray:
    """(k, k) float: distances between all."""
    squared = np.zeros((len(places), len(places)))
    for axis in places.T:
        squared += (axis[:, None] - axis) ** 2
    return np.asarray(np.sqrt(squared))


def _inverse(matrix: FloatArray) -> FloatArray:
    """Inverse of a positive definite matrix, by Gauss and Jordan.

    LAPACK's last digits depend on the number of threads, and steps of majorisation enlarge them.
    """
    rest = matrix.copy()
    for k in range(len(rest)):
        row = rest[k] / rest[k, k]
        column = rest[:, k].copy()
        rest -= column[:, None] * row
        rest[:, k] = -column / column[k]
        rest[k] = row
        rest[k, k] = 1.0 / column[k]
    return rest
