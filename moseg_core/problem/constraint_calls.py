"""Constraints as a user writes them: ``mirror(leg2, leg1)``, ``on_plane(body)``, or a function.

A constraint is a call of the expression language about labels, or an object made from a function by
:func:`constraint`. Names and labels are looked up before any shape is read; the
constraint itself (:class:`moseg_core.components.protocols.Constraint`) is made when the shape is
there, and :mod:`moseg_core.problem.constraints` puts several together.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from moseg_core.components.constraint_function import FunctionConstraint
from moseg_core.components.discovery.registry import Component, Registry
from moseg_core.components.faults import guarded
from moseg_core.components.parameters import declared_parameters
from moseg_core.components.protocols import Constraint
from moseg_core.errors import REPORT, ExpressionError, PluginError, UsageError
from moseg_core.language import Argument, Table, Term, parse_call
from moseg_core.problem.binding import chosen_labels, chosen_parameters
from moseg_core.shape.shape import Shape


@dataclass(frozen=True, eq=False, kw_only=True)
class BoundConstraint:
    """A constraint that was found and checked, and waits for its shape.

    Parameters
    ----------
    text : str
        As written: ``mirror(leg2, leg1)``.
    id : str
        ``bundle:name``; ``python:name`` for one given as a function.
    distribution : str
        Where it comes from, for messages.
    factory : callable
        Makes the constraint from a shape and labels.
    labels : tuple of int
    parameters : dict of str to value
    component : Component or None
        None for a constraint of the calling program.
    """

    text: str
    id: str
    distribution: str
    factory: Callable[..., Any]
    labels: tuple[int, ...]
    parameters: dict[str, Any]
    component: Component | None = None

    def make(self, shape: Shape) -> Constraint:
        """The constraint on a shape.

        Raises
        ------
        PluginError
            It cannot be made, or is none.
        """
        if self.component is None:
            made = self.factory(shape, self.labels, **self.parameters)
        else:
            with self.component.guard("cannot be made"):
                made = self.factory(shape, self.labels, **self.parameters)
        if not isinstance(made, Constraint):
            raise PluginError(
                f"constraint '{self.id}' of {self.distribution} makes a {type(made).__name__},"
                f" which is not a Constraint; {REPORT}"
            )
        return made

    def call(self, method: Callable[..., Any], *arguments: Any) -> Any:
        """What a method of the constraint returns.

        Raises
        ------
        PluginError
            It fails; says which constraint and how.
        """
        who = f"constraint '{self.id}' of {self.distribution}"
        with guarded(who, name=f"constraint {self.id}", source=self.distribution):
            return method(*arguments)

    @property
    def role(self) -> tuple[Any, ...]:
        """What two constraints have in common that say the same of different labels."""
        return (self.id, tuple(sorted(self.parameters.items())))


def bind_constraints(
    given: Sequence[str | Callable[..., Any]],
    labels: Sequence[str],
    registry: Registry,
    plane: str | None,
    tables: Table | None = None,
) -> tuple[BoundConstraint, ...]:
    """Look up everything that constraints name.

    Parameters
    ----------
    given : sequence of str or callable
        Calls such as ``"on_plane(head, body)"``, or objects made by :func:`constraint`, which
        are about all labels.
    labels : sequence of str
        The problem's labels.
    registry : Registry
    plane : str or None
        For constraints that take a parameter of this name and are not given one.
    tables : Table, optional
        The problem's tables, from which calls take parameters.

    Raises
    ------
    ExpressionError
        Unknown constraint, label or parameter, with the nearest name.
    UsageError
        Something else than a text or a constraint.
    PluginError
        A constraint whose bundle is broken.
    """
    if isinstance(given, str):
        raise UsageError(f"constraints must be a list of calls, not the text '{given}'")
    tables = Table() if tables is None else tables
    found: list[BoundConstraint] = []
    for item in given:
        if isinstance(item, str):
            found += _from_text(item, labels, registry, plane, tables)
        elif isinstance(item, FunctionConstraint):
            name = item.__name__
            every = tuple(range(len(labels)))
            found.append(
                BoundConstraint(
                    text=name,
                    id=f"python:{name}",
                    distribution="the calling program",
                    factory=item,
                    labels=every,
                    parameters={},
                )
            )
        else:
            raise UsageError(
                f"a constraint is a text such as 'mirror(leg2, leg1)' or a function decorated with"
                f" @moseg_core.constraint(start=...), not {item!r:.60}"
            )
    return tuple(found)


def _from_text(
    text: str, labels: Sequence[str], registry: Registry, plane: str | None, tables: Table
) -> list[BoundConstraint]:
    term = parse_call(text, labels=True)
    try:
        component = registry.find("constraint", term.name)
    except UsageError as error:
        raise ExpressionError(str(error), text, *term.span) from error
    factory = component.load()
    try:
        declared = (
            factory.parameters
            if isinstance(factory, FunctionConstraint)
            else declared_parameters(factory)
        )
    except TypeError as error:
        raise PluginError(f"{component.who} cannot be used: {error}; {REPORT}") from error
    parameters = chosen_parameters(term, text, declared, tables)
    if plane is not None and any(parameter.name == "plane" for parameter in declared):
        parameters.setdefault("plane", plane)
    chosen = chosen_labels(term, text, labels) or list(range(len(labels)))
    # A constraint on single centres that is given several is meant for each of them.
    each = [(label,) for label in chosen] if getattr(factory, "each", False) else [tuple(chosen)]
    return [
        BoundConstraint(
            text=str(term) if len(each) == 1 else _about(term, [labels[k] for k in group]),
            id=component.id,
            distribution=component.distribution,
            factory=factory,
            labels=group,
            parameters=parameters,
            component=component,
        )
        for group in each
    ]


def _about(term: Term, names: Sequence[str]) -> str:
    """The same call of certain labels, with its parameters."""
    return str(replace(term, arguments=tuple(Argument(name) for name in names)))
