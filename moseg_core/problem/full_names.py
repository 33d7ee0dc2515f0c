"""Names in full: what a recipe or a result means by them, whatever else is installed.

Users write ``narrow`` for ``basic:narrow``, as long as no other bundle has a ``narrow``. A recipe
of a bundle, or a saved result, was written when that was so, and may be read when it is not. Both
know what they mean: the recipe its bundle's own components and those of the distributions that
this one requires, the result those that it lists with their versions. So names that have become
ambiguous are replaced by ids where the two are read, and everything behind that, the next result
included, needs to know nothing of where they came from.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.registry import Registry
from moseg_core.components.discovery.specs import Kind
from moseg_core.errors import ExpressionError, UsageError
from moseg_core.language import Term, parse, parse_call
from moseg_core.problem.settings import CHOSEN_KINDS
from moseg_core.problem.statement import Statement

Meaning = Callable[[Kind, str], str]
"""From a name as it was written to one that is not ambiguous, where it is known what was meant."""


def meant_by_bundle(bundle: str, source: Registry) -> Meaning:
    """What names mean in a recipe that a bundle brings."""
    return lambda kind, name: source.in_full(kind, name, bundle)


def meant_by_result(used: Collection[str], source: Registry) -> Meaning:
    """What names mean in a result.

    Parameters
    ----------
    used : collection of str
        Ids of all components that it was made with.
    source : Registry

    Raises
    ------
    UsageError
        When asked about a name that another component has now.
    """

    def meaning(kind: Kind, name: str) -> str:
        ids = [c.id for c in source.components(kind) if c.spec.name == name]
        known = [identifier for identifier in ids if identifier in used]
        if known or not ids:
            return known[0] if len(ids) > 1 and len(known) == 1 else name
        others = [identifier for identifier in used if identifier.rpartition(":")[2] == name]
        if others:
            raise UsageError(
                f"{kind} '{name}' was '{others[0]}' when the result was made, and here it would be"
                f" '{ids[0]}'; install the bundle that it was made with, or say what you mean"
            )
        return name

    return meaning


def statement_in_full(
    statement: Statement, meaning: Meaning, *, leave: Collection[str] = ()
) -> Statement:
    """A statement with ids for all names that are ambiguous; also those of its parts.

    Parameters
    ----------
    statement : Statement
    meaning : callable
    leave : collection of str
        Fields to leave as they are, since they will be replaced: "minimize", "constraints",
        "embedding".

    Raises
    ------
    ExpressionError
        An expression or a constraint is malformed.
    UsageError
        A name is ambiguous even to whoever wrote it.
    """
    embedding = statement.embedding
    chosen: dict[str, Any] = {
        kind: choice_in_full(Choice.read(choice, kind), kind, meaning)
        for kind in CHOSEN_KINDS
        if (choice := getattr(statement.search, kind)) is not None
    }
    full: dict[str, Any] = {}
    if "minimize" not in leave:
        full["minimize"] = expression_in_full(statement.minimize, meaning)
    if "constraints" not in leave:
        full["constraints"] = tuple(constraint_in_full(t, meaning) for t in statement.constraints)
    if "embedding" not in leave and embedding is not None:
        full["embedding"] = choice_in_full(embedding, "embedding", meaning)
    return replace(
        statement,
        **full,
        search=replace(statement.search, **chosen),
        parts=tuple((label, statement_in_full(part, meaning)) for label, part in statement.parts),
    )


def expression_in_full(text: str, meaning: Meaning) -> str:
    """An expression with the ids of objectives whose names are ambiguous; else as it was.

    Raises
    ------
    ExpressionError
        It is malformed, or a name is ambiguous even to whoever wrote it.
    """
    expression = parse(text)
    terms = tuple(_term_in_full(term, "objective", meaning, text) for term in expression.terms)
    return text if terms == expression.terms else str(replace(expression, terms=terms))


def constraint_in_full(text: str, meaning: Meaning) -> str:
    """A constraint with its id where its name is ambiguous; else as it was.

    Raises
    ------
    ExpressionError
        As for :func:`expression_in_full`.
    """
    call = parse_call(text, labels=True)
    full = _term_in_full(call, "constraint", meaning, text)
    return text if full == call else str(full)


def choice_in_full(choice: Choice, kind: Kind, meaning: Meaning) -> Choice:
    """A component with its id where its name is ambiguous; else as it was.

    Raises
    ------
    UsageError
        The name is ambiguous even to whoever wrote it.
    """
    return replace(choice, name=meaning(kind, choice.name))


def _term_in_full(term: Term, kind: Kind, meaning: Meaning, text: str) -> Term:
    try:
        return replace(term, name=meaning(kind, term.name))
    except UsageError as error:
        raise ExpressionError(str(error), text, *term.span) from error
