"""The objective ``is``: what is known of a part, as typical values, give or take.

``is(leg*, area=0.06+-0.02, thickness=0.04+-0.01)`` says it as people have it: a leg has some 6 % of
the surface, and is a twenty-fifth of the animal thick. Each measure is cheap: sums over the
elements, fields (:mod:`moseg_objectives_basic.fields`) and boundaries, each made once for all parts
of a candidate. Measures are shares, ratios to the shape's diagonal or to the part's own size, so
that targets hold for shapes of any size and in any position.

With all of them given, ``is`` compares a part with a profile: of many parts of one name, the mean
and spread of each measure.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Mapping
from functools import lru_cache
from typing import Annotated, Any, TypeAlias

import numpy as np

from moseg_core import Detail, Interval, Part, PartArray, Target, TargetArray, objective
from moseg_objectives_basic.arrays import FloatArray, row_sums

_THICKNESS, _REMOTENESS, _CONCAVITY = "basic:thickness", "basic:remoteness", "basic:concavity"

_EXTENT = math.sqrt(12.0)
"""From the standard deviation along an axis to the length of a rod, or the diameter of a ball."""


_READ = {
    "thickness": _THICKNESS,
    "unevenness": _THICKNESS,
    "remoteness": _REMOTENESS,
    "nearest": _REMOTENESS,
    "farthest": _REMOTENESS,
    "crease": _CONCAVITY,
}
"""The fields that measures are taken from."""

BY_RATIO = frozenset({"area", "length", "width", "depth", "spread", "thickness", "boundary"})
"""Measures of which ratios count: half as much is as far away as twice as much."""

_IN_PERCENT = frozenset({"area", "length", "width", "depth", "offcenter", "thickness"})
"""Measures that are shares, or ratios to the size of the shape."""

_Ratio: TypeAlias = Annotated[Target | None, Interval(1e-6)]


def fields_of(given: Mapping[str, Any]) -> tuple[str, ...]:
    """Ids of the fields that certain measures read.

    Examples
    --------
    >>> fields_of({"area": Target(0.1, 0.1), "nearest": Target(1.2, 0.1), "farthest": None})
    ('basic:remoteness',)
    """
    asked = (name for name, target in given.items() if target is not None and name in _READ)
    return tuple(dict.fromkeys(_READ[name] for name in asked))


def expected_share(given: Mapping[str, Any]) -> float | None:
    """The share of the area that is the target, None without one.

    Examples
    --------
    >>> expected_share({"area": Target(0.06, 0.02)}), expected_share({})
    (0.06, None)
    """
    area = given.get("area")
    return None if area is None else area.value


def disagreements(part: Part, **given: Target | None) -> list[Detail]:
    """What :func:`is_` compares of a part, what it expects there, and what each costs.

    The costs add up to the value of :func:`is_`.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> problem = Problem(["a", "b"], "is(a, area=0.1+-0.1, boundary=1+-1)")
    >>> print(problem.evaluate(strip, [0, 1]).terms[0].calls[0].details[0])
    area 20 %, typical 10 ± 10
    """
    asked = {name: target for name, target in given.items() if target is not None}
    values = measured(part, asked)
    return [
        Detail(
            name=name,
            value=values[name],
            cost=cost / len(asked),
            expected=asked[name],
            percent=name in _IN_PERCENT,
        )
        for name, cost in zip(asked, _costs(asked, values), strict=True)
    ]


def _costs(asked: Mapping[str, Target], values: Mapping[str, float]) -> list[float]:
    """How far each value is off its target."""
    return [
        target.ratio_cost(values[name]) if name in BY_RATIO else target.cost(values[name])
        for name, target in asked.items()
    ]


def measured(part: Part, names: Container[str]) -> dict[str, float]:
    """The measures of a part, by name: at least those that are asked for.

    Parameters
    ----------
    part : Part
    names : collection of str
        Of the parameters of :func:`is_`, which say what they are.

    Examples
    --------
    >>> from moseg_core import Segmentation, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> measured(Segmentation.from_labels(strip, [0, 1], 2).parts[0], ["area"])
    {'area': 0.2}
    """
    found: dict[str, float] = {}
    shape, own = part.shape, part.area
    # A length, for the part to be compared with itself.
    size = math.cbrt(own) if shape.solid else math.sqrt(own)
    if "area" in names:
        found["area"] = own / shape.area
    if "length" in names or "width" in names or "depth" in names or "spread" in names:
        s1, s2, s3 = part.scales.tolist()
        unit = _EXTENT / shape.box_diagonal
        found["length"], found["width"], found["depth"] = s1 * unit, s2 * unit, s3 * unit
        found["spread"] = math.hypot(s1, s2, s3) / size
    if "offcenter" in names:
        away = math.dist(part.centroid.tolist(), shape.centroid.tolist())
        found["offcenter"] = away / shape.box_diagonal
    if "thickness" in names or "unevenness" in names:
        thickness = part.field(_THICKNESS)
        found["thickness"] = thickness.mean
        found["unevenness"] = thickness.spread / thickness.mean
    if "remoteness" in names or "nearest" in names or "farthest" in names:
        remoteness = part.field(_REMOTENESS)
        found["remoteness"] = remoteness.mean
        found["nearest"], found["farthest"] = remoteness.least, remoteness.greatest
    if "boundary" in names or "crease" in names:
        edge = part.boundary
        found["boundary"] = edge.length / (size**2 if shape.solid else size)
        if "crease" in names:
            found["crease"] = edge.mean(_CONCAVITY) if edge.length > 0 else 0.0
    return found


def measured_of_all(parts: PartArray, names: Container[str]) -> dict[str, FloatArray]:
    """The measures of several parts, by name: :func:`measured` by arrays, (k,) float each.

    Parameters
    ----------
    parts : PartArray
    names : collection of str
    """
    found: dict[str, FloatArray] = {}
    shape, areas = parts.shape, parts.areas
    size = _each(math.cbrt, areas) if shape.solid else np.sqrt(areas)
    if "area" in names:
        found["area"] = areas / shape.area
    if "length" in names or "width" in names or "depth" in names or "spread" in names:
        s1, s2, s3 = np.ascontiguousarray(parts.scales.T)
        unit = _EXTENT / shape.box_diagonal
        found["length"], found["width"], found["depth"] = s1 * unit, s2 * unit, s3 * unit
        found["spread"] = _each(math.hypot, s1, s2, s3) / size
    if "offcenter" in names:
        away = _each(math.hypot, *(parts.centroids - shape.centroid).T)
        found["offcenter"] = away / shape.box_diagonal
    if "thickness" in names or "unevenness" in names:
        thickness = parts.field(_THICKNESS)
        found["thickness"] = thickness.mean
        found["unevenness"] = thickness.spread / thickness.mean
    if "remoteness" in names or "nearest" in names or "farthest" in names:
        remoteness = parts.field(_REMOTENESS)
        found["remoteness"] = remoteness.mean
        found["nearest"], found["farthest"] = remoteness.least, remoteness.greatest
    if "boundary" in names or "crease" in names:
        lengths = parts.boundary_lengths
        found["boundary"] = lengths / (size**2 if shape.solid else size)
        if "crease" in names:
            found["crease"] = np.where(lengths > 0, parts.boundary_means(_CONCAVITY), 0.0)
    return found


def _each(function: Callable[..., float], *values: FloatArray) -> FloatArray:
    """(k,) float: Python's function of each value, which rounds otherwise than numpy's."""
    return np.array([*map(function, *(column.tolist() for column in values))], np.float64)


def all_off(parts: PartArray, **given: Target | None) -> FloatArray:
    """:func:`is_` of several parts, (k,) float."""
    asked = {name: target for name, target in given.items() if target is not None}
    if not asked:
        return np.zeros(len(parts))
    values = measured_of_all(parts, asked)
    targets = _target_array(tuple(asked), tuple(asked.values()))
    return row_sums(targets.costs(np.stack([values[name] for name in asked], 1))) / len(asked)


@lru_cache(maxsize=1024)
def _target_array(names: tuple[str, ...], targets: tuple[Target, ...]) -> TargetArray:
    """Targets of measures; a search has the same for all its candidates."""
    return TargetArray(targets, tuple(name in BY_RATIO for name in names))


@objective(
    range=(0, math.inf),
    invariant_to=("rigid", "scale", "reflection", "order"),
    fields=fields_of,
    share=expected_share,
    details=disagreements,
    vectorized=all_off,
)
def is_(
    part: Part,
    *,
    area: Annotated[Target | None, Interval(1e-6, 1)] = None,
    length: _Ratio = None,
    width: _Ratio = None,
    depth: _Ratio = None,
    spread: _Ratio = None,
    offcenter: Annotated[Target | None, Interval(0)] = None,
    thickness: _Ratio = None,
    unevenness: Annotated[Target | None, Interval(0)] = None,
    remoteness: Annotated[Target | None, Interval(0)] = None,
    nearest: Annotated[Target | None, Interval(0)] = None,
    farthest: Annotated[Target | None, Interval(0)] = None,
    boundary: _Ratio = None,
    crease: Target | None = None,
) -> float:
    """``mean_m h((m - typical) / spread)``: how far the part is from what is known of it.

    Parameters
    ----------
    part : Part
    area : Target
        Share of the shape's area, ``area=0.06+-0.02``. Seeders look for parts of that size.
    length, width, depth : Target
        Extent along the part's principal axes, in diagonals of the shape: ``sqrt(12)`` times the
        scales, exact for the length of a rod, the sides of a plate and the diameter of a ball.
    spread : Target
        Radius of gyration over the root of the area: 0.28 for a ball, 0.41 for a square, more for
        what is long.
    offcenter : Target
        Distance of the part's centroid from that of the shape, in diagonals.
    thickness : Target
        Mean thickness, in diagonals.
    unevenness : Target
        Standard deviation of the thickness over its mean; 0 where it is even.
    remoteness, nearest, farthest : Target
        Mean, least and greatest remoteness: 1 in the middle of the shape, 2 at the end of a rod.
    boundary : Target
        Length of the boundary over the root of the area; 3.5 for a disc.
    crease : Target
        Mean concavity along the boundary, from -2 to 2; 0 where the surface is flat, and without
        a boundary.

    Returns
    -------
    float
        The mean over the measures that are given, of ``h(z) = z^2`` up to 2 spreads from the
        typical value and ``4 |z| - 4`` beyond: 0 at all targets, 1 where all are one spread
        away; 0 is best, and what there is where nothing is given. For area, length, width,
        depth, spread, thickness and boundary ratios count: half as much is as far away as twice
        as much (:meth:`moseg_core.Target.ratio_cost`).

    Notes
    -----
    ``h`` is Huber's, 1964, doi:10.1214/aoms/1177703732: a part that is quite another weighs no more
    than several that are a little off. On solids, areas are volumes, lengths of boundaries
    areas, and roots are taken accordingly.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> problem = Problem(["a", "b"], "is(a, area=0.1+-0.1) + is(b, area=0.8+-0.1, boundary=1+-1)")
    >>> [round(term.value, 9) for term in problem.evaluate(strip, [0, 1]).terms]
    [1.0, 0.5]
    """
    given = {
        "area": area,
        "length": length,
        "width": width,
        "depth": depth,
        "spread": spread,
        "offcenter": offcenter,
        "thickness": thickness,
        "unevenness": unevenness,
        "remoteness": remoteness,
        "nearest": nearest,
        "farthest": farthest,
        "boundary": boundary,
        "crease": crease,
    }
    asked = {name: target for name, target in given.items() if target is not None}
    off = _costs(asked, measured(part, asked))
    return math.fsum(off) / len(off) if off else 0.0
