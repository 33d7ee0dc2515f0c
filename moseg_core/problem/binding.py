"""Giving the names in an expression their meaning: objectives, labels, parameters.

A term of the language becomes a :class:`BoundTerm`: an objective, its weight, and the *calls*
that it stands for. A unary objective given several labels is called once for each, and the values
add up; an n-ary one is called once with all of them; a global one once with no labels.

Where a call names a table of the problem (:mod:`moseg_core.language.table`), the parameters of the
bound term are those of the table and the call together: nothing behind this needs to know of it.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeVar

from moseg_core.components.discovery.registry import Registry
from moseg_core.components.faults import FAULTS, describe
from moseg_core.components.objectives import COST_ORDER, Arity
from moseg_core.components.parameters import Parameter, check_parameters
from moseg_core.components.part_array import Vectorized
from moseg_core.components.protocols import Objective
from moseg_core.errors import REPORT, ExpressionError, PluginError, UsageError, nearest, unknown
from moseg_core.language import Argument, Expression, Table, Term
from moseg_core.language.table import GIVEN, named_table

_Answer = TypeVar("_Answer")

MOST_WEIGHT = 1e100
"""The largest weight of a term: sums of weighted costs are far from what a float can hold."""

MOST_TERMS = 1000
"""Terms of an expression: each is evaluated for every candidate of a search."""


@dataclass(frozen=True, eq=False, kw_only=True)
class BoundTerm:
    """A term that can be evaluated.

    Parameters
    ----------
    term : Term
        As written.
    id : str
        ``bundle:name`` of the objective; ``python:name`` for one given as a function.
    distribution : str
        Where the objective comes from, for messages.
    objective : Objective
    parameters : dict of str to value
        Those of the table that the call names, and its own.
    calls : tuple of tuple of int
        For each call the indices of the labels whose parts it receives.
    space : str
        Where the parts are that it receives: "original", or the name of an embedding (Sec. 9).
    """

    term: Term
    id: str
    distribution: str
    objective: Objective
    parameters: dict[str, Any]
    calls: tuple[tuple[int, ...], ...]
    space: str = "original"

    @cached_property
    def written(self) -> str:
        """The term as text, made once: it is needed with every call."""
        return str(self.term)

    @cached_property
    def weight(self) -> float:
        """The factor before the term, with its sign."""
        return self.term.weight

    @cached_property
    def arity(self) -> Arity:
        """How many parts the objective is of."""
        return self.objective.traits.arity

    @cached_property
    def cost_rank(self) -> int:
        """0 for cheap objectives, up to 2 for expensive ones."""
        return COST_ORDER[self.objective.traits.cost]

    @property  # not kept: a function without a name could not be pickled with the term
    def vectorized(self) -> Vectorized | None:
        """The objective's vectorised form, where it has one."""
        return self.objective.traits.vectorized

    @property
    def at_least(self) -> Vectorized | None:
        """What bounds the objective's values from below, where that bounds the cost."""
        traits = self.objective.traits
        return traits.at_least if traits.vectorized is None and self.weight > 0 else None

    @property
    def fields(self) -> tuple[str, ...]:
        """Ids of the fields that the objective says it reads.

        Raises
        ------
        UsageError
            The objective does not accept its parameters.
        PluginError
            What the objective gives for them is no sequence of texts, or it fails.
        """
        names = self.objective.traits.fields
        if not callable(names):
            return names
        found = self._answer(names, "name its fields")
        if isinstance(found, str) or not all(isinstance(name, str) for name in found):
            raise PluginError(
                f"objective '{self.id}' of {self.distribution} must name its fields in a tuple, not"
                f" {found!r:.60}; {REPORT}"
            )
        return tuple(found)

    @property
    def expected_share(self) -> float | None:
        """The share of the whole area that each part has where the term is low, above 0 to 1.

        None where the objective says nothing of it, and where its value is wanted high.

        Raises
        ------
        UsageError
            The objective does not accept its parameters.
        PluginError
            What it gives for a share is none, or it fails.
        """
        if self.weight < 0:
            return None
        return self._answer(
            self.objective.traits.expected_share,
            f"say which share of the area it expects in '{self.term.call}'",
        )

    @property
    def averaged_field(self) -> tuple[str, Mapping[str, Any]] | None:
        """The id and parameters of the field whose mean over a part is the value; else None.

        Raises
        ------
        UsageError
            The objective does not accept its parameters.
        PluginError
            What it gives for them is no field with its parameters, or it fails.
        """
        return self._answer(
            self.objective.traits.averaged_field,
            f"say of which field '{self.term.call}' is the mean",
        )

    def _answer(self, ask: Callable[[Mapping[str, Any]], _Answer], to: str) -> _Answer:
        """What the objective says of the parameters, or an error that says what it failed to do."""
        try:
            return ask(self.parameters)
        except UsageError as error:  # it says what is wrong with its parameters
            raise UsageError(f"in '{self.term.call}': {error}") from error
        except FAULTS as error:
            raise PluginError(
                f"objective '{self.id}' of {self.distribution} failed to {to}: {describe(error)};"
                f" {REPORT}"
            ) from error

    @cached_property
    def memo_key(self) -> Hashable:
        """What tells this objective with these parameters from all others."""
        # The object too: two functions of the calling program may have one name.
        return _Hashed(self.id, _Same(self.objective), *sorted(self.parameters.items()))


class _Hashed:
    """A tuple that is hashed once: of many parameters that takes longer than a look in a memo."""

    __slots__ = ("_hash", "_values")

    def __init__(self, *values: Hashable) -> None:
        self._values, self._hash = values, hash(values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Hashed) and other._values == self._values

    def __hash__(self) -> int:
        return self._hash


class _Same:
    """Equal to itself for the same object, which need not be hashable; keeps it alive."""

    def __init__(self, target: object) -> None:
        self.target = target

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and other.target is self.target

    def __hash__(self) -> int:
        return id(self.target)


def bind(
    expression: Expression,
    labels: Sequence[str],
    objectives: Mapping[str, Objective],
    registry: Registry,
    *,
    spaces: Sequence[str] = ("original",),
    space: str = "original",
    tables: Table | None = None,
) -> tuple[BoundTerm, ...]:
    """Look up everything that an expression names.

    Parameters
    ----------
    expression : Expression
    labels : sequence of str
    objectives : mapping of str to Objective
        Objectives given in Python; they come before installed ones of the same name.
    registry : Registry
    spaces : sequence of str
        Where terms can be evaluated.
    space : str
        Where those are that do not say.
    tables : Table, optional
        What calls name with ``given``, or for parameters that are tables.

    Raises
    ------
    ExpressionError
        Unknown objective, label, space, table or parameter, with the nearest name; wrong number of
        labels.
    PluginError
        An objective whose bundle is broken.
    """
    text = expression.text or str(expression)
    for term in expression.terms:
        if not abs(term.weight) <= MOST_WEIGHT:
            raise ExpressionError(
                f"the weight {term.weight:g} is too large; weights are at most {MOST_WEIGHT:g}",
                text,
                *term.span,
            )
    tables = Table() if tables is None else tables
    bound = tuple(
        replace(
            _bind_term(term, text, labels, objectives, registry, tables),
            space=_space(term, text, spaces, space),
        )
        for term in expression.terms
    )
    if len(bound) > MOST_TERMS:  # mistakes are told first
        raise ExpressionError(
            f"an expression has at most {MOST_TERMS} terms, and this one {len(bound)}; a label with"
            " a star, narrow(leg*), stands for many",
            text,
            *expression.terms[MOST_TERMS].span,
        )
    return bound


def _space(term: Term, text: str, spaces: Sequence[str], default: str) -> str:
    """Where a term is evaluated."""
    if not term.space:
        return default
    if term.space not in spaces:
        reason = unknown("space", term.space, spaces)
        if len(spaces) == 1 and nearest(term.space, spaces) is None:
            reason = f"there is no space '{term.space}'; give the embedding '{term.space}' too"
        raise ExpressionError(reason, text, *term.space_span)
    return term.space


def _bind_term(
    term: Term,
    text: str,
    labels: Sequence[str],
    objectives: Mapping[str, Objective],
    registry: Registry,
    tables: Table,
) -> BoundTerm:
    identifier, distribution, target = find_objective(term, text, labels, objectives, registry)
    traits = target.traits
    chosen = chosen_labels(term, text, labels)
    check_count(term, text, target, len(chosen))
    parameters = chosen_parameters(term, text, target.parameters, tables)
    if traits.arity == "unary":
        calls: tuple[tuple[int, ...], ...] = tuple((index,) for index in chosen)
    else:
        calls = (tuple(chosen),)
    return BoundTerm(
        term=term,
        id=identifier,
        distribution=distribution,
        objective=target,
        parameters=parameters,
        calls=calls,
    )


def find_objective(
    term: Term,
    text: str,
    labels: Sequence[str],
    objectives: Mapping[str, Objective],
    registry: Registry,
) -> tuple[str, str, Objective]:
    """(id, distribution, objective) of a term's name.

    Raises
    ------
    ExpressionError
        There is none, with the nearest name.
    PluginError
        Its bundle is broken.
    """
    if term.name in objectives:
        return f"python:{term.name}", "the calling program", objectives[term.name]
    try:
        component = registry.find("objective", term.name)
    except UsageError as error:
        reason = str(error)
        known = [*objectives, *registry.names("objective")]
        if term.name in labels:
            reason = f"'{term.name}' is a label, not an objective; write objective({term.name})"
        elif nearest(term.name, objectives) and "ambiguous" not in reason:
            reason = unknown("objective", term.name, known)
        raise ExpressionError(reason, text, *term.span) from error
    target = component.load()
    if not isinstance(target, Objective):
        raise PluginError(
            f"objective '{component.id}' of {component.distribution} is a"
            f" {type(target).__name__} without traits and parameters; its authors should decorate"
            f" it with @moseg_core.objective"
        )
    return component.id, component.distribution, target


def chosen_labels(term: Term, text: str, labels: Sequence[str]) -> list[int]:
    """Indices of the labels that a call names, globs in the order of the labels.

    Raises
    ------
    ExpressionError
        An unknown label, one that comes twice, or a glob that matches none.
    """
    chosen: list[int] = []
    for argument in term.arguments:
        for index in matched_labels(argument, text, labels):
            if index in chosen:
                raise ExpressionError(
                    f"label '{labels[index]}' is given twice to '{term.name}'", text, *argument.span
                )
            chosen.append(index)
    return chosen


def chosen_parameters(
    term: Term, text: str, declared: tuple[Parameter, ...], tables: Table
) -> dict[str, Any]:
    """The parameters that a call gives, checked against their declaration.

    With ``given=NAME`` those of a table, in so far as the call does not give them itself. Where
    a parameter is declared as a table, the name of one stands for it.

    Raises
    ------
    ExpressionError
        One that is unknown, of another type, out of range or missing, or a table that is unknown;
        points at the place.
    """
    parameters: dict[str, Any] = {}
    optional = {p.name: replace(p, required=False) for p in declared}
    # A call made in Python need not say where its parameters stand.
    spans = term.keys or (term.span,) * len(term.parameters)
    said = list(zip(term.parameters, spans, strict=True))
    # The table's go first, so that the call's own replace them.
    for (key, value), span in sorted(said, key=lambda one: one[0][0] != GIVEN):
        try:
            if key == GIVEN:
                entries: Mapping[str, Any] = named_table(tables, value)
                who = f"table '{value}' for '{term.name}'"
            else:
                entries, who = {key: value}, f"'{term.name}'"
            for name, entry in entries.items():
                if isinstance(entry, str) and name in optional and optional[name].type is Table:
                    entry = named_table(tables, entry)
                parameters |= check_parameters(tuple(optional.values()), {name: entry}, who)
        except UsageError as error:
            raise ExpressionError(str(error), text, *span) from error
    try:
        check_parameters(declared, parameters, f"'{term.name}'")
    except UsageError as error:
        raise ExpressionError(str(error), text, *term.span) from error
    return parameters


def matched_labels(argument: Argument, text: str, labels: Sequence[str]) -> list[int]:
    """Indices of the labels that one argument stands for.

    Raises
    ------
    ExpressionError
        An unknown label, or a glob that matches none.
    """
    if argument.is_glob:
        found = [i for i, name in enumerate(labels) if fnmatch.fnmatchcase(name, argument.pattern)]
        if not found:
            raise ExpressionError(
                f"'{argument.pattern}' matches none of the labels {', '.join(labels)}",
                text,
                *argument.span,
            )
        return found
    if argument.pattern not in labels:
        raise ExpressionError(unknown("label", argument.pattern, labels), text, *argument.span)
    return [labels.index(argument.pattern)]


def check_count(term: Term, text: str, target: Objective, count: int) -> None:
    """Refuse a call with more or fewer labels than its objective takes.

    Raises
    ------
    ExpressionError
        Points at the call.
    """
    traits = target.traits
    if traits.arity == "global":
        wrong = count > 0
    elif traits.arity == "unary":
        wrong = count == 0
    else:
        wrong = count < traits.least or (traits.most is not None and count > traits.most)
    if wrong:
        given = "none" if count == 0 else str(count)
        raise ExpressionError(f"'{term.name}' takes {traits.takes}, not {given}", text, *term.span)
