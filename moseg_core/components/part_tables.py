"""What the parts of one labelling share: fields and boundaries, a table each, made when asked for.

Of a field or a boundary one pass over the elements or links says what there is to say of all
parts, for little more than it costs to say it of one. The first part that is asked makes the
table, the others read their row.

Most parts of a candidate of the search were seen before, and are not made. So fields and principal
axes are taken of the parts that have been made by the time that one of them is asked for.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable
from functools import cached_property
from typing import Any

import numpy as np

from moseg_core.components.boundary import Boundaries, Boundary
from moseg_core.components.field import FieldSummary, field_sums
from moseg_core.components.labellings import Labellings, signed
from moseg_core.errors import MosegError
from moseg_core.types import BoolArray, FloatArray, frozen


class PartTables:
    """Tables of fields and boundaries, with a row for each part.

    Parameters
    ----------
    labellings : Labellings
        A single one.
    made : collection of int
        Numbers of the parts that have been made so far; it grows.
    """

    def __init__(self, labellings: Labellings, made: Collection[int]) -> None:
        self._labellings = labellings
        self._moments = labellings.summary.moments[0]
        self._made = made
        self._fields: dict[Hashable, dict[int, FieldSummary[float]]] = {}
        self._eigen: dict[int, tuple[FloatArray, FloatArray]] = {}
        self._axes: dict[int, FloatArray] = {}

    def field(self, name: str, parameters: dict[str, Any], part: int) -> FieldSummary[float]:
        """A field's summary over a part."""
        asked = (name, *parameters.items()) if parameters else name
        known = self._fields.get(asked)
        if known is None:
            known = self._fields[asked] = {}
        if part not in known:
            missing = self._missing(known, part)
            rows = self._labellings.field(name, parameters, self._mask(missing))[0]
            for k, row in zip(missing, rows[missing].tolist(), strict=True):
                known[k] = FieldSummary._make(row)
        return known[part]

    def _mask(self, parts: list[int]) -> BoolArray:
        """(1, n) bool: those parts."""
        mask = np.zeros((1, len(self._moments)), np.bool_)
        mask[0, parts] = True
        return mask

    def _missing(self, known: Collection[int], part: int) -> list[int]:
        """The parts to look at with the one asked for: those made so far, at the second time all.

        So there are two passes at most, in whatever order parts are made and asked.
        """
        if not known:
            return sorted({part, *self._made})
        return [k for k in range(len(self._moments)) if k not in known]

    def _principal(self, part: int) -> tuple[FloatArray, FloatArray]:
        """Scales and axes, not signed, of a part that has an area."""
        if part not in self._eigen:
            missing = [k for k in self._missing(self._eigen, part) if self._moments[k, 0] > 0]
            scales, axes = self._labellings.axes(self._mask(missing))
            for k in missing:
                self._eigen[k] = frozen(scales[0, k].copy()), axes[0, k]
        return self._eigen[part]

    def centroid(self, part: int) -> FloatArray:
        """(3,) float, model units: the centroid of a part that has an area."""
        center = self._labellings.level.input.frame.center
        return frozen(self._moments[part, 1:4] / self._moments[part, 0] + center)

    def scales(self, part: int) -> FloatArray:
        """(3,) float, descending: the scales of a part that has an area."""
        return self._principal(part)[0]

    def axes(self, part: int) -> FloatArray:
        """(3, 3) float: the axes of a part that has an area, in the order of the scales."""
        if part not in self._axes:
            self._axes[part] = frozen(signed(self._principal(part)[1]))
        return self._axes[part]

    def mean_of_all(self, name: str, parameters: dict[str, Any]) -> float:
        """A field's mean over the whole shape."""
        found = self._labellings.lookup.field(name)
        return field_sums(self._labellings.level, found, parameters).middle

    def boundary(self, part: int) -> Boundary:
        """The boundary of a part with all others."""
        return Boundary(
            length=self._lengths[part],
            _along=lambda name, **parameters: float(
                self._labellings.integrals(name, parameters)[0][0, part]
            ),
        )

    def between(self, first: int, second: int) -> Boundary:
        """The boundary between two parts."""
        return Boundary(
            length=float(self._labellings.lengths()[1][0, first, second]),
            _along=lambda name, **parameters: float(
                self._labellings.integrals(name, parameters)[1][0, first, second]
            ),
        )

    def lengths_between(self, part: int, others: list[int]) -> FloatArray:
        """(n,) float: the lengths of the boundaries of a part with several others."""
        return self._labellings.lengths()[1][0, part, others]

    @cached_property
    def boundaries(self) -> Boundaries:
        """The boundaries between all parts."""
        whole, between = self._labellings.lengths()
        return Boundaries(
            lengths=between[0],
            around=whole[0],
            _along=lambda name, **given: self._labellings.integrals(name, given)[1][0],
            _around=lambda name, **given: self._labellings.integrals(name, given)[0][0],
        )

    @cached_property
    def _lengths(self) -> list[float]:
        lengths: list[float] = self._labellings.lengths()[0][0].tolist()
        return lengths


def pair_of_one_labelling(first: PartTables, second: PartTables) -> PartTables:
    """The tables of two parts, which must be of one labelling.

    Raises
    ------
    MosegError
        They are of two.
    """
    if first is not second:
        raise MosegError("parts of two segmentations have no boundary with each other")
    return first
