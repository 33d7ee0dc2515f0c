"""What is measured of each part for a table: sizes in the user's units, places, terms.

Areas, centroids and axes are those of :class:`moseg_core.Part`, exact sums over the elements.
Length, width and height are *extents*, from one end of the part to the other along its principal
axes, as one would take them with a caliper, and not the standard deviations that objectives
compare.
The volume is that of the part as a shape of its own, its cuts capped
(:mod:`moseg_core.shape.volume.derived`).

What installed bundles bring as measures of a part, one number or several with names, are columns as
well (:func:`bundle_measures`). Of an evaluation each term about single parts gives a column in
which every part has its own value, each other term a column about the shape
(:mod:`moseg_core.search.part_table` says why). ``docs/measuring.md`` explains every column.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias

import numpy as np

from moseg_core.components.discovery.registry import Registry
from moseg_core.components.discovery.specs import MeasureSpec
from moseg_core.components.explanation import explain_component
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import ShapeError
from moseg_core.problem.aggregate import Evaluation, TermValue
from moseg_core.search.part_table import OF_SHAPE, Cell, PartTable
from moseg_core.shape.subshape import subshape
from moseg_core.types import FloatArray

Row: TypeAlias = dict[str, Cell]

THICKNESS = "basic:thickness"
"""The field that is measured as thickness, where it is installed; in diagonals of the shape."""

_XYZ = ("x", "y", "z")
_LABELS = re.compile(r"[\w*?\[\]/]+")


def measure_parts(
    segmentation: Segmentation,
    names: Sequence[str],
    *,
    source: Registry,
    evaluation: Evaluation | None = None,
    centers: Centers | None = None,
) -> PartTable:
    """A row for each part of a segmentation.

    Parameters
    ----------
    segmentation : Segmentation
        Of the user's own elements.
    names : sequence of str
        What each part is called.
    source : Registry
        Whose measures are columns.
    evaluation : Evaluation, optional
        Of these parts; terms and the cost are columns then.
    centers : Centers, optional
        One or more for each part.

    Returns
    -------
    PartTable
        A part without elements has a row in which little is known.

    Raises
    ------
    PluginError
        A measure of a bundle fails.

    Examples
    --------
    >>> from moseg_core.components.discovery.registry import Registry
    >>> from moseg_core.shape.shape import Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]], name="strip")
    >>> table = measure_parts(Segmentation.from_labels(strip, [0, 1], 2), ["a", "b"],
    ...                       source=Registry([]))
    >>> [(row["part"], row["area"], round(row["length"], 9)) for row in table]
    [('a', 1.0, 1.0), ('b', 4.0, 4.0)]
    """
    measures = bundle_measures(source)
    thick = any(component.id == THICKNESS for component in source.components("field"))
    diagonal: Row = {f"{OF_SHAPE}diagonal": segmentation.shape.box_diagonal}
    terms, of_shape = ({}, {}) if evaluation is None else _term_columns(evaluation)
    rows = []
    for k, (name, part) in enumerate(zip(names, segmentation.parts, strict=True)):
        row = _sizes(part, name)
        row["thickness"] = _thickness(part) if thick else None
        brought = [measure(part) for measure in measures]
        places = _places(part) | _center(None if centers is None else centers.of(k))
        # Single numbers first, profiles of many behind the places.
        for more in sorted(
            [*brought, places], key=lambda more: (len(more) > 1, more is not places)
        ):
            for column, value in more.items():
                row.setdefault(column, value)  # what is known already is not measured otherwise
        rows.append(row | terms.get(name, {}) | diagonal | of_shape)
    return PartTable.of_rows(rows)


def _sizes(part: Part, name: str) -> Row:
    """What every part has, whatever is installed."""
    shape, there = part.shape, part.area > 0
    boundary = shape.adjacency is not None and part.n_elements
    row: Row = {
        "shape": shape.name,
        "part": name,
        "elements": part.n_elements,
        "pieces": part.n_components if part.n_elements else 0,
        "area": _surface_area(part),
        "share": part.area / shape.area,
        "closed_volume": _closed_volume(part) if there else None,
        "boundary": part.boundary.length if boundary else None,
    }
    extents = np.ptp(part.axes @ part.vertices.T, axis=1) if there else None
    return row | _numbers(("length", "width", "height"), extents)


def _places(part: Part) -> Row:
    """Where a part is, and how it lies."""
    there = part.area > 0
    row = _numbers([f"centroid_{i}" for i in _XYZ], part.centroid if there else None)
    for k in range(3):
        axis = part.axes[k] if there else None
        row |= _numbers([f"axis{k + 1}_{i}" for i in _XYZ], axis)
    return row


def _numbers(names: Sequence[str], values: FloatArray | None) -> Row:
    if values is None:
        return dict.fromkeys(names)
    return dict(zip(names, values.tolist(), strict=True))


def _surface_area(part: Part) -> float:
    """Of a solid's part the exposed faces of its cells; of others what their elements have."""
    if not part.shape.solid:
        return part.area
    a, b, c = (part.vertices[part.triangles[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0


def _closed_volume(part: Part) -> float | None:
    """Volume of the part with its cuts capped, of a solid's its cells; None where it has none."""
    if part.shape.solid:
        return part.area
    try:
        return subshape(part.shape, part.elements).volume
    except ShapeError:  # the surface of a grid cannot be taken apart; or elements without area
        return None


def _thickness(part: Part) -> float | None:
    try:
        mean = part.field(THICKNESS).mean if part.area > 0 else math.nan
    except ShapeError:  # of clouds and solids: no surface to look through
        return None
    return mean * part.shape.box_diagonal if math.isfinite(mean) else None


def _center(centers: Centers | None) -> Row:
    """The first of a part's centres, which is the only one as a rule."""
    names = [f"center_{i}" for i in _XYZ]
    if centers is None or not len(centers.positions):
        return dict.fromkeys([*names, "center_weight"])
    return _numbers(names, centers.positions[0]) | {"center_weight": float(centers.weights[0])}


def bundle_measures(source: Registry) -> list[Callable[[Part], Row]]:
    """For each measure that bundles bring a function from a part to its columns.

    A measure that is one number is a column of its name, with the bundle in front where several
    have the name; one that is a named tuple of numbers, such as ``basic:likeness``, a column for
    each of them, ``likeness_area``. Measures that must be told something, or that only help to
    compute others, are none.

    Parameters
    ----------
    source : Registry
    """
    able = [
        component
        for component in source.components("measure")
        if isinstance(component.spec, MeasureSpec)
        and component.spec.keep
        and not any(p.required for p in explain_component(component).parameters)
    ]
    bare = [component.spec.name for component in able]
    return [
        _measured(component.id, _column(component.id if bare.count(name) > 1 else name))
        for component, name in zip(able, bare, strict=True)
    ]


def _measured(measure: str, column: str) -> Callable[[Part], Row]:
    def columns(part: Part) -> Row:
        if not part.area > 0:
            return {}
        try:
            value = part.measure(measure)
        except ShapeError:  # the shape lacks what the measure requires
            return {}
        if isinstance(value, int | float | np.number):
            return {column: float(value)}
        fields = getattr(value, "_fields", ())
        return {
            f"{column}_{_column(name)}": float(number)
            for name, number in zip(fields, value if fields else (), strict=True)
            if isinstance(number, int | float | np.number)
        }

    return columns


def _term_columns(evaluation: Evaluation) -> tuple[dict[str, Row], Row]:
    """By part the values of the terms about it; and the cost and the terms about several parts."""
    of_parts: dict[str, Row] = {}
    of_shape: Row = {f"{OF_SHAPE}cost": evaluation.cost.value}
    for term in evaluation.terms:
        if all(len(call.labels) == 1 for call in term.calls):
            for call in term.calls:
                row = of_parts.setdefault(call.labels[0], {})
                row[_new(f"term_{_objective(term)}", row)] = call.value
        else:
            known = any(call.value is not None for call in term.calls)
            name = "_".join([_objective(term), *_labels(term)])
            of_shape[_new(OF_SHAPE + name, of_shape)] = term.value if known else None
    return of_parts, of_shape


def _objective(term: TermValue) -> str:
    """The objective's name, with the space where the term says in which it is evaluated."""
    space = term.text.rpartition(")")[2].partition("@")[2].strip()
    return _column(term.objective.rpartition(":")[2] + (f"_{space}" if space else ""))


def _labels(term: TermValue) -> Iterator[str]:
    """The labels of a term as they were written, without its parameters: of ``leg*`` ``leg``."""
    inside = term.text.partition("(")[2].rpartition(")")[0]
    for word in inside.split(","):
        if _LABELS.fullmatch(word.strip()) and (name := _column(word)):
            yield name


def _new(name: str, taken: Row) -> str:
    """The name, or with a number behind it where there is such a column already."""
    found, count = name, 1
    while found in taken:
        count += 1
        found = f"{name}_{count}"
    return found


def _column(name: str) -> str:
    """A name that R and Python take as it is: letters, digits and ``_``."""
    return re.sub(r"\W+", "_", name).strip("_")
