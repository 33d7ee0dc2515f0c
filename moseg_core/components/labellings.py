"""Several labellings of one shape, and what is measured of all their parts in one pass.

A search looks at partitions by the batch, and to ask for a sum over elements costs as much as to
compute it for a hundred of them. So the tables here have a row for each part of each labelling:
sums, fields and boundaries by kernels over elements and links (:mod:`moseg_core.shape.part_sums`,
:mod:`moseg_core.shape.boundary_sums`), principal axes by one call of LAPACK. A row does not depend
on which others are computed with it.

The parts of a single labelling (:mod:`moseg_core.components.part_tables`) and arrays of parts
(:mod:`moseg_core.components.part_array`) read from here.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import field_sums, link_values
from moseg_core.shape.row_threads import over_rows
from moseg_core.shape.shape import Shape
from moseg_core.types import BoolArray, FloatArray, Int32Array, IntArray, frozen

#: About how long it takes to add an element, or a link, to a sum.
_SECONDS = 3e-9
#: About how long it takes to bound the volume of a hull.
_SECONDS_OF_HULL = 2e-5


@dataclass(frozen=True, eq=False, kw_only=True)
class Summary:
    """Sums over the elements of every part: of one labelling, or of B.

    Parameters
    ----------
    counts : (n,) or (B, n) int
        Number of input elements.
    hashes : (n, 2) or (B, n, 2) uint64
        Which elements.
    moments : (n, 10) or (B, n, 10) float
        Area, first and second moments about the shape's centre, model units.
    """

    counts: IntArray
    hashes: npt.NDArray[np.uint64]
    moments: FloatArray

    @classmethod
    def of(cls, shape: Shape, labels: Int32Array, n_parts: int) -> Summary:
        """Sum over the elements of every part.

        Parameters
        ----------
        shape : Shape
        labels : (F,) or (B, F) int32
        n_parts : int
        """
        from moseg_core.shape.part_sums import summarize_parts

        rows = np.atleast_2d(labels)
        counts = np.empty((len(rows), n_parts), np.int64)
        hashes = np.empty((len(rows), n_parts, 2), np.uint64)
        moments = np.empty((len(rows), n_parts, 10))
        known = shape.areas, shape.first_moments, shape.second_moments, shape.element_hashes
        over_rows(
            lambda a, b: summarize_parts(rows[a:b], *known, counts[a:b], hashes[a:b], moments[a:b]),
            len(rows),
            seconds=_SECONDS * rows.size,
        )
        if shape.fine is not None:
            for b, row in enumerate(rows):
                counts[b] = np.bincount(row, shape.sizes, n_parts)
        whole = cls(counts=counts, hashes=hashes, moments=moments)
        return whole if labels.ndim == 2 else whole.row(0)

    def row(self, b: int) -> Summary:
        """The sums of one labelling of several."""
        return Summary(counts=self.counts[b], hashes=self.hashes[b], moments=self.moments[b])

    def empty(self, shape: Shape) -> BoolArray:
        """(n,) or (B, n) bool: parts without elements, without area, or without extent.

        Such parts are ranked by the core and never reach an objective.
        """
        from moseg_core.shape.part_sums import find_empty

        scale = shape.frame.scale
        empty = np.empty(self.moments.shape[:-1], np.bool_)
        find_empty(
            self.moments.reshape(-1, 10),
            1e-14 * scale ** (3 if shape.solid else 2),
            1e-14 * scale**2,
            empty.reshape(-1),
        )
        return empty


@dataclass(frozen=True, eq=False, kw_only=True)
class Labellings:
    """B labellings of a level, with a table row for each of their parts.

    Parameters
    ----------
    level : Shape
    labels : (B, F of `level`) int32
        Part of each element, 0 to ``n_parts - 1``; nobody writes to it any more.
    n_parts : int
    summary : Summary
        Of B labellings.
    lookup : Lookup
        Where fields are found.
    """

    level: Shape
    labels: Int32Array
    n_parts: int
    summary: Summary
    lookup: Lookup

    @classmethod
    def of(cls, level: Shape, labels: Int32Array, n_parts: int, lookup: Lookup) -> Labellings:
        """The labellings, their parts summed up."""
        summary = Summary.of(level, labels, n_parts)
        return cls(level=level, labels=labels, n_parts=n_parts, summary=summary, lookup=lookup)

    def __len__(self) -> int:
        return len(self.labels)

    @cached_property
    def _views(self) -> dict[str, Labellings]:
        return {}

    def view(self, space: str) -> Labellings:
        """The same labels on another version of the shape, such as "original" (Sec. 9).

        Raises
        ------
        ShapeError
            The shape is not known in that space.
        """
        if space == self.level.space:
            return self
        if space not in self._views:
            level = self.level.in_space(space)
            summary = Summary.of(level, self.labels, self.n_parts)
            self._views[space] = replace(self, level=level, summary=summary)
        return self._views[space]

    def first(self, rows: IntArray, parts: IntArray) -> tuple[IntArray, IntArray]:
        """Of parts that occur several times the first: its row and number.

        Most parts of a candidate occur in others of a batch too, and all that is measured of a
        part depends on its members alone, to the last bit.

        Parameters
        ----------
        rows, parts : (...) int
            The labelling, and which of its parts.

        Returns
        -------
        rows, parts : (...) int
            Those of a part with the same members.
        """
        if len(self) == 1:  # parts of one labelling have no members in common
            return rows, parts
        flat = self._first[rows * self.n_parts + parts]
        return flat // self.n_parts, flat % self.n_parts

    @cached_property
    def _first(self) -> IntArray:
        """(Bn,) int: the first part, counted through all rows, with the same members."""
        hashes = self.summary.hashes.reshape(-1, 2)
        _, first, which = np.unique(hashes[:, 0], return_index=True, return_inverse=True)
        found: IntArray = first[which]
        if (hashes[found, 1] != hashes[:, 1]).any():  # half a hash in common
            return np.arange(len(hashes))
        return found

    @cached_property
    def _distinct(self) -> BoolArray:
        """(B, n) bool: the parts that are not empty, of those with the same members the first."""
        distinct = np.ones(self.areas.shape, np.bool_)
        if len(self) > 1:
            distinct[:] = False
            distinct.reshape(-1)[self._first] = True
        distinct &= ~self.summary.empty(self.level.input)
        return distinct

    def _missing(self, wanted: BoolArray, known: BoolArray) -> BoolArray | None:
        """(B, n) bool: the parts whose rows of a table are to be computed; None where none is.

        Where rows are wanted for the second time, by another term, all others will be too as a
        rule, and one pass over the elements is made for all of them.
        """
        missing = wanted & ~known
        if not missing.any():
            return None
        return self._distinct & ~known | missing if known.any() else missing

    @property
    def areas(self) -> FloatArray:
        """(B, n) float: area of each part."""
        areas: FloatArray = self.summary.moments[..., 0]
        return areas

    @cached_property
    def _fields(self) -> dict[Hashable, tuple[BoolArray, FloatArray]]:
        return {}

    def field(self, name: str, parameters: Mapping[str, Any], wanted: BoolArray) -> FloatArray:
        """(B, n, 4) float: mean, spread, least and greatest value of a field.

        Parameters
        ----------
        name : str
        parameters : mapping
        wanted : (B, n) bool
            The parts whose rows are needed; what others hold does not matter.
        """
        from moseg_core.shape.part_sums import summarize_field

        asked = (name, *parameters.items()) if parameters else name
        if asked not in self._fields:
            self._fields[asked] = np.zeros(wanted.shape, np.bool_), np.empty((*wanted.shape, 4))
        known, rows = self._fields[asked]
        missing = self._missing(wanted, known)
        if missing is not None:
            sums = field_sums(self.level, self.lookup.field(name), parameters)
            columns = sums.weighted, sums.squared, sums.least, sums.greatest
            areas = self.areas
            over_rows(
                lambda a, b: summarize_field(
                    self.labels[a:b], missing[a:b], *columns, areas[a:b], sums.middle, rows[a:b]
                ),
                len(self),
                seconds=_SECONDS * self.labels.size,
            )
            known |= missing
        return rows

    @cached_property
    def _axes(self) -> tuple[BoolArray, FloatArray, FloatArray]:
        shape = self.areas.shape
        return np.zeros(shape, np.bool_), np.empty((*shape, 3)), np.empty((*shape, 3, 3))

    def axes(self, wanted: BoolArray) -> tuple[FloatArray, FloatArray]:
        """(B, n, 3) scales, descending, and (B, n, 3, 3) axes as rows in their order, not signed.

        Parameters
        ----------
        wanted : (B, n) bool
            The parts, all with an area, whose rows are needed.
        """
        known, scales, axes = self._axes
        missing = self._missing(wanted, known)
        if missing is not None:
            scales[missing], axes[missing] = _principal_axes(self.summary.moments[missing])
            np.logical_or(known, missing, out=known)
        return scales, axes

    @cached_property
    def _least_hulls(self) -> tuple[BoolArray, FloatArray]:
        shape = self.areas.shape
        return np.zeros(shape, np.bool_), np.zeros(shape)

    def least_hull_volumes(self, wanted: BoolArray) -> FloatArray:
        """(B, n) float: lower bounds of the volumes of parts' convex hulls, model units cubed.

        Parameters
        ----------
        wanted : (B, n) bool
            The parts whose bounds are needed.
        """
        known, volumes = self._least_hulls
        missing, farthest = wanted & ~known, self.level.farthest_vertices
        if farthest is not None and missing.any():
            over_rows(
                lambda a, b: farthest.least_volumes(self.labels[a:b], missing[a:b], volumes[a:b]),
                len(self),
                seconds=_SECONDS_OF_HULL * np.count_nonzero(missing),
            )
            np.logical_or(known, missing, out=known)
        return volumes

    @cached_property
    def _along(self) -> dict[Hashable, tuple[FloatArray, FloatArray]]:
        return {}

    def lengths(self) -> tuple[FloatArray, FloatArray]:
        """(B, n) and (B, n, n) float: length of each part's boundary, and of that of each two."""
        return self._summed("length", lambda: self.level.links.lengths)

    def integrals(self, name: str, parameters: Mapping[str, Any]) -> tuple[FloatArray, FloatArray]:
        """(B, n) and (B, n, n) float: integrals of a field along the same boundaries."""
        return self._summed(
            ("field", name, *parameters.items()),
            lambda: link_values(self.level, self.lookup.field(name), parameters),
        )

    @cached_property
    def _gaps(self) -> dict[tuple[int, int], float]:
        return {}

    def gap(self, row: int, one: int, other: int) -> float:
        """The least distance between the elements of two parts of a labelling, model units.

        Two parts that occur in several labellings are compared once.
        """
        from moseg_core.shape.gaps import least_distance

        first, second = row * self.n_parts + one, row * self.n_parts + other
        if len(self) > 1:
            first, second = int(self._first[first]), int(self._first[second])
        pair = min(first, second), max(first, second)
        if pair not in self._gaps:
            gap = least_distance(self.level.points, self.labels[row], one, other)
            self._gaps[pair] = float(gap)
        return self._gaps[pair]

    def _summed(
        self, asked: Hashable, values: Callable[[], FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        from moseg_core.shape.boundary_sums import sum_boundaries

        if asked not in self._along:
            links, (count, n) = self.level.links, self.areas.shape
            along, ends = values(), (links.first, links.second)
            whole, between = np.empty((count, n)), np.empty((count, n, n))
            over_rows(
                lambda a, b: sum_boundaries(
                    self.labels[a:b], *ends, along, whole[a:b], between[a:b]
                ),
                count,
                seconds=_SECONDS * count * len(links.first),
            )
            self._along[asked] = frozen(whole), frozen(between)
        return self._along[asked]


def _principal_axes(moments: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(k, 3) scales, descending, and (k, 3, 3) axes as rows, from (k, 10) moments.

    Scales are square roots of the eigenvalues of the covariance.
    """
    mean = moments[:, 1:4] / moments[:, :1]
    second = moments[:, 4:10] / moments[:, :1]
    square = second[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
    values, vectors = np.linalg.eigh(square - mean[:, :, None] * mean[:, None, :])
    # What the subtraction leaves of a flat part's thickness is rounding, not thickness.
    values[values < 1e-14 * (second[:, 0] + second[:, 3] + second[:, 5])[:, None]] = 0.0
    return np.sqrt(values[:, ::-1]), vectors.transpose(0, 2, 1)[:, ::-1]


def signed(axes: FloatArray) -> FloatArray:
    """(..., 3, 3) float: axes as rows, turned so that the largest component of each is positive."""
    largest = np.abs(axes).argmax(axis=-1)[..., None]
    turned: FloatArray = axes * np.sign(np.take_along_axis(axes, largest, axis=-1))
    return turned
