"""Arrays of parts: what an objective's vectorised form receives.

A search evaluates hundreds of parts in a batch, and most measures are a few numbers from sums that
one pass over the elements gives for all of them (:mod:`moseg_core.components.labellings`). An
objective that is a formula of such numbers may have a second, vectorised form, a function of an
array of parts that returns a value for each call::

    def roundness_of(parts: PartArray) -> FloatArray:
        return parts.scales[:, 2] / parts.scales[:, 0]

    @objective(range=(0, 1), vectorized=roundness_of)
    def roundness(part: Part) -> float: ...

The first axis of an array counts calls. For an objective of several parts there is a second axis,
in the order of the labels, and for one of the whole segmentation it counts all parts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from moseg_core.components.field import FieldSummary, field_sums
from moseg_core.components.labellings import Labellings, signed
from moseg_core.components.memo import Memo
from moseg_core.components.part import measure_key
from moseg_core.shape.shape import Shape
from moseg_core.types import BoolArray, FloatArray, IntArray, frozen


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class PartArray:
    """Parts of one or several labellings, for k calls of an objective.

    Shapes of arrays are given for an objective of single parts. For one of m parts, or of a
    segmentation with m, all have a second axis: ``(k, m)`` for ``(k,)``.

    Parameters
    ----------
    _labellings : Labellings
    _rows : (k,) int
        The labelling that each call is about. Private to the core, as for :class:`Part`: a value
        is that of the elements, whatever labels they bear.
    _parts : (k,) or (k, m) int
        Which of its parts.
    _memo : Memo, optional
        Where measures are remembered.

    Examples
    --------
    >>> import numpy as np
    >>> from moseg_core import Part, PartArray, Problem, Shape, objective
    >>> def thinness_of(parts: PartArray) -> np.ndarray:
    ...     return parts.scales[:, 1] / parts.scales[:, 0]
    >>> @objective(range=(0, 1), vectorized=thinness_of)
    ... def thinness(part: Part) -> float:
    ...     return part.scales[1] / part.scales[0]
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> problem = Problem(["a", "b"], "thinness(*)", objectives={"thinness": thinness})
    >>> round(problem.evaluate(strip, [0, 1]).cost.value, 9)
    1.25
    """

    _labellings: Labellings
    _rows: IntArray
    _parts: IntArray
    _memo: Memo | None = None

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        size = " x ".join(map(str, self._parts.shape))
        return f"PartArray({size} parts of {self.shape.name})"

    @property
    def level(self) -> Shape:
        """The shape whose elements were labelled: the user's own, or a coarse one made from it."""
        return self._labellings.level

    @property
    def shape(self) -> Shape:
        """The whole that these are parts of, the user's shape."""
        return self.level.input

    @cached_property
    def _at(self) -> tuple[IntArray, IntArray]:
        """Where the parts, or others with the same members, are in the tables."""
        rows = self._rows if self._parts.ndim == 1 else self._rows[:, None]
        return self._labellings.first(rows, self._parts)

    @cached_property
    def _wanted(self) -> BoolArray:
        wanted = np.zeros(self._labellings.areas.shape, np.bool_)
        wanted[self._at] = True
        return wanted

    @cached_property
    def areas(self) -> FloatArray:
        """(k,) float, model units squared; of solids' parts their volume."""
        return frozen(self._labellings.areas[self._at])

    @cached_property
    def centroids(self) -> FloatArray:
        """(k, 3) float, model units: area-weighted means of the surface."""
        first = self._labellings.summary.moments[..., 1:4][self._at]
        return frozen(first / self.areas[..., None] + self.shape.frame.center)

    @cached_property
    def scales(self) -> FloatArray:
        """(k, 3) float, descending, model units: see :attr:`Part.scales`."""
        return frozen(self._labellings.axes(self._wanted)[0][self._at])

    @cached_property
    def axes(self) -> FloatArray:
        """(k, 3, 3) float: unit vectors as rows, see :attr:`Part.axes`."""
        return frozen(signed(self._labellings.axes(self._wanted)[1][self._at]))

    def least_hull_volumes(self, wanted: BoolArray) -> FloatArray:
        """(k,) float, model units cubed: less than the volumes of some parts' convex hulls.

        One or two percent less, as a rule, and 0 where nothing is known, as of all parts of large
        meshes: for lower bounds (:func:`moseg_core.objective`), in a fifth of the time of a hull.

        Parameters
        ----------
        wanted : (k,) bool
            Of which parts; what is returned of others does not matter.
        """
        rows, parts = np.broadcast_arrays(*self._at)
        asked = np.zeros(self._labellings.areas.shape, np.bool_)
        asked[rows[wanted], parts[wanted]] = True
        volumes: FloatArray = self._labellings.least_hull_volumes(asked)[rows, parts]
        return volumes

    def remembered(self, measure: str) -> FloatArray:
        """(k,) float: a measure of each part of which the search remembers it, NaN elsewhere.

        For lower bounds alone: what is remembered differs from run to run, and no value may.

        Parameters
        ----------
        measure : str
            ``bundle:name`` of one whose values are numbers, without parameters.
        """
        values = np.full(self._labellings.areas.shape, np.nan)
        if self._memo is not None:
            hashes = self._labellings.summary.hashes
            for row, part in zip(*np.nonzero(self._wanted), strict=True):
                first, second = hashes[row, part].tolist()
                known = self._memo.known(measure_key((first, second), self.level, measure))
                if known is not None:
                    values[row, part] = known
        found: FloatArray = values[self._at]
        return found

    def field(self, name: str, **parameters: Any) -> FieldSummary[FloatArray]:
        """A field over each part: mean, spread, least and greatest value, (k,) float each.

        Parameters
        ----------
        name : str
            ``bundle:name`` of the field, or the name alone where it is unique.
        **parameters
            The field's own parameters.

        Raises
        ------
        ShapeError, UsageError, PluginError
            As for :func:`moseg_core.field_values`.
        """
        rows = self._labellings.field(name, parameters, self._wanted)[self._at]
        # Contiguous: numpy may round differently along what is not.
        return FieldSummary(*(np.ascontiguousarray(rows[..., j]) for j in range(4)))

    def field_of_shape(self, name: str, **parameters: Any) -> float:
        """A field's mean over the whole shape by area, with which those of parts compare.

        Raises
        ------
        ShapeError, UsageError, PluginError
            As for :func:`moseg_core.field_values`.
        """
        found = self._labellings.lookup.field(name)
        return field_sums(self.level, found, parameters).middle

    @cached_property
    def boundary_lengths(self) -> FloatArray:
        """(k,) float, model units: of the boundary of each part with all others.

        Raises
        ------
        ShapeError
            It is not known which elements touch.
        """
        return frozen(self._labellings.lengths()[0][self._at])

    def boundary_means(self, name: str, **parameters: Any) -> FloatArray:
        """(k,) float: the mean of a field along each of these; NaN where there is no boundary.

        Raises
        ------
        ShapeError, UsageError, PluginError
            As for :func:`moseg_core.field_values`.
        """
        whole = self._labellings.integrals(name, parameters)[0][self._at]
        with np.errstate(invalid="ignore"):
            means: FloatArray = whole / self.boundary_lengths
        return means

    @cached_property
    def lengths_between(self) -> FloatArray:
        """(k, m, m) float, model units: the length of the boundary of each two parts of a call.

        Symmetric; 0 on the diagonal and where two do not touch. Of parts along a second axis.

        Raises
        ------
        ShapeError
            It is not known which elements touch.
        """
        rows, parts = self._rows[:, None, None], self._parts
        between = self._labellings.lengths()[1]
        return frozen(between[rows, parts[:, :, None], parts[:, None, :]])

    def distance(self, call: int, first: int, second: int) -> float:
        """The least distance between two parts of a call: see :meth:`Part.distance_to`.

        Parameters
        ----------
        call : int
            Along the first axis.
        first, second : int
            Along the second.
        """
        parts = self._parts[call]
        return self._labellings.gap(int(self._rows[call]), int(parts[first]), int(parts[second]))


Vectorized = Callable[..., FloatArray]
"""Called with a :class:`PartArray` and parameters, it returns the (k,) values of as many calls."""
