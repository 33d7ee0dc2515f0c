"""A problem: the labels that a shape should get, and what makes a labelling good (Sec. 3).

To it belong constraints on the centres (Sec. 8, :mod:`moseg_core.problem.constraints`), and the
embedding in which the partition lives and terms may be evaluated (Sec. 9).

The whole expression is checked when the problem is made, before any shape is read: names,
numbers of labels, parameters. Whether a particular shape has what the objectives require is
checked when the two meet, and before the search.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.components.chosen import Choice, PreparedComponent, prepare
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.discovery.registry import Registry, registry
from moseg_core.components.memo import Memo
from moseg_core.components.objectives import objective
from moseg_core.components.protocols import Objective, Parameterization
from moseg_core.components.requirements import demand
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import REPORT, PluginError, ShapeError, UsageError, unknown
from moseg_core.language import Expression, parse
from moseg_core.problem.aggregate import Evaluation, evaluate_segmentation
from moseg_core.problem.binding import BoundTerm, bind
from moseg_core.problem.constraint_calls import bind_constraints
from moseg_core.problem.constraints import Constraints
from moseg_core.problem.statement import Statement, check_label_names, check_tables
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray

ORIGINAL = "original"
"""The space of a shape as the user gave it."""


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
    constraints : sequence of str or callable, optional
        What centres must obey (Sec. 8): calls such as ``"mirror(leg2, leg1)"``, or functions
        decorated with :func:`moseg_core.constraint`.
    plane : str, optional
        The plane of symmetry, for constraints that need one and are not given one: "auto", an
        axis of the file, or what else they understand.
    embedding : str, mapping or Choice, optional
        A deformation of the shape in which the partition is found, such as "mds" (Sec. 9).
    space : str, optional
        Where terms are evaluated that do not say, "original" or the embedding's name.
    given : mapping of str to mapping, optional
        Tables that calls name: with ``{"leg": {"area": Target(0.06, 0.02)}}`` the call
        ``is(leg*, given=leg)`` means ``is(leg*, area=0.06+-0.02)``.
    registry : Registry, optional
        Where to look for installed objectives; everything installed by default.

    Raises
    ------
    ExpressionError
        The expression is malformed or names something unknown; points at the place.
    UsageError
        No labels, malformed or repeated ones, or an objective or constraint that is none.

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
        constraints: Sequence[str | Callable[..., Any]] = (),
        plane: str | None = None,
        embedding: str | Mapping[str, Any] | Choice | None = None,
        space: str | None = None,
        given: Mapping[str, Any] | None = None,
        registry: Registry | None = None,
    ) -> None:
        self.labels = check_label_names(labels)
        if not isinstance(minimize, str | Expression):
            raise UsageError(f"minimize must be a text such as 'narrow(a)', not {minimize!r}")
        self.expression = parse(minimize) if isinstance(minimize, str) else minimize
        self._own = {name: _as_objective(name, f) for name, f in (objectives or {}).items()}
        self._registry = registry
        self.given = check_tables(given)
        self.plane = plane
        self.embedding = None if embedding is None else Choice.read(embedding, "embedding")
        # Bound at once, so that a mistake shows where it is made.
        self.embedding_component: PreparedComponent | None = None
        if self.embedding is not None:
            self.embedding_component = prepare(self.embedding, "embedding", self.registry)
        spaces = [
            ORIGINAL,
            *([self.embedding_component.component.spec.name] if self.embedding_component else []),
        ]
        self.space = ORIGINAL if space is None else space
        if self.space not in spaces:
            hint = "" if self.embedding else "; give the embedding too"
            raise UsageError(unknown("space", self.space, spaces) + hint)
        self.terms = bind(
            self.expression,
            self.labels,
            self._own,
            self.registry,
            spaces=spaces,
            space=self.space,
            tables=self.given,
        )
        if plane is not None and not isinstance(plane, str):
            raise UsageError(f"plane must be a text such as 'auto' or 'x', not {plane!r:.60}")
        self.bound_constraints = bind_constraints(
            constraints, self.labels, self.registry, plane, self.given
        )

    @classmethod
    def of(cls, statement: Statement, *, registry: Registry | None = None) -> Problem:
        """The problem that a statement asks for on its first level, with all names looked up.

        Parameters
        ----------
        statement : Statement
        registry : Registry, optional
            Where to look; everything installed by default.

        Raises
        ------
        UsageError, PluginError
            As for the constructor; the labels have counts that stand for several label sets.

        Examples
        --------
        >>> from moseg_core.problem.statement import Statement
        >>> Problem.of(Statement(labels=("a", "b"), minimize="narrow(a)")).labels
        ('a', 'b')
        """
        statement = statement.written_out()
        return cls(
            statement.labels,
            statement.minimize,
            constraints=statement.constraints,
            plane=statement.plane,
            embedding=statement.embedding,
            space=statement.space,
            given=statement.given,
            registry=registry,
        )

    @cached_property
    def statement(self) -> Statement:
        """What was asked for, as plain data; objectives and constraints of your own by name."""
        return Statement(
            labels=self.labels,
            minimize=str(self.expression),
            constraints=tuple(bound.text for bound in self.bound_constraints),
            plane=self.plane,
            embedding=self.embedding,
            space=None if self.embedding is None else self.space,
            given=self.given,
        )

    def __repr__(self) -> str:
        return f"Problem({list(self.labels)!r}, {str(self.expression)!r})"

    @property
    def registry(self) -> Registry:
        """Where installed components are looked up."""
        return registry() if self._registry is None else self._registry

    @property
    def versions(self) -> dict[str, str]:
        """Of each component that the problem names, by id, the distribution and its version.

        Examples
        --------
        >>> list(Problem(["a"], "narrow(a) + convex_parts").versions)
        ['basic:convex_parts', 'basic:narrow']
        """
        named = {term.id: term.distribution for term in self.terms}
        named |= {bound.id: bound.distribution for bound in self.bound_constraints}
        if self.embedding_component is not None:
            named[self.embedding_component.component.id] = (
                self.embedding_component.component.distribution
            )
        return dict(sorted(named.items()))

    @cached_property
    def unary_terms(self) -> tuple[BoundTerm, ...]:
        """The terms about single parts, on which labels are assigned (Sec. 6)."""
        return tuple(term for term in self.terms if term.objective.traits.arity == "unary")

    @cached_property
    def alike(self) -> tuple[tuple[int, ...], ...]:
        """Classes of labels of which the unary terms say the same, such as four legs."""
        said = {
            label: tuple(
                (term.memo_key, term.weight, term.space)
                for term in self.unary_terms
                if (label,) in term.calls
            )
            for label in range(len(self.labels))
        }
        classes: list[list[int]] = []
        for label in said:
            for group in classes:
                if said[group[0]] == said[label]:
                    group.append(label)
                    break
            else:
                classes.append([label])
        return tuple(tuple(group) for group in classes)

    def embed(self, shape: Shape) -> Shape:
        """The shape in which the partition is found: embedded, or as it is (Sec. 9).

        Parameters
        ----------
        shape : Shape
            Of input elements, as the user gave it.

        Returns
        -------
        Shape
            Computed once for each shape, and kept as long as the shape.

        Raises
        ------
        ShapeError
            The shape cannot be embedded.
        PluginError
            The embedding does not do what its kind promises.
        """
        ready = self.embedding_component
        if ready is None or shape.original is not None:
            return shape
        component = ready.component
        text = str(Choice(component.id, ready.parameters))
        key = (text, component.distribution, component.spec.target)
        if key not in shape.made_from:
            with ready.guard():
                deformed = ready.make()(shape)
            if not isinstance(deformed, Shape) or deformed.n_elements != shape.n_elements:
                raise PluginError(f"{ready.who} must return a Shape of the same elements; {REPORT}")
            shape.made_from[key] = replace(deformed, space=component.spec.name, original=shape)
        embedded: Shape = shape.made_from[key]
        return embedded

    def constrain(self, partition: Parameterization, shape: Shape) -> Constraints:
        """The constraints on the vectors of a partition of a shape (Sec. 8).

        Raises
        ------
        UsageError
            They contradict each other, or the shape has no plane that they need.
        """
        return Constraints(self.bound_constraints, partition, shape, self.labels)

    @cached_property
    def fields(self) -> tuple[str, ...]:
        """Ids of the fields that the terms say they read, each once."""
        return tuple(dict.fromkeys(name for term in self.terms for name in term.fields))

    @cached_property
    def expected_shares(self) -> FloatArray:
        """(n,) float: the share of the whole area that each label's part is expected to have.

        Above 0 to 1, as the terms about the label say (:class:`moseg_core.Traits`); where several
        do, their geometric mean, weighted like the terms. NaN where none does. Terms of negative
        weight say nothing. The shares need not add up to 1: each says what is known of its label.

        Raises
        ------
        UsageError, PluginError
            An objective fails to say which share it expects.

        Examples
        --------
        >>> Problem(["a", "b"], "area_fraction(a, min=0.1, max=0.3) + narrow(b)").expected_shares
        array([0.2, nan])
        """
        weights, logarithms = np.zeros(len(self.labels)), np.zeros(len(self.labels))
        for term in self.terms:
            share = term.expected_share
            if share is not None:
                concerned = [label for call in term.calls for label in call]
                weights[concerned] += term.weight
                logarithms[concerned] += term.weight * math.log(share)
        shares = np.full(len(self.labels), np.nan)
        known = weights > 0
        shares[known] = np.exp(logarithms[known] / weights[known])
        shares.flags.writeable = False
        return shares

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
        lookup = Lookup(self.registry)
        for term in self.terms:
            who, seen = f"'{term.term.name}'", shape.in_space(term.space)
            demand(seen, term.objective.traits.requires, who)
            for name in term.objective.traits.measures:
                demand(seen, lookup.measure(name).requires, who)
            for name in term.fields:
                demand(shape.in_space(ORIGINAL), lookup.field(name).requires, who)

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
        if any(term.space != ORIGINAL for term in self.terms):
            shape = self.embed(shape)
        self.check(shape)
        segmentation = Segmentation.from_labels(
            shape, labels, len(self.labels), memo=memo, lookup=Lookup(self.registry)
        )
        return evaluate_segmentation(self.terms, self.labels, segmentation, detailed=True)


def _as_objective(name: str, given: Objective | Callable[..., float]) -> Objective:
    if isinstance(given, Objective):
        return given
    try:
        return objective()(given)
    except TypeError as error:
        raise UsageError(f"objective '{name}' cannot be used: {error}") from error
