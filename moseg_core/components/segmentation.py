"""A segmentation: a shape, a label for every element, and the parts that result.

The bridge between labellings and objectives. One pass of
:func:`moseg_core.shape.part_sums.summarize_parts` over the elements gives every part its size,
membership hash and moments; a part then measures the rest of itself on demand.

The labels may be those of a coarse shape (:mod:`moseg_core.shape.coarse`). What an objective sees
is the same: the user's shape, a label for each of its elements, parts made of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.components.boundary import Boundaries
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import FieldSummary, field_values
from moseg_core.components.labellings import Labellings, Summary
from moseg_core.components.memo import Memo
from moseg_core.components.part import Part
from moseg_core.components.part_tables import PartTables
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, IntArray, frozen


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Segmentation:
    """A labelled shape; what a global objective receives.

    Parameters
    ----------
    level : Shape
        The shape whose elements were labelled: the user's own, or a coarse one made from it.
    level_labels : (F of `level`,) int32
        Part of each element, 0 to ``n_parts - 1``.
    n_parts : int
    summary : Summary
    memo : Memo
    lookup : Lookup
        Where measures and fields are found.
    """

    level: Shape
    level_labels: Int32Array
    n_parts: int
    summary: Summary
    memo: Memo
    lookup: Lookup

    @property
    def shape(self) -> Shape:
        """The user's shape."""
        return self.level.input

    @cached_property
    def labels(self) -> Int32Array:
        """(F,) int32: part of each element of :attr:`shape`."""
        if self.level.members is None:
            return self.level_labels
        return self.level_labels[self.level.members]

    def __repr__(self) -> str:
        return f"Segmentation({self.shape.name}: {self.n_parts} parts)"

    @cached_property
    def _views(self) -> dict[str, Segmentation]:
        return {}

    def view(self, space: str) -> Segmentation:
        """The same labels on another version of the shape, such as "original" (Sec. 9).

        Raises
        ------
        ShapeError
            The shape is not known in that space.
        """
        if space == self.level.space:
            return self
        if space not in self._views:
            view = self.labelling.view(space)
            self._views[space] = replace(self, level=view.level, summary=view.summary.row(0))
        return self._views[space]

    @classmethod
    def from_labels(
        cls,
        shape: Shape,
        labels: npt.ArrayLike,
        n_parts: int,
        *,
        memo: Memo | None = None,
        lookup: Lookup | None = None,
    ) -> Segmentation:
        """From a label per element.

        Raises
        ------
        ShapeError
            Not one integer label per element, or a label outside ``0 .. n_parts - 1``.

        Examples
        --------
        >>> shape = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> [part.n_elements for part in Segmentation.from_labels(shape, [1], 2).parts]
        [0, 1]
        """
        checked = checked_labels(shape, labels, n_parts)
        return cls.from_checked(
            shape,
            frozen(np.array(checked, dtype=np.int32, order="C")),
            n_parts,
            memo=Memo() if memo is None else memo,
            lookup=Lookup() if lookup is None else lookup,
        )

    @classmethod
    def from_checked(
        cls, shape: Shape, labels: Int32Array, n_parts: int, *, memo: Memo, lookup: Lookup
    ) -> Segmentation:
        """From labels that are known to be right, and that nobody writes to any more."""
        return cls(
            level=shape,
            level_labels=labels,
            n_parts=n_parts,
            summary=Summary.of(shape, labels, n_parts),
            memo=memo,
            lookup=lookup,
        )

    def permuted(self, order: IntArray) -> Segmentation:
        """The same parts under other labels: part ``j`` is part ``order[j]`` of this one."""
        rank = np.empty(self.n_parts, np.int32)
        rank[order] = np.arange(self.n_parts, dtype=np.int32)
        return Segmentation(
            level=self.level,
            level_labels=rank[self.level_labels],
            n_parts=self.n_parts,
            summary=Summary(
                counts=self.summary.counts[order],
                hashes=self.summary.hashes[order],
                moments=self.summary.moments[order],
            ),
            memo=self.memo,
            lookup=self.lookup,
        )

    @cached_property
    def labelling(self) -> Labellings:
        """The same, as one of several that could be."""
        summary = self.summary
        return Labellings(
            level=self.level,
            labels=self.level_labels[None],
            n_parts=self.n_parts,
            summary=Summary(
                counts=summary.counts[None],
                hashes=summary.hashes[None],
                moments=summary.moments[None],
            ),
            lookup=self.lookup,
        )

    @cached_property
    def _tables(self) -> PartTables:
        return PartTables(self.labelling, self._made)

    def fields(self, name: str, **parameters: Any) -> tuple[FieldSummary[float], ...]:
        """A field over every part, in label order; NaN for the mean of a part without area.

        See :meth:`moseg_core.Part.field`.
        """
        made = len(self.parts)  # all of them, so that one pass is enough
        return tuple(self._tables.field(name, parameters, label) for label in range(made))

    def field_values(self, name: str, **parameters: Any) -> FloatArray:
        """(F of `level`,) float: a field on the labelled shape; see :func:`field_values`."""
        return field_values(self.level, name, lookup=self.lookup, **parameters)

    @property
    def boundaries(self) -> Boundaries:
        """Where parts meet: lengths, who touches whom, means of fields.

        Raises
        ------
        ShapeError
            It is not known which elements touch.
        """
        return self._tables.boundaries

    @property
    def areas(self) -> FloatArray:
        """(n,) float, model units squared: area of each part; of a solid's parts their volume."""
        return frozen(self.summary.moments[:, 0].copy())

    @cached_property
    def memberships(self) -> tuple[tuple[int, int], ...]:
        """Of each part the 128-bit hash of its elements' numbers, in label order."""
        return tuple([(first, second) for first, second in self.summary.hashes.tolist()])

    @cached_property
    def _made(self) -> dict[int, Part]:
        return {}

    def part(self, label: int) -> Part:
        """The part of one label, made when it is first asked for."""
        if label not in self._made:
            self._made[label] = Part(
                level=self.level,
                _level_labels=self.level_labels,
                _index=label,
                n_elements=int(self.summary.counts[label]),
                membership=self.memberships[label],
                moments=self.summary.moments[label],
                memo=self.memo,
                lookup=self.lookup,
                _tables=self._tables,
            )
        return self._made[label]

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """One part per label, in label order; parts without elements included."""
        return tuple(self.part(label) for label in range(self.n_parts))
