"""Objectives on how thick a part is: thin, thick, even_thickness. 0 is best.

Thickness is the field :mod:`moseg_objectives_basic.fields.thickness`, how far it is to the other
side: a table's top is thin, a leg is thinner than the body. Unlike ``narrow`` and ``flat`` it does
not depend on how long a part was cut.
"""

from __future__ import annotations

import math

import numpy as np

from moseg_core import Part, PartArray, Segmentation, objective
from moseg_objectives_basic.arrays import FloatArray, row_sums

_FIELD, _LOG = "basic:thickness", "basic:log_thickness"


def all_thin(parts: PartArray) -> FloatArray:
    """:func:`thin` of several parts, (k,) float."""
    own = parts.field(_FIELD).mean
    return own / (own + parts.field_of_shape(_FIELD))


def all_thick(parts: PartArray) -> FloatArray:
    """:func:`thick` of several parts, (k,) float."""
    whole = parts.field_of_shape(_FIELD)
    return whole / (parts.field(_FIELD).mean + whole)


def all_even_thickness(parts: PartArray) -> FloatArray:
    """:func:`even_thickness` of several parts, (k,) float."""
    own = parts.field(_FIELD)
    return own.spread / (own.spread + own.mean)


def all_even_parts(segmentations: PartArray) -> FloatArray:
    """:func:`even_parts` of several segmentations, (k,) float."""
    spreads = segmentations.field(_LOG).spread
    # Python's square, which in one of a thousand rounds otherwise than numpy's: as of one alone.
    squares = np.array([spread**2 for spread in spreads.ravel().tolist()]).reshape(spreads.shape)
    return row_sums(segmentations.areas * squares) / segmentations.shape.area


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    fields=(_FIELD,),
    vectorized=all_thin,
)
def thin(part: Part) -> float:
    """``t / (t + T)``: how thick the part is, beside the whole shape.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        ``t`` is the mean thickness of the part, ``T`` that of the whole shape: 1/2 where the
        part is as thick as the shape, 1/3 where it is half as thick; 0 is best.

    Notes
    -----
    Thickness after Shapira et al. 2008, doi:10.1007/s00371-007-0197-5.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("hammer"), hammer.n_elements)
    >>> found = moseg.Problem(truth.names, "thin(*)").evaluate(hammer, truth.labels)
    >>> handle, head = (call.value for call in found.terms[0].calls)
    >>> bool(0.4 < handle < head < 0.6)
    True
    """
    own = part.field(_FIELD).mean
    return own / (own + part.field_of_shape(_FIELD))


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    fields=(_FIELD,),
    vectorized=all_thick,
)
def thick(part: Part) -> float:
    """``T / (t + T)``: how thin the part is, beside the whole shape.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        ``1 - thin``, see :func:`thin`; 0 is best.

    Notes
    -----
    Thickness after Shapira et al. 2008, doi:10.1007/s00371-007-0197-5.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> found = moseg.Problem(["all"], "thick(all)").evaluate(hammer, [0] * hammer.n_elements)
    >>> round(found.cost.value, 9)
    0.5
    """
    whole = part.field_of_shape(_FIELD)
    return whole / (part.field(_FIELD).mean + whole)


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    fields=(_FIELD,),
    vectorized=all_even_thickness,
)
def even_thickness(part: Part) -> float:
    """``d / (d + t)``: how much the thickness varies over the part.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        ``t`` is the mean thickness of the part, ``d`` its standard deviation. 0 where the part is
        as thick everywhere, 1/2 where it varies by as much as it is thick; 0 is best.

    Notes
    -----
    Thickness after Shapira et al. 2008, doi:10.1007/s00371-007-0197-5.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("hammer"), hammer.n_elements)
    >>> found = moseg.Problem(truth.names, "even_thickness(*)").evaluate(hammer, truth.labels)
    >>> handle, head = (call.value for call in found.terms[0].calls)
    >>> bool(handle < head)
    True
    """
    own = part.field(_FIELD)
    return own.spread / (own.spread + own.mean)


@objective(
    range=(0, math.inf),
    requires=("surface",),
    # Squares of deviations: other triangles change them by 9 % on the lump of the contract checks.
    invariant_to=("rigid", "scale", "reflection", "order", "labels"),
    fields=(_LOG,),
    vectorized=all_even_parts,
)
def even_parts(segmentation: Segmentation) -> float:
    """``sum_i a_i v_i``: how much the thickness varies within parts, over all of them.

    Parameters
    ----------
    segmentation : Segmentation

    Returns
    -------
    float
        ``a_i`` is the share of the area of part ``i``, ``v_i`` the variance of the logarithm of the
        thickness over it. 0 where each part is as thick everywhere, however thick others are; of
        one part that is the whole shape, the variance over the shape. 0 is best.

    Notes
    -----
    Thickness after Shapira et al. 2008, doi:10.1007/s00371-007-0197-5, who cut shapes where it
    changes.

    Examples
    --------
    The arms of an octopus are thin, its head is thick:

    >>> import moseg_core as moseg
    >>> octopus = moseg.load(moseg.sample_path("octopus"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("octopus"), octopus.n_elements)
    >>> parts = moseg.Problem(truth.names, "even_parts").evaluate(octopus, truth.labels)
    >>> whole = moseg.Problem(["all"], "even_parts").evaluate(octopus, 0 * truth.labels)
    >>> bool(parts.cost.value < whole.cost.value / 5)
    True
    """
    summaries = segmentation.fields(_LOG)
    weighted = (
        part.area * summary.spread**2
        for part, summary in zip(segmentation.parts, summaries, strict=True)
    )
    return math.fsum(weighted) / segmentation.shape.area
