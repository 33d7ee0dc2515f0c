"""How much two labellings of one shape agree: Rand Index, and names given rightly.

The Rand Index is the share of pairs of elements on which two segmentations agree, that both
put them together or both apart; names play no part. Reported is 1 - RI, so that 0 is best.
Rand 1971, doi:10.1080/01621459.1971.10482356; as used for meshes by Chen, Golovinskiy and
Funkhouser 2009, doi:10.1145/1531326.1531379.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from moseg_core.types import FloatArray, IntArray


def rand_index_error(first: IntArray, second: IntArray, weights: FloatArray | None = None) -> float:
    """1 - Rand Index of two segmentations.

    Parameters
    ----------
    first, second : (F,) int
        Part of each element.
    weights : (F,) float, optional
        A pair counts as the product of its elements' weights, such as their areas; all pairs
        alike by default.

    Returns
    -------
    float
        Share of pairs on which the two disagree, 0 to 1; 0 is best.

    Examples
    --------
    >>> import numpy as np
    >>> rand_index_error(np.array([0, 0, 1]), np.array([5, 5, 2]))
    0.0
    >>> round(rand_index_error(np.array([0, 0, 1]), np.array([0, 1, 1])), 6)
    0.666667
    """
    mass = np.ones(len(first)) if weights is None else np.asarray(weights, np.float64)
    _, a = np.unique(first, return_inverse=True)
    _, b = np.unique(second, return_inverse=True)
    joint = np.zeros((int(a.max()) + 1, int(b.max()) + 1))
    np.add.at(joint, (a, b), mass)
    # Each side's own difference is exactly 0 where a part is one part of the other.
    apart = (joint.sum(axis=1) ** 2 - (joint**2).sum(axis=1)).sum()
    apart += (joint.sum(axis=0) ** 2 - (joint**2).sum(axis=0)).sum()
    pairs = mass.sum() ** 2 - (mass**2).sum()
    return float(max(apart, 0.0) / pairs) if pairs > 0 else 0.0


def named_right(
    labels: IntArray,
    names: Sequence[str],
    truth: IntArray,
    truth_names: Sequence[str],
    areas: FloatArray,
) -> float:
    """Share of the area that bears the right name, instance numbers folded.

    Parameters
    ----------
    labels, truth : (F,) int
    names, truth_names : sequence of str
        Names of the labels; ``leg1`` and ``leg2`` both count as ``leg``.
    areas : (F,) float

    Returns
    -------
    float
        0 to 1; 1 is best.

    Examples
    --------
    >>> import numpy as np
    >>> named_right(np.array([0, 1]), ["leg1", "leg2"], np.array([0, 1]), ["leg2", "body"],
    ...             np.array([3.0, 1.0]))
    0.75
    """
    given = np.array([fold(name) for name in names])[labels]
    wanted = np.array([fold(name) for name in truth_names])[truth]
    return float(areas[given == wanted].sum() / areas.sum())


def fold(name: str) -> str:
    """A name without its instance number: ``leg3`` is a ``leg``.

    Examples
    --------
    >>> fold("leg3"), fold("3")
    ('leg', '3')
    """
    return name.rstrip("0123456789") or name
