"""Multidimensional scaling in closed form: places whose distances are nearest to those given.

*Classical* scaling (W. Torgerson 1952, doi:10.1007/BF02288916; J. Gower 1966) turns squared
distances into scalar products, ``B = -1/2 J D^2 J`` with the centring matrix ``J``, and takes the
leading eigenvectors. Of points in space it returns the points. *Landmark* scaling (V. de Silva,
J. Tenenbaum 2004) does so for a few of them, and places the others by a linear map of their
squared distances to these.

Distances on a surface are no distances in space, and classical scaling projects: what needs a
fourth dimension is flattened. :mod:`moseg_mds.majorize` starts from here and does better.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_ROWS = 1024


def classical_mds(distances: npt.ArrayLike, *, dimensions: int = 3) -> FloatArray:
    """Place points by all their distances.

    Parameters
    ----------
    distances : (k, k) array_like of float
        Not negative; the mean of both directions is taken where they differ.
    dimensions : int

    Returns
    -------
    (k, dimensions) float
        Centred; axes in descending order of variance, each with its entry of largest magnitude
        positive. Axes beyond those that the distances need are 0.

    Examples
    --------
    >>> side, diagonal = 1.0, 2.0**0.5
    >>> square = [[0, side, diagonal, side], [side, 0, side, diagonal],
    ...           [diagonal, side, 0, side], [side, diagonal, side, 0]]
    >>> places = classical_mds(square, dimensions=2)
    >>> float(normalized_stress(square, places)) < 1e-9
    True
    """
    values, vectors, _ = _decompose(distances, dimensions)
    return vectors * np.sqrt(values)


def landmark_mds(
    distances: npt.ArrayLike, landmarks: npt.ArrayLike, *, dimensions: int = 3
) -> FloatArray:
    """Place points by their distances to some of them.

    Parameters
    ----------
    distances : (k, n) array_like of float
        From each landmark to every point.
    landmarks : (k,) array_like of int
        Which of the points the landmarks are.
    dimensions : int

    Returns
    -------
    (n, dimensions) float
        The landmarks are where :func:`classical_mds` has them, where their distances are
        symmetric.

    Examples
    --------
    >>> places = np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 3], [1, 1, 1.0]])
    >>> distances = np.linalg.norm(places[:4, None] - places, axis=2)
    >>> found = landmark_mds(distances, [0, 1, 2, 3])
    >>> bool(np.isclose(np.linalg.norm(found[4] - found[0]), 3**0.5))
    True
    """
    table = np.asarray(distances, np.float64)
    among = table[:, np.asarray(landmarks, np.int64)]
    values, vectors, mean = _decompose(among, dimensions)
    # The pseudo-inverse of the landmarks' places; 0 along axes that they do not span.
    inverse = np.divide(vectors, np.sqrt(values), out=np.zeros_like(vectors), where=values > 0.0)
    return np.asarray(-0.5 * np.einsum("kn,kd->nd", table**2 - mean[:, None], inverse))


def normalized_stress(
    distances: npt.ArrayLike, places: npt.ArrayLike, others: npt.ArrayLike | None = None
) -> float:
    """How far distances in space are from those given: 0 is best.

    Parameters
    ----------
    distances : (k, n) array_like of float
    places : (k, d) array_like of float
    others : (n, d) array_like of float, optional
        The same points by default.

    Returns
    -------
    float
        ``sqrt(sum (|x_i - y_j| - d_ij)^2 / sum d_ij^2)``.

    Examples
    --------
    >>> normalized_stress([[0, 2], [2, 0]], [[0, 0], [0, 1]])
    0.5
    """
    table, first = np.asarray(distances, np.float64), np.asarray(places, np.float64)
    second = first if others is None else np.asarray(others, np.float64)
    off = 0.0
    for start in range(0, len(second), _ROWS):
        some = slice(start, start + _ROWS)
        found = np.linalg.norm(first[:, None] - second[None, some], axis=2)
        off += float(((found - table[:, some]) ** 2).sum())
    total = float((table**2).sum())
    return float(np.sqrt(off / total)) if total > 0.0 else 0.0


def _decompose(
    distances: npt.ArrayLike, dimensions: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Leading eigenvalues (d,), eigenvectors (k, d), and the mean squared distances (k,)."""
    table = np.asarray(distances, np.float64)
    squared = ((table + table.T) / 2.0) ** 2
    mean = squared.mean(axis=1)
    products = -0.5 * (squared - mean[:, None] - mean + mean.mean())
    values, vectors = np.linalg.eigh(products)
    values, vectors = values[::-1][:dimensions], vectors[:, ::-1][:, :dimensions]
    # What is negative, or only rounding, spans no axis.
    values = np.where(values > 1e-12 * max(float(values[0]), 0.0), values, 0.0)
    largest = np.abs(vectors).argmax(axis=0)
    vectors = vectors * np.where(vectors[largest, np.arange(vectors.shape[1])] < 0.0, -1.0, 1.0)
    missing = dimensions - len(values)
    values = np.append(values, np.zeros(missing))
    return values, np.pad(vectors, ((0, 0), (0, missing))), mean
