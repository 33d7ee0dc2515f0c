"""Fields: a number for each element, computed once per shape, shared by all objectives.

How thick the shape is, how far from its middle, how concave: what a whole search needs again and
again of every candidate is known of each element beforehand. A bundle offers a field by a
:class:`~moseg_core.components.discovery.specs.FieldSpec`; its target is a function of a shape::

    def height(shape: Shape) -> FloatArray:
        return shape.points[:, 2]

A field is always computed on the shape as the user gave it, element by element, and kept with that
shape. All other versions have it from there: an element of an embedded shape (Sec. 9) has the value
that it has on the original; a super-element (:mod:`moseg_core.shape.coarse`) stands for the values
of its members, by their sums. So a part's mean is the same on every level.

Of a part, ``part.field(name)`` is a :class:`FieldSummary`; of the boundary of a part,
``part.boundary.mean(name)`` is the mean along it (:mod:`moseg_core.components.boundary`).
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from moseg_core.components.discovery.lookup import FoundField, Lookup
from moseg_core.components.profile import timed
from moseg_core.components.requirements import demand
from moseg_core.errors import REPORT, PluginError
from moseg_core.language import Table
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, frozen

Numbers = TypeVar("Numbers")


class FieldSummary(NamedTuple, Generic[Numbers]):
    """A field over one part, weighted by area; or over several, with an array for each number.

    Parameters
    ----------
    mean, spread : float
        Mean and standard deviation, in the field's units.
    least, greatest : float
        Over the elements that have an area.
    """

    mean: Numbers
    spread: Numbers
    least: Numbers
    greatest: Numbers


def field_values(
    shape: Shape, name: str, *, lookup: Lookup | None = None, **parameters: Any
) -> FloatArray:
    """The values of a field on a shape.

    Parameters
    ----------
    shape : Shape
        Any version: as the user gave it, embedded or coarse.
    name : str
        ``bundle:name``, or the name alone where it is unique.
    lookup : Lookup, optional
        Where to look for it; everything installed by default.
    **parameters
        The field's own parameters; a table may be any mapping.

    Returns
    -------
    (F,) float
        For each element of `shape`; for a super-element the mean over its members by area.

    Raises
    ------
    ShapeError
        The shape lacks what the field requires.
    UsageError
        No installed bundle has the field.
    PluginError
        The field's bundle is broken, or its values are not finite numbers, one per element.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> thickness = moseg.field_values(hammer, "basic:thickness")
    >>> thickness.shape == hammer.areas.shape, bool((thickness > 0).all())
    (True, True)
    """
    found = (Lookup() if lookup is None else lookup).field(name)
    # The key of what is kept; components themselves hand on the tables that they were given.
    parameters = {k: Table(v) if isinstance(v, Mapping) else v for k, v in parameters.items()}
    values = _values(shape, found, parameters)
    if shape.members is None:
        return values
    sums = field_sums(shape, found, parameters)
    with np.errstate(invalid="ignore", divide="ignore"):
        means = sums.middle + sums.weighted / shape.areas
    weightless = shape.areas <= 0
    if weightless.any():
        count = np.bincount(shape.members, minlength=shape.n_elements)
        plain = np.bincount(shape.members, values, shape.n_elements) / count
        means[weightless] = plain[weightless]
    return frozen(means)


@dataclass(frozen=True, eq=False, kw_only=True)
class FieldSums:
    """What parts of a level need of a field: sums and extremes for each of its elements.

    Parameters
    ----------
    middle : float
        The field's mean over the whole shape. Sums are of values less this, so that the spread of
        a part does not drown in rounding.
    weighted, squared : (F,) float
        Area times value, and area times value squared, summed over the members.
    least, greatest : (F,) float
        Over members with an area; infinite where there is none.
    """

    middle: float
    weighted: FloatArray
    squared: FloatArray
    least: FloatArray
    greatest: FloatArray


def field_sums(level: Shape, found: FoundField, parameters: Mapping[str, Any]) -> FieldSums:
    """The sums of a field over the elements of a level, computed once and kept with it."""
    key = ("field sums", *field_key(found, parameters))
    if key not in level.made_from:
        values = _values(level, found, parameters)
        areas = level.input.areas
        middle = float((areas * values).sum() / areas.sum())
        off = values - middle
        columns = [areas * off, areas * off**2]
        has_area = areas > 0
        least = np.where(has_area, values, np.inf)
        greatest = np.where(has_area, values, -np.inf)
        if level.members is not None:
            columns = [
                np.bincount(level.members, column, level.n_elements).astype(np.float64)
                for column in columns
            ]
            low, high = np.full((2, level.n_elements), np.inf)
            np.minimum.at(low, level.members, least)
            np.minimum.at(high, level.members, -greatest)
            least, greatest = low, -high
        level.made_from[key] = FieldSums(
            middle=middle,
            weighted=frozen(columns[0]),
            squared=frozen(columns[1]),
            least=frozen(least),
            greatest=frozen(greatest),
        )
    sums: FieldSums = level.made_from[key]
    return sums


def link_values(level: Shape, found: FoundField, parameters: Mapping[str, Any]) -> FloatArray:
    """(E,) float: for each link of a level its length times the field's mean over both sides."""
    key = ("field along links", *field_key(found, parameters))
    if key not in level.made_from:
        fine, values = level.input.links, _values(level, found, parameters)
        along = fine.lengths * (values[fine.first] + values[fine.second]) / 2
        if level.members is not None:
            along = fine.grouped(level.members, along, level.n_elements).lengths
        level.made_from[key] = frozen(along)
    kept: FloatArray = level.made_from[key]
    return kept


def field_key(found: FoundField, parameters: Mapping[str, Any]) -> tuple[Hashable, ...]:
    """What tells a field with certain parameters from all others, whether they are its defaults."""
    every = {**found.defaults, **parameters}
    return (found.id, found.source, *((name, every[name]) for name in sorted(every)))


def _values(shape: Shape, found: FoundField, parameters: Mapping[str, Any]) -> FloatArray:
    """(F of the input,) float: a field on the user's own shape, computed once and kept with it."""
    own = shape.input
    own = own if own.original is None else own.original
    key = ("field", *field_key(found, parameters))
    if key not in own.made_from:
        demand(own, found.requires, f"field '{found.id}'")
        with timed("stage", "fields"):
            values = found.function(own, **parameters)
        try:
            array = np.array(values, dtype=np.float64)
        except (TypeError, ValueError):
            array = np.empty(0)
        if array.shape != (own.n_elements,) or not np.isfinite(array).all():
            raise PluginError(
                f"field '{found.id}' must return a finite number for each of the"
                f" {own.n_elements} {own.noun}s of '{own.name}'; {REPORT}"
            )
        own.made_from[key] = frozen(array)
    kept: FloatArray = own.made_from[key]
    return kept
