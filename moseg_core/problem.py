"""A problem: the labels that a shape should get, and what makes a labelling good (Sec. 3).

The whole expression is checked when the problem is made, before any shape is read: names,
numbers of labels, parameters. Whether a particular shape has what the objectives require is
checked when the two meet, and before the search.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property

import numpy.typing as npt

from moseg_core.aggregate import Evaluation, evaluate_segmentation
from moseg_core.binding import BoundTerm, bind
from moseg_core.errors import ShapeError, UsageError
from moseg_core.language import Expression, parse
from moseg_core.memo import Memo
from moseg_core.objectives import Requirement, objective
from moseg_core.plugins import Registry, measure_resolver, registry
from moseg_core.protocols import Objective
from moseg_core.segmentation import Segmentation
from moseg_core.shape import Shape

_LABEL = re.compile(r"\w+\Z", re.ASCII)


class Problem:
    """Labels and an aggregate objective.

    Parameters
    ----------
    labels : sequence of str
        Names of the parts: letters, digits and ``_``.
    minimize : str or Expression
        The aggregate, such as ``"3*narrow(handle) + convex_parts"``.
    objectives : mapping of str to objective, optional
        Objectives of your own, without a package: functions decorated with
        :func:`moseg_core.objective`, or plain ones with an annotated first argument.
    registry : Registry, optional
        Where to look for installed objectives; everything installed by default.

    Raises
    ------
    ExpressionError
        The expression is malformed or names something unknown; points at the place.
    UsageError
        No labels, malformed or repeated ones, or an objective that is none.

    Examples
    --------
    >>> problem = Problem(["handle", "head"], "3*narrow(handle) + perpendicular(handle, head)")
    >>> problem.labels
    ('handle', 'head')
    >>> str(problem.expression)
    '3*narrow(handle) + perpendicular(handle, head)'
    """

    def __init__(
        self,
        labels: Sequence[str],
        minimize: str | Expression,
        *,
        objectives: Mapping[str, Objective | Callable[..., float]] | None = None,
        registry: Registry | None = None,
    ) -> None:
        self.labels = check_label_names(labels)
        if not isinstance(minimize, str | Expression):
            raise UsageError(f"minimize must be a text such as 'narrow(a)', not {minimize!r}")
        self.expression = parse(minimize) if isinstance(minimize, str) else minimize
        self._own = {name: _as_objective(name, f) for name, f in (objectives or {}).items()}
        self._registry = registry
        # Bound at once, so that a mistake shows where it is made.
        self.terms = bind(self.expression, self.labels, self._own, self.registry)

    def __repr__(self) -> str:
        return f"Problem({list(self.labels)!r}, {str(self.expression)!r})"

    @property
    def registry(self) -> Registry:
        """Where installed components are looked up."""
        return registry() if self._registry is None else self._registry

    @cached_property
    def unary_terms(self) -> tuple[BoundTerm, ...]:
        """The terms about single parts, on which labels are assigned (Sec. 6)."""
        return tuple(term for term in self.terms if term.objective.traits.arity == "unary")

    def check(self, shape: Shape) -> None:
        """Refuse a shape that this problem cannot be solved on.

        Raises
        ------
        ShapeError
            Fewer elements than labels, or a term that needs what the shape lacks.
        """
        if shape.n_elements < len(self.labels):
            raise ShapeError(
                f"'{shape.name}' has {shape.n_elements} {shape.noun}s, too few for"
                f" {len(self.labels)} labels"
            )
        for term in self.terms:
            for requirement in sorted(term.objective.traits.requires):
                lack = _lack(shape, requirement)
                if lack is not None:
                    raise ShapeError(f"'{term.term.name}' needs {lack}")

    def evaluate(
        self, shape: Shape, labels: npt.ArrayLike, *, memo: Memo | None = None
    ) -> Evaluation:
        """Cost and terms of any labelling.

        Parameters
        ----------
        shape : Shape
        labels : (F,) array_like of int
            Index into :attr:`labels` for every element.
        memo : Memo, optional
            To share values between several labellings of this shape.

        Returns
        -------
        Evaluation

        Raises
        ------
        ShapeError
            The shape lacks something, or the labels do not fit it.

        Examples
        --------
        >>> shape = Shape.from_mesh([[0, 0, 0], [3, 0, 0], [3, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
        >>> found = Problem(["a"], "narrow(a)").evaluate(shape, [0])
        >>> round(found.cost.value, 6), found.terms[0].text
        (0.166667, 'narrow(a)')
        """
        self.check(shape)
        measures = measure_resolver(self.registry)
        segmentation = Segmentation.from_labels(
            shape, labels, len(self.labels), memo=memo, measures=measures
        )
        return evaluate_segmentation(self.terms, self.labels, segmentation)


def _lack(shape: Shape, requirement: Requirement) -> str | None:
    """What a shape lacks and what to do about it, in words; None where it lacks nothing."""
    if requirement == "volume" and shape.volume is None:
        repair = "repair the mesh, " if shape.has_surface else ""
        return (
            f"an enclosed volume, but '{shape.name}' encloses none: {shape.volume_reason};"
            f" {repair}leave out the term or have it estimated (--volume VALUE|hull|winding)"
        )
    if requirement == "adjacency" and shape.adjacency is None:
        return (
            f"to know which elements touch, but '{shape.name}' does not say; leave out the term"
            f" or take the nearest (--adjacency knn)"
        )
    if requirement == "surface" and not shape.has_surface:
        if shape.solid:
            return (
                f"a surface, but the cells of '{shape.name}' fill a solid; leave out the term or"
                f" read the surface alone (--voxels surface)"
            )
        return f"a surface, but '{shape.name}' is a {shape.geometry.kind}; leave out the term"
    return None


def check_label_names(labels: Sequence[str]) -> tuple[str, ...]:
    """The labels as a tuple, or a UsageError that says which is malformed or repeated.

    Examples
    --------
    >>> check_label_names(["a", "b", "a"])
    Traceback (most recent call last):
        ...
    moseg_core.errors.UsageError: label 'a' is given twice; labels are distinct names
    """
    if isinstance(labels, str):
        raise UsageError(f"labels must be a list of names, not the text '{labels}'")
    if not isinstance(labels, Iterable):
        raise UsageError(f"labels must be a list of names, not {labels!r}")
    names = tuple(labels)
    if not names:
        raise UsageError("a problem needs at least one label")
    for name in names:
        if not isinstance(name, str) or not _LABEL.match(name):
            raise UsageError(
                f"label {name!r} is not allowed; labels are made of letters, digits and '_'"
            )
        if names.count(name) > 1:
            raise UsageError(f"label '{name}' is given twice; labels are distinct names")
    return names


def _as_objective(name: str, given: Objective | Callable[..., float]) -> Objective:
    if isinstance(given, Objective):
        return given
    try:
        return objective()(given)
    except TypeError as error:
        raise UsageError(f"objective '{name}' cannot be used: {error}") from error
