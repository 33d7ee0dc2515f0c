"""What the parts of one labelling share: fields and boundaries, a table each, made when asked for.

Of a field or a boundary one pass over the elements or links says what there is to say of all
parts, for little more than it costs to say it of one. The first part that is asked makes the
table, the others read their row.
"""

from __future__ import annotations

from collections.abc import Hashable
from functools import cached_property
from typing import Any

import numpy as np

from moseg_core.components.boundary import Boundaries, Boundary
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import FieldSummary, field_sums, link_values
from moseg_core.errors import MosegError
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, IntArray, frozen


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
    """

    def __init__(
        self, level: Shape, labels: Int32Array, moments: FloatArray, lookup: Lookup
    ) -> None:
        self._level = level
        self._labels = labels
        self._moments = moments
        self._areas = moments[:, 0]
        self._lookup = lookup
        self._fields: dict[Hashable, list[FieldSummary]] = {}
        self._along: dict[Hashable, tuple[list[float], FloatArray]] = {}

    def field(self, name: str, parameters: dict[str, Any]) -> list[FieldSummary]:
        """A field's summary over every part."""
        asked = (name, *parameters.items())
        if asked not in self._fields:
            from moseg_core.shape.part_sums import summarize_field

            sums = field_sums(self._level, self._lookup.field(name), parameters)
            rows = np.empty((len(self._areas), 4))
            summarize_field(
                self._labels, sums.weighted, sums.squared, sums.least, sums.greatest, rows
            )
            found = sums.summarize(self._areas, rows)
            self._fields[asked] = [FieldSummary._make(row) for row in found.tolist()]
        return self._fields[asked]

    @cached_property
    def _eigen(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """Numbers of the parts that have an area, and of their covariances (k, 3) and (k, 3, 3)."""
        some = np.flatnonzero(self._areas > 0)
        mean = self._moments[some, 1:4] / self._areas[some, None]
        second = self._moments[some, 4:10] / self._areas[some, None]
        square = second[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
        values, vectors = np.linalg.eigh(square - mean[:, :, None] * mean[:, None, :])
        # What the subtraction leaves of a flat part's thickness is rounding, not thickness.
        values[values < 1e-14 * (second[:, 0] + second[:, 3] + second[:, 5])[:, None]] = 0.0
        return some, values, vectors

    @cached_property
    def centroids(self) -> list[FloatArray | None]:
        """Of every part the centroid, (3,) in model units; None of one without area."""
        some = np.flatnonzero(self._areas > 0)
        means = self._moments[some, 1:4] / self._areas[some, None]
        return self._by_part(some, means + self._level.input.frame.center)

    @cached_property
    def scales(self) -> list[FloatArray | None]:
        """Of every part the scales, (3,) descending; None of one without area."""
        some, values, _ = self._eigen
        return self._by_part(some, np.sqrt(values[:, ::-1]))

    @cached_property
    def axes(self) -> list[FloatArray | None]:
        """Of every part the axes, (3, 3), in the order of the scales; None of one without area."""
        some, _, vectors = self._eigen
        axes = vectors.transpose(0, 2, 1)[:, ::-1]
        largest = np.abs(axes).argmax(axis=2)[:, :, None]
        return self._by_part(some, axes * np.sign(np.take_along_axis(axes, largest, axis=2)))

    def _by_part(self, some: IntArray, rows: FloatArray) -> list[FloatArray | None]:
        """Rows of some parts, None for the others."""
        found: list[FloatArray | None] = [None] * len(self._areas)
        frozen(rows)
        for row, part in enumerate(some.tolist()):
            found[part] = rows[row]
        return found

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

    @cached_property
    def boundaries(self) -> Boundaries:
        """The boundaries between all parts."""
        return Boundaries(
            lengths=self._lengths[1],
            _along=lambda name, **parameters: self._integrals(name, parameters)[1],
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

    def _summed(self, values: FloatArray) -> tuple[list[float], FloatArray]:
        from moseg_core.shape.boundary_sums import sum_boundaries

        n, links = len(self._areas), self._level.links
        whole, between = np.empty(n), np.empty((n, n))
        sum_boundaries(self._labels, links.first, links.second, values, whole, between)
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
