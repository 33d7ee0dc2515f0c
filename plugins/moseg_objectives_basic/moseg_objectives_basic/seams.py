"""Objectives on the boundaries of parts: how short they are, and whether they lie in creases.

People see the end of a part where the surface turns in (the minima rule of Hoffman and Richards
1984, doi:10.1016/0010-0277(84)90022-2), and where it is narrow (the short-cut rule of Singh,
Seyranian and Hoffman 1999, doi:10.3758/bf03206891). ``short_boundary`` and ``creased_boundary`` are
of one part, ``short_boundaries`` and ``creased_boundaries`` of all; ``separate`` and
``separate_parts`` are both rules in one. 0 is best.
"""

from __future__ import annotations

import math

import numpy as np

from moseg_core import Part, PartArray, Segmentation, objective
from moseg_objectives_basic.arrays import FloatArray, row_sums
from moseg_objectives_basic.fields.concavity import CHEAP, DEAR

_UNCREASED = "basic:uncreased"


def all_short_boundary(parts: PartArray) -> FloatArray:
    """:func:`short_boundary` of several parts, (k,) float."""
    lengths, areas = parts.boundary_lengths, parts.areas
    if parts.shape.solid:
        return lengths / (lengths + np.cbrt(36.0 * math.pi * areas**2))
    return lengths / (lengths + np.sqrt(4.0 * math.pi * areas))


def all_short_boundaries(segmentations: PartArray) -> FloatArray:
    """:func:`short_boundaries` of several segmentations, (k,) float."""
    shape = segmentations.shape
    unit = shape.box_diagonal**2 if shape.solid else shape.box_diagonal
    return row_sums(segmentations.boundary_lengths) / 2.0 / unit  # each is that of two parts


def all_creased_boundary(parts: PartArray) -> FloatArray:
    """:func:`creased_boundary` of several parts, (k,) float; of parts of segmentations (k, n)."""
    means = np.where(parts.boundary_lengths > 0, parts.boundary_means(_UNCREASED), 0.0)
    return np.clip(means, 0.0, 1.0)


def all_creased_boundaries(segmentations: PartArray) -> FloatArray:
    """:func:`creased_boundaries` of several segmentations, (k,) float."""
    lengths = segmentations.boundary_lengths
    total = row_sums(lengths * all_creased_boundary(segmentations))
    whole = row_sums(lengths)
    means: FloatArray = np.divide(total, whole, out=np.zeros_like(whole), where=whole > 0)
    return means


@objective(
    range=(0, 1),
    requires=("adjacency",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    vectorized=all_short_boundary,
)
def short_boundary(part: Part) -> float:
    """``L / (L + sqrt(4 pi A))``: how long the part's boundary is, for its area.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        ``L`` is the length of the boundary, ``A`` the area, and the root the boundary of a disc
        of that area: 1/2 for a disc cut out of a plane, less for a finger cut off at its root,
        0 where the part has no boundary; 0 is best. Of a part of a solid, ``L`` is the area of
        the cut, ``A`` the volume, and in place of the root stands the surface of a ball,
        ``(36 pi A^2)^(1/3)``.

    Notes
    -----
    The short-cut rule, Singh, Seyranian and Hoffman 1999, doi:10.3758/bf03206891.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> round(Problem(["a", "b"], "short_boundary(b)").evaluate(strip, [0, 1]).cost.value, 4)
    0.1236
    """
    length, area = part.boundary.length, part.area
    if part.shape.solid:
        return length / (length + math.cbrt(36.0 * math.pi * area**2))
    return length / (length + math.sqrt(4.0 * math.pi * area))


@objective(
    range=(0, math.inf),
    requires=("adjacency",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels"),
    vectorized=all_short_boundaries,
)
def short_boundaries(segmentation: Segmentation) -> float:
    """``L / d``: how long all boundaries are together, in diagonals of the shape.

    Parameters
    ----------
    segmentation : Segmentation

    Returns
    -------
    float
        ``d`` is the diagonal of the shape's bounding box in its principal axes. 0 is best. Of a
        solid ``L`` is the area of all cuts, and it is divided by ``d^2``.

    Notes
    -----
    The short-cut rule, Singh, Seyranian and Hoffman 1999, doi:10.3758/bf03206891.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 3, 0], [0, 3, 0], [4, 0, 0], [4, 3, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> round(Problem(["a", "b"], "short_boundaries").evaluate(strip, [0, 1]).cost.value, 9)
    0.6
    """
    shape = segmentation.shape
    unit = shape.box_diagonal**2 if shape.solid else shape.box_diagonal
    return segmentation.boundaries.length / unit


@objective(
    range=(0, 1),
    requires=("surface", "adjacency"),
    invariant_to=("rigid", "scale", "reflection", "order"),
    fields=(_UNCREASED,),
    vectorized=all_creased_boundary,
)
def creased_boundary(part: Part) -> float:
    """``mean (clip(1 - c, 0.15, 1.5) - 0.15) / 1.35``: how little of the boundary lies in creases.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        ``c`` is the concavity along the part's boundary. 0 where all of it lies in sharp creases,
        0.63 where the surface is flat, 1 on ridges that bulge in all directions; 0 is best. A
        part without boundary ends where the surface does, and has 0.

    Notes
    -----
    The minima rule, Hoffman and Richards 1984, doi:10.1016/0010-0277(84)90022-2.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("hammer"), hammer.n_elements)
    >>> halves = (hammer.points[:, 0] > hammer.frame.center[0]).astype(int)
    >>> problem = moseg.Problem(truth.names, "creased_boundary(head)")
    >>> values = [problem.evaluate(hammer, each).cost.value for each in (truth.labels, halves)]
    >>> bool(values[0] < values[1])
    True
    """
    boundary = part.boundary
    return _within(boundary.mean(_UNCREASED)) if boundary.length > 0 else 0.0


@objective(
    range=(0, 1),
    requires=("surface", "adjacency"),
    invariant_to=("rigid", "scale", "reflection", "order", "labels"),
    fields=(_UNCREASED,),
    vectorized=all_creased_boundaries,
)
def creased_boundaries(segmentation: Segmentation) -> float:
    """``mean (clip(1 - c, 0.15, 1.5) - 0.15) / 1.35``: how little of all boundaries is in creases.

    Parameters
    ----------
    segmentation : Segmentation

    Returns
    -------
    float
        ``c`` is the concavity along the boundaries, see :func:`creased_boundary`: 0 to 1; 0 is
        best, and what there is without boundaries.

    Notes
    -----
    The minima rule, Hoffman and Richards 1984, doi:10.1016/0010-0277(84)90022-2. A mean: times
    ``short_boundaries`` it would be the cost of all boundaries, so much for each piece.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("hammer"), hammer.n_elements)
    >>> found = moseg.Problem(truth.names, "creased_boundaries").evaluate(hammer, truth.labels)
    >>> bool(0 < found.cost.value < 0.63)
    True
    """
    boundaries = segmentation.boundaries
    return _within(boundaries.mean(_UNCREASED)) if boundaries.length > 0 else 0.0


def all_separate(parts: PartArray) -> FloatArray:
    """:func:`separate` of several parts, (k,) float; of parts of segmentations (k, n)."""
    lengths = parts.boundary_lengths
    means = np.where(lengths > 0, parts.boundary_means(_UNCREASED), 0.0)
    joined = lengths * (CHEAP + (DEAR - CHEAP) * means)
    values: FloatArray = joined / (joined + np.sqrt(4.0 * math.pi * parts.areas))
    return values


def all_separate_parts(segmentations: PartArray) -> FloatArray:
    """:func:`separate_parts` of several segmentations, (k,) float."""
    values = all_separate(segmentations)
    means: FloatArray = row_sums(values) / values.shape[1]
    return means


@objective(
    range=(0, 1),
    requires=("surface", "adjacency"),
    invariant_to=("rigid", "scale", "reflection", "order"),
    fields=(_UNCREASED,),
    vectorized=all_separate,
)
def separate(part: Part) -> float:
    """``U / (U + sqrt(4 pi A))``: how firmly the part is joined to the rest, for its area.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        ``U`` is the length of the boundary, each piece of it times ``clip(1 - c, 0.15, 1.5)``
        with ``c`` the concavity there, so that a crease counts little; ``A`` the area, and the
        root the boundary of a disc of that area. 1/2 for a disc cut out of a plane, less for a
        finger cut off at its root, still less where there is a crease around the root; 0 where
        the part has no boundary; 0 is best.

    Notes
    -----
    The minima rule and the short-cut rule in one: Hoffman and Richards 1984,
    doi:10.1016/0010-0277(84)90022-2; Singh, Seyranian and Hoffman 1999, doi:10.3758/bf03206891.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("hammer"), hammer.n_elements)
    >>> halves = (hammer.points[:, 0] > hammer.frame.center[0]).astype(int)
    >>> problem = moseg.Problem(truth.names, "separate(*)")
    >>> values = [problem.evaluate(hammer, each).cost.value for each in (truth.labels, halves)]
    >>> bool(values[0] < values[1])
    True
    """
    boundary = part.boundary
    if not boundary.length > 0:
        return 0.0
    joined = boundary.length * (CHEAP + (DEAR - CHEAP) * boundary.mean(_UNCREASED))
    return joined / (joined + math.sqrt(4.0 * math.pi * part.area))


@objective(
    range=(0, 1),
    requires=("surface", "adjacency"),
    invariant_to=("rigid", "scale", "reflection", "order", "labels"),
    fields=(_UNCREASED,),
    vectorized=all_separate_parts,
)
def separate_parts(segmentation: Segmentation) -> float:
    """``mean_i separate(P_i)``: how firmly parts are joined, for their area.

    Parameters
    ----------
    segmentation : Segmentation

    Returns
    -------
    float
        The mean of :func:`separate` over all parts, each of which counts alike, however large; 0
        is best. A mean, so that costs of different numbers of parts compare.

    Notes
    -----
    The minima rule and the short-cut rule in one: Hoffman and Richards 1984,
    doi:10.1016/0010-0277(84)90022-2; Singh, Seyranian and Hoffman 1999, doi:10.3758/bf03206891.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("hammer"), hammer.n_elements)
    >>> problem = moseg.Problem(truth.names, "separate_parts + separate(*)")
    >>> mean, each = problem.evaluate(hammer, truth.labels).terms
    >>> round(each.value / mean.value, 9)
    2.0
    """
    boundaries = segmentation.boundaries
    some = boundaries.around > 0  # of the others, :func:`separate` is 0
    lengths = boundaries.around[some]
    joined = lengths * (CHEAP + (DEAR - CHEAP) * boundaries.means_around(_UNCREASED)[some])
    values = joined / (joined + np.sqrt(4.0 * math.pi * segmentation.areas[some]))
    return math.fsum(values.tolist()) / segmentation.n_parts


def _within(value: float) -> float:
    """A mean of numbers from 0 to 1, without what rounding adds."""
    return min(1.0, max(0.0, value))
