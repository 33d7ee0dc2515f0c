"""Objectives on how near to the middle of the shape a part is: central, remote. 0 is best.

Near and far are meant along the surface, :mod:`moseg_objectives_basic.fields.remoteness`: a hand
is remote however the arm is bent. A torso is central, and heads, hands and feet are remote.
"""

from __future__ import annotations

import numpy as np

from moseg_core import Part, PartArray, objective
from moseg_objectives_basic.arrays import FloatArray

_FIELD = "basic:remoteness"


def all_central(parts: PartArray) -> FloatArray:
    """:func:`central` of several parts, (k,) float."""
    return np.maximum(0.0, 1.0 - 1.0 / parts.field(_FIELD).mean)


def all_remote(parts: PartArray) -> FloatArray:
    """:func:`remote` of several parts, (k,) float."""
    return np.minimum(1.0, 1.0 / parts.field(_FIELD).mean)


@objective(
    range=(0, 1),
    requires=("adjacency",),
    invariant_to=("rigid", "scale", "reflection", "order"),
    fields=(_FIELD,),
    vectorized=all_central,
)
def central(part: Part) -> float:
    """``1 - 1 / r``: how far the part is from the middle.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        ``r`` is the mean remoteness of the part, 1 in the middle of the shape: 0 there, 1/2 at
        the end of a rod; 0 is best.

    Notes
    -----
    Remoteness after Hilaga et al. 2001, doi:10.1145/383259.383282.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = moseg.load(moseg.sample_path("horse"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("horse"), horse.n_elements)
    >>> found = moseg.Problem(truth.names, "central(*)").evaluate(horse, truth.labels)
    >>> truth.names[min(enumerate(found.terms[0].calls), key=lambda each: each[1].value)[0]]
    'body'
    """
    return max(0.0, 1.0 - 1.0 / part.field(_FIELD).mean)


@objective(
    range=(0, 1),
    requires=("adjacency",),
    invariant_to=("rigid", "scale", "reflection", "order"),
    fields=(_FIELD,),
    vectorized=all_remote,
)
def remote(part: Part) -> float:
    """``1 / r``: how near to the middle the part is.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        ``1 - central``, see :func:`central`: 1 in the middle of the shape, 1/2 at the end of a
        rod; 0 is best, though nothing is that far away.

    Notes
    -----
    Remoteness after Hilaga et al. 2001, doi:10.1145/383259.383282.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = moseg.load(moseg.sample_path("horse"))
    >>> found = moseg.Problem(["all"], "remote(all)").evaluate(horse, [0] * horse.n_elements)
    >>> bool(0.6 < found.cost.value < 0.9)
    True
    """
    return min(1.0, 1.0 / part.field(_FIELD).mean)
