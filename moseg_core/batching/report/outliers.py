r"""How unlike the others each shape of a batch is, from what its parts measure.

Of every measure of every part the shapes of a batch have a distribution. What is usual is its
median, and what is usual for a deviation its median deviation, times 1.4826, as for a normal
distribution (Hampel 1974, doi:10.1080/01621459.1974.10482962): unlike mean and standard deviation,
these are not those of the outliers. A shape is as unlike the others as the root mean square of its
deviations over all measures, each counted at most :data:`MOST` times what is usual, so that one
measure does not decide. A part that a shape lacks, and at least half of the others have, deviates
by as much, and so does one that few others have.

Lengths are taken relative to the diagonal of the shape, areas and volumes likewise: a large ant is
no outlier. Where the parts are has no part in it, since shapes lie in space as they please.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from moseg_core.search.part_table import Cell
from moseg_core.types import BoolArray, FloatArray

MOST = 10.0
"""As how many usual deviations a larger one counts."""

FEWEST = 5
"""With fewer shapes nothing is usual."""

#: The least that a usual deviation is taken for, relative to the median: a hundred equal copies
#: and one that differs in the ninth digit are all alike.
_LEAST = 0.01
#: Powers of the diagonal that measures are relative to.
_POWERS = {
    **dict.fromkeys(("length", "width", "height", "thickness", "boundary"), 1),
    "closed_volume": 3,
    "hull_volume": 3,
}
#: What counts as it is, beside the terms and the measures of bundles.
_PLAIN = ("share", "pieces")
#: What says how large a shape is, or where it lies.
_PASSED_OVER = ("elements", "area", "centroid_", "axis", "center_", "shape_")
_COST = "cost"
_SHOWN = 3


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """A measure in which a shape differs from the others.

    Parameters
    ----------
    part : str
        Empty for one of the whole shape.
    measure : str
        "present" where it is the part itself that is there or not.
    value : float
        The shape's.
    usual : float
        The median of all shapes.
    size : float
        In usual deviations; above 0 where the value is greater.
    """

    part: str
    measure: str
    value: float
    usual: float
    size: float


@dataclass(frozen=True, kw_only=True)
class Likeness:
    """How unlike the others a shape is.

    Parameters
    ----------
    score : float
        From 0, which is as usual as can be, to :data:`MOST`.
    deviations : tuple of Deviation
        The largest, at most one for each part.
    """

    score: float
    deviations: tuple[Deviation, ...]


def compare_shapes(tables: Sequence[Sequence[Mapping[str, Cell]]]) -> list[Likeness] | None:
    """How unlike the others each shape is.

    Parameters
    ----------
    tables : sequence of sequence of mapping
        For each shape the rows of its table of parts (:class:`moseg_core.PartTable`).

    Returns
    -------
    list of Likeness
        In the order of the shapes; None for fewer than :data:`FEWEST`.

    Examples
    --------
    >>> usual = [{"part": "leg", "length": 2.0, "shape_diagonal": 4.0, "shape_cost": 1.0}]
    >>> other = [{"part": "leg", "length": 3.0, "shape_diagonal": 4.0, "shape_cost": 1.0}]
    >>> found = compare_shapes([usual] * 9 + [other])
    >>> found[0].score, found[9].score > 5
    (0.0, True)
    >>> found[9].deviations[0].measure, found[9].deviations[0].value, found[9].deviations[0].usual
    ('length', 0.75, 0.5)
    """
    if len(tables) < FEWEST:
        return None
    values = [_measures(rows) for rows in tables]
    names = sorted({name for shape in values for name in shape})
    whole = np.array([[shape.get(name, np.nan) for name in names] for shape in values])
    presence = sorted({str(row["part"]) for rows in tables for row in rows if _there(row)})
    there = np.array([[part in _parts(rows) for part in presence] for rows in tables])
    columns = [*names, *((part, "present") for part in presence)]
    sizes = np.hstack([_deviations(whole), _presence(there)])
    medians = np.hstack([np.nanmedian(whole, axis=0), np.median(there, axis=0)])
    whole = np.hstack([whole, there.astype(np.float64)])
    counted = np.where(np.isfinite(sizes), np.clip(sizes, -MOST, MOST), 0.0)
    n_measures = np.maximum(np.isfinite(sizes).sum(axis=1), 1)
    scores = np.sqrt((counted**2).sum(axis=1) / n_measures)
    return [
        Likeness(score=float(score), deviations=_largest(columns, whole[k], medians, counted[k]))
        for k, score in enumerate(scores)
    ]


def _measures(rows: Sequence[Mapping[str, Cell]]) -> dict[tuple[str, str], float]:
    """What is compared of one shape: numbers by part and measure, free of units."""
    found: dict[tuple[str, str], float] = {}
    for row in rows:
        diagonal, part = row.get("shape_diagonal"), str(row["part"])
        if isinstance(row.get("shape_cost"), int | float):
            found["", _COST] = float(row["shape_cost"])  # type: ignore[arg-type]  # just looked at
        for name, value in row.items():
            if isinstance(value, bool) or not isinstance(value, int | float):
                continue
            if name in _POWERS:
                if isinstance(diagonal, int | float) and diagonal > 0:
                    found[part, name] = float(value) / float(diagonal) ** _POWERS[name]
            elif name in _PLAIN or not name.startswith(_PASSED_OVER):
                found[part, name] = float(value)
    return found


def _there(row: Mapping[str, Cell]) -> bool:
    return bool(row.get("elements", 1))


def _parts(rows: Sequence[Mapping[str, Cell]]) -> set[str]:
    return {str(row["part"]) for row in rows if _there(row)}


def _deviations(values: FloatArray) -> FloatArray:
    """(n, m) deviations from the median in usual ones; nan where little is known."""
    medians = np.nanmedian(values, axis=0)
    usual = 1.4826 * np.nanmedian(np.abs(values - medians), axis=0)
    usual = np.maximum(usual, np.maximum(_LEAST * np.abs(medians), 1e-9))
    few = np.isfinite(values).sum(axis=0) < FEWEST
    return np.where(few, np.nan, (values - medians) / usual)


def _presence(there: BoolArray) -> FloatArray:
    """(n, p) how a shape deviates in having a part, or not."""
    usual = there.mean(axis=0) >= 0.5
    return np.where(there == usual, 0.0, np.where(there, MOST, -MOST))


def _largest(
    columns: Sequence[tuple[str, str]], values: FloatArray, medians: FloatArray, sizes: FloatArray
) -> tuple[Deviation, ...]:
    """The largest deviations that are worth a word, one for each part."""
    found: dict[str, Deviation] = {}
    for k in np.argsort(-np.abs(sizes), kind="stable"):
        part, measure = columns[k]
        if abs(sizes[k]) < 3 or len(found) == _SHOWN:
            break
        if part not in found:
            found[part] = Deviation(
                part=part,
                measure=measure,
                value=float(values[k]),
                usual=float(medians[k]),
                size=float(sizes[k]),
            )
    return tuple(found.values())
