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
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import FieldSummary, field_sums, link_values
from moseg_core.errors import MosegError
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, frozen


class PartTables:
    """Tables of fields and boundaries, with a row for each part.

    Parameters
    ----------
    level : Shape
    labels : (F of `level`,) int32
    moments : (n, 10) float
        Area, first and second moments of the parts about the shape's centre.
    lookup : Lookup
        Where fields are found.
    made : collection of int
        Numbers of the parts that have been made so far; it grows.
    """

    def __init__(
        self,
        level: Shape,
        labels: Int32Array,
        moments: FloatArray,
        lookup: Lookup,
        made: Collection[int],
    ) -> None:
        self._level = level
        self._labels = labels
        self._moments = moments
        self._areas = moments[:, 0]
        self._lookup = lookup
        self._made = made
        self._fields: dict[Hashable, dict[int, FieldSummary]] = {}
        self._eigen: dict[int, tuple[FloatArray, FloatArray]] = {}
        self._axes: dict[int, FloatArray] = {}
        self._along: dict[Hashable, tuple[list[float], FloatArray]] = {}

    def field(self, name: str, parameters: dict[str, Any], part: int) -> FieldSummary:
        """A field's summary over a part."""
        asked = (name, *parameters.items()) if parameters else name
        known = self._fields.get(asked)
        if known is None:
            known = self._fields[asked] = {}
        if part not in known:
            from moseg_core.shape.part_sums import summarize_field

            sums = field_sums(self._level, self._lookup.field(name), parameters)
            count = len(self._areas)
            missing = self._missing(known, part)
            wanted, rows = np.zeros(count, np.bool_), np.empty((count, 4))
            wanted[missing] = True
            summarize_field(
                self._labels,
                wanted,
                sums.weighted,
                sums.squared,
                sums.least,
                sums.greatest,
                self._areas,
                sums.middle,
                rows,
            )
            for k, row in zip(missing, rows[missing].tolist(), strict=True):
                known[k] = FieldSummary._make(row)
        return known[part]

    def _missing(self, known: Collection[int], part: int) -> list[int]:
        """The parts to look at with the one asked for: those made so far, at the second time all.

        So there are two passes at most, in whatever order parts are made and asked.
        """
        if not known:
            return sorted({part, *self._made})
        return [k for k in range(len(self._areas)) if k not in known]

    def _covariance(self, part: int) -> tuple[FloatArray, FloatArray]:
        """Scales (3,), descending, and (3, 3) eigenvectors of a part's covariance, ascending."""
        if part not in self._eigen:
            missing = [k for k in self._missing(self._eigen, part) if self._areas[k] > 0]
            areas = self._areas[missing, None]
            mean = self._moments[missing, 1:4] / areas
            second = self._moments[missing, 4:10] / areas
            square = second[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
            values, vectors = np.linalg.eigh(square - mean[:, :, None] * mean[:, None, :])
            # What the subtraction leaves of a flat part's thickness is rounding, not thickness.
            values[values < 1e-14 * (second[:, 0] + second[:, 3] + second[:, 5])[:, None]] = 0.0
            self._eigen.update(
                zip(missing, zip(np.sqrt(values[:, ::-1]), vectors, strict=True), strict=True)
            )
        return self._eigen[part]

    def centroid(self, part: int) -> FloatArray:
        """(3,) float, model units: the centroid of a part that has an area."""
        return frozen(self._moments[part, 1:4] / self._areas[part] + self._level.input.frame.center)

    def scales(self, part: int) -> FloatArray:
        """(3,) float, descending: the scales of a part that has an area."""
        return frozen(self._covariance(part)[0])

    def axes(self, part: int) -> FloatArray:
        """(3, 3) float: the axes of a part that has an area, in the order of the scales."""
        if part not in self._axes:
            axes = self._covariance(part)[1].T[::-1]
            largest = np.abs(axes).argmax(axis=1)[:, None]
            signs = np.sign(np.take_along_axis(axes, largest, axis=1))
            self._axes[part] = frozen(axes * signs)
        return self._axes[part]

    def mean_of_all(self, name: str, parameters: dict[str, Any]) -> float:
        """A field's mean over the whole shape."""
        return field_sums(self._level, self._lookup.field(name), parameters).middle

    def boundary(self, part: int) -> Boundary:
        """The boundary of a part with all others."""
        return Boundary(
            length=self._lengths[0][part],
            _along=lambda name, **parameters: self._integrals(name, parameters)[0][part],
        )

    def between(self, first: int, second: int) -> Boundary:
        """The boundary between two parts."""
        return Boundary(
            length=float(self._lengths[1][first, second]),
            _along=lambda name, **parameters: float(
                self._integrals(name, parameters)[1][first, second]
            ),
        )

    def lengths_between(self, part: int, others: list[int]) -> FloatArray:
        """(n,) float: the lengths of the boundaries of a part with several others."""
        return self._lengths[1][part, others]

    @cached_property
    def boundaries(self) -> Boundaries:
        """The boundaries between all parts."""
        return Boundaries(
            lengths=self._lengths[1],
            around=np.array(self._lengths[0]),
            _along=lambda name, **parameters: self._integrals(name, parameters)[1],
            _around=lambda name, **parameters: np.array(self._integrals(name, parameters)[0]),
        )

    @cached_property
    def _lengths(self) -> tuple[list[float], FloatArray]:
        return self._summed(self._level.links.lengths)

    def _integrals(self, name: str, parameters: dict[str, Any]) -> tuple[list[float], FloatArray]:
        """Of a field along boundaries: n of each part, (n, n) of each two."""
        asked = (name, *parameters.items())
        if asked not in self._along:
            found = self._lookup.field(name)
            self._along[asked] = self._summed(link_values(self._level, found, parameters))
        return self._along[asked]

    @cached_property
    def _crossings(self) -> tuple[int, Int32Array, Int32Array]:
        """How many links cross from part to part, their numbers, and the two parts of each."""
        from moseg_core.shape.boundary_sums import find_crossings

        links = self._level.links
        size = len(links.first)
        crossings, sides = np.empty(size, np.int32), np.empty((size, 2), np.int32)
        count = find_crossings(self._labels, links.first, links.second, crossings, sides)
        return count, crossings, sides

    def _summed(self, values: FloatArray) -> tuple[list[float], FloatArray]:
        from moseg_core.shape.boundary_sums import sum_boundaries

        n = len(self._areas)
        whole, between = np.empty(n), np.empty((n, n))
        sum_boundaries(*self._crossings, values, whole, between)
        return whole.tolist(), frozen(between)


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
