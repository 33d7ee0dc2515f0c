"""A constraint from a user's function of the free parameters (Sec. 8).

"The user need only provide a constraint function which takes in the non-redundant parameters and
produces the others from known symmetry": :func:`constraint` makes one of it that the core can
also read backwards, by least squares, so that a search may begin at centres that were found
without it. :mod:`moseg_core.problem.constraint_calls` finds constraints by name, and
:mod:`moseg_core.problem.constraints` puts several together.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from moseg_core.components.parameters import Parameter
from moseg_core.components.protocols import Constraint
from moseg_core.errors import UsageError
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray


class FunctionConstraint:
    """A constraint made from a function by :func:`constraint`.

    Parameters
    ----------
    function : callable
        (k,) float to (L, 4) float, a row for each label that it is given.
    start : (k,) float
        Free numbers from which :meth:`Constraint.reduce` seeks those nearest to given centres.
    """

    def __init__(self, function: Callable[[FloatArray], Any], start: FloatArray) -> None:
        self.function, self.start = function, start
        self.__name__ = getattr(function, "__name__", "constraint")
        self.__qualname__ = getattr(function, "__qualname__", self.__name__)
        self.__module__ = function.__module__
        self.__doc__ = function.__doc__
        self.parameters: tuple[Parameter, ...] = ()

    def __reduce__(self) -> str:
        # The decorated name in its module is this object, so it pickles by reference.
        return self.__qualname__

    def __call__(self, shape: Shape, labels: Sequence[int]) -> Constraint:
        """The constraint on certain labels; the same for every shape."""
        return _Follows(self, tuple(labels))


def constraint(*, start: Sequence[float]) -> Callable[[Callable[..., Any]], FunctionConstraint]:
    """Turn a function of the free parameters into a constraint (Sec. 8).

    Parameters
    ----------
    start : sequence of float
        One number for each free parameter: where to begin when the parameters nearest to given
        centres are sought, by least squares. Somewhere in the middle of what is sensible.

    Returns
    -------
    callable
        A decorator for a function that takes the (k,) free parameters and returns a row ``x, y,
        z, w`` for every label: position in unit coordinates, in which the centre of the bounding
        box is the origin and its diagonal is 1, and weight.

    Raises
    ------
    ValueError
        No free parameters, or ones that are not finite.

    Examples
    --------
    Two centres at equal distances from the middle:

    >>> @constraint(start=[0.3, 1.0])
    ... def opposite(free):
    ...     x, w = free
    ...     return [[x, 0, 0, w], [-x, 0, 0, w]]
    >>> both = opposite(None, (0, 1))
    >>> free, centers = both.reduce(np.array([[0.2, 0, 0, 1], [-0.4, 0, 0, 1]]))
    >>> free.round(6).tolist()
    [0.3, 1.0]
    """
    first = np.array(start, dtype=np.float64)
    if first.ndim != 1 or len(first) == 0 or not np.isfinite(first).all():
        raise ValueError(f"start needs a finite number for each free parameter, not {start!r}")

    def decorate(function: Callable[..., Any]) -> FunctionConstraint:
        return FunctionConstraint(function, first)

    return decorate


class _Follows:
    """Rows of labels that a function gives from numbers of its own."""

    reads: tuple[int, ...] = ()

    def __init__(self, source: FunctionConstraint, labels: tuple[int, ...]) -> None:
        self._source = source
        self.determines = labels
        self.lower = np.full(len(source.start), -np.inf)
        self.upper = np.full(len(source.start), np.inf)

    def _rows(self, free: FloatArray) -> FloatArray:
        rows = np.asarray(self._source.function(free), dtype=np.float64)
        if rows.shape != (len(self.determines), 4):
            raise UsageError(
                f"constraint '{self._source.__name__}' must return a row x, y, z, w for each of"
                f" {len(self.determines)} labels, not an array of shape {rows.shape}"
            )
        return rows

    def expand(self, free: FloatArray, centers: FloatArray) -> FloatArray:
        whole = centers.copy()
        whole[list(self.determines)] = self._rows(free)
        return whole

    def reduce(self, centers: FloatArray) -> tuple[FloatArray, FloatArray]:
        from scipy.optimize import least_squares

        wanted = centers[list(self.determines)]
        tight = 4 * np.finfo(np.float64).eps

        def apart(free: FloatArray) -> FloatArray:
            return (self._rows(free) - wanted).ravel()

        found = least_squares(
            apart,
            self._source.start,
            xtol=tight,
            ftol=tight,
            gtol=tight,
        )
        free: FloatArray = found.x
        return free, self.expand(free, centers)
