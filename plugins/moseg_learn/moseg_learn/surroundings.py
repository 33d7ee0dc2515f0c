"""The field ``surroundings``: what lies around each element, within a distance along the surface.

The tip of a finger and the tip of a nose are as thick and as concave. What tells them apart lies
around them: how much surface is near, whether it is long, wide or deep, how thick and how remote it
is. Such quantities in neighbourhoods of several sizes are what parts are recognised by when they
are learned from examples (Kalogerakis, Hertzmann and Singh 2010, doi:10.1145/1778765.1778839), and
:mod:`moseg_learn.looks` takes them from here.

All follow from sums over what is in reach (:mod:`moseg_learn.neighbourhoods`), of area, first and
second moments, of normals and their products, and of the fields of the bundle ``basic``.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from moseg_core import Interval, Shape, UsageError, field_values, unknown
from moseg_learn.neighbourhoods import FloatArray, Neighbourhoods
from moseg_learn.normals import group_normals, unit

QUANTITIES = (
    *("area", "length", "width", "depth"),
    *("thickness", "concavity", "remoteness", "offset"),
    *("flatness", "bending", "doming", "hollow"),
)
"""What there is to know of the surroundings, in the order of the columns of :func:`around`."""

_MEANS = ("basic:log_thickness", "basic:concavity", "basic:remoteness")

_SQUARE = [0, 1, 2, 1, 3, 4, 2, 4, 5]
"""Of the nine numbers of a symmetric matrix, which of the six that are kept of it each is."""

_THIN = 0.01
"""What scales are at least, in radii: how much flatter a patch is than that is chance."""


def surroundings(
    shape: Shape, *, of: str = "area", radius: Annotated[float, Interval(0.01, 2)] = 0.08
) -> FloatArray:
    """What lies within a distance along the surface.

    Parameters
    ----------
    shape : Shape
        A surface of which is known which elements touch.
    of : str
        Which quantity, one of :data:`QUANTITIES`. ``area``, ``length``, ``width``, ``depth``: the
        logarithm of the share of the shape's area that is within reach, of
        its first scale (the standard deviation along its first principal axis, in diagonals of
        the shape), of its second scale over its first, of its third over its first; scales are
        taken to be at least a hundredth of the radius. ``thickness``, ``concavity``,
        ``remoteness``: the mean there of ``basic:log_thickness``, ``basic:concavity``,
        ``basic:remoteness``. ``offset``: how far from the element its centroid is, in radii: near
        0 amid a plate, 0.5 at the end of a rod. ``flatness``: the length of the mean of the
        normals there, 1 of a plane, 0 of a ball or of both sides of a plate. ``bending``,
        ``doming``: the second and third eigenvalue of the mean of their products ``n n'``, 0 and 0
        of a plane, 1/2 and 0 of a tube, 1/3 and 1/3 of a ball. ``hollow``: how far the centroid
        lies in front of the element, along its outward normal, in radii; negative on a bulge.
    radius : float
        In diagonals of the shape.

    Returns
    -------
    (F,) float

    Raises
    ------
    UsageError
        Another quantity.

    Notes
    -----
    On more than 1500 elements distances go between as many groups
    (:mod:`moseg_learn.neighbourhoods`), and elements have a mean over the groups around them.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> depth = moseg.field_values(hammer, "learn:surroundings", of="depth", radius=0.16)
    >>> bool(depth.min() >= np.log(0.01) - 0.5 and depth.max() <= 0)
    True
    """
    if of not in QUANTITIES:
        raise UsageError(f"field 'learn:surroundings': {unknown('quantity', of, QUANTITIES)}")
    return Neighbourhoods.of(shape).on_elements(around(shape, radius)[:, QUANTITIES.index(of)])


def around(shape: Shape, radius: float) -> FloatArray:
    """All quantities of the surroundings of each group, computed once and kept with the shape.

    Parameters
    ----------
    shape : Shape
        As the user gave it.
    radius : float
        In diagonals of the shape.

    Returns
    -------
    (K, 12) float
        In the order of :data:`QUANTITIES`.
    """
    key = ("learn surroundings", radius)
    if key not in shape.made_from:
        shape.made_from[key] = _around(shape, radius)
    kept: FloatArray = shape.made_from[key]
    return kept


def _around(shape: Shape, radius: float) -> FloatArray:
    hoods = Neighbourhoods.of(shape)
    groups, areas, diagonal = hoods.groups, hoods.areas, shape.box_diagonal
    points = (groups.points - groups.frame.center) / diagonal
    means = [hoods.of_elements(field_values(shape, name)) for name in _MEANS]
    facing, products = group_normals(shape)
    second_moments = groups.second_moments / (areas * diagonal**2)[:, None]
    columns = [points, second_moments, facing, products, np.stack(means, 1)]
    share = hoods.within(radius) * areas
    total = share.sum(axis=1)
    found = share @ np.concatenate(columns, axis=1) / total[:, None]
    middle, second = found[:, :3], found[:, 3:9][:, _SQUARE].reshape(-1, 3, 3)
    variances = np.linalg.eigvalsh(second - middle[:, :, None] * middle[:, None, :])[:, ::-1]
    turning = np.linalg.eigvalsh(found[:, 12:18][:, _SQUARE].reshape(-1, 3, 3))[:, ::-1]
    scales = np.log(np.maximum(variances, (_THIN * radius) ** 2)) / 2.0
    return np.column_stack(
        [
            np.log(total / areas.sum()),
            scales[:, 0],
            scales[:, 1:] - scales[:, :1],
            found[:, 18:],
            np.linalg.norm(middle - points, axis=1) / radius,
            np.linalg.norm(found[:, 9:12], axis=1),
            turning[:, 1:],
            np.einsum("ij,ij->i", middle - points, unit(facing)) / radius,
        ]
    )
