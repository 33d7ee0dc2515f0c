"""Boundaries: where parts meet, how long that is, and what it is like along there.

The boundary of a part are the links that leave it (:mod:`moseg_core.shape.links`). Of one part it
does not depend on how the rest is divided; of two it depends on these two alone. A field
(:mod:`moseg_core.components.field`) has a mean along it: where the surface is concave, for
instance, people see the end of a part (Hoffman and Richards 1984,
doi:10.1016/0010-0277(84)90022-2).

``part.boundary``, ``first.boundary_with(second)`` and ``segmentation.boundaries`` all come from
one pass over the links of the level for each quantity that is asked for
(:mod:`moseg_core.components.part_tables`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from moseg_core.errors import MosegError
from moseg_core.types import BoolArray, FloatArray


@dataclass(frozen=True, kw_only=True, repr=False)
class Boundary:
    """The boundary of a part with all others, or with one of them.

    Parameters
    ----------
    length : float, model units
        Of a part of a solid the area of the cut; 0 where nothing touches.
    _along : callable
        From a field's name and parameters to its integral along the boundary.
    """

    length: float
    _along: Callable[..., float] = field(compare=False)

    def mean(self, name: str, **parameters: Any) -> float:
        """The mean of a field along the boundary, in the field's units.

        Parameters
        ----------
        name : str
            ``bundle:name`` of the field, or the name alone where it is unique.
        **parameters
            The field's own parameters.

        Raises
        ------
        MosegError
            The boundary has no length.
        ShapeError, UsageError, PluginError
            As for :func:`moseg_core.field_values`.
        """
        if not self.length > 0:
            raise MosegError("a boundary of no length has no mean; look at its length first")
        return self._along(name, **parameters) / self.length

    def __repr__(self) -> str:
        return f"Boundary(length {self.length:.6g})"


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Boundaries:
    """The boundaries between all parts of a segmentation.

    Parameters
    ----------
    lengths : (n, n) float, model units
        Between each two parts; symmetric, 0 on the diagonal.
    around : (n,) float, model units
        Of each part's whole boundary, as ``part.boundary.length``.
    _along : callable
        From a field's name and parameters to its (n, n) integrals along the boundaries.
    _around : callable
        The same, to the (n,) integrals along each part's whole boundary.
    """

    lengths: FloatArray
    around: FloatArray
    _along: Callable[..., FloatArray]
    _around: Callable[..., FloatArray]

    @property
    def length(self) -> float:
        """Length of all boundaries together, model units."""
        return float(np.triu(self.lengths).sum())

    @property
    def touching(self) -> BoolArray:
        """(n, n) bool: which parts touch."""
        touching: BoolArray = self.lengths > 0
        return touching

    def means(self, name: str, **parameters: Any) -> FloatArray:
        """(n, n) float: the mean of a field along each boundary; NaN where parts do not touch.

        Raises
        ------
        ShapeError, UsageError, PluginError
            As for :func:`moseg_core.field_values`.
        """
        with np.errstate(invalid="ignore"):
            found: FloatArray = self._along(name, **parameters) / self.lengths
        return found

    def means_around(self, name: str, **parameters: Any) -> FloatArray:
        """(n,) float: the mean of a field along each part's whole boundary; NaN without one.

        Raises
        ------
        ShapeError, UsageError, PluginError
            As for :func:`moseg_core.field_values`.
        """
        with np.errstate(invalid="ignore"):
            found: FloatArray = self._around(name, **parameters) / self.around
        return found

    def mean(self, name: str, **parameters: Any) -> float:
        """The mean of a field along all boundaries together.

        Raises
        ------
        MosegError
            There are no boundaries.
        ShapeError, UsageError, PluginError
            As for :func:`moseg_core.field_values`.
        """
        length = self.length
        if not length > 0:
            raise MosegError("boundaries of no length have no mean; look at the length first")
        return float(np.triu(self._along(name, **parameters)).sum()) / length

    def __repr__(self) -> str:
        return f"Boundaries({len(self.lengths)} parts, length {self.length:.6g})"
