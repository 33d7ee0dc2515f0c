"""A component that somebody chose, by name and with parameters; found, loaded and checked.

A choice is written like a call of the expression language, ``pattern_search(expansion=2)``, or in
a recipe as a table with a ``name``. It is looked up and checked before any shape is read. In Python
it can also be a class or a factory that no bundle brings
(:mod:`moseg_core.components.discovery.uninstalled`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from typing import Any

from moseg_core.components.discovery.registry import Component, Registry
from moseg_core.components.discovery.specs import Kind
from moseg_core.components.discovery.uninstalled import (
    qualified_name,
    uninstalled,
    with_arguments,
)
from moseg_core.components.parameters import (
    PROVIDED,
    Parameter,
    check_parameters,
    declared_parameters,
)
from moseg_core.errors import REPORT, PluginError, UsageError, shown, unknown
from moseg_core.language import Table, parse_call
from moseg_core.language.table import named_table
from moseg_core.language.terms import format_call

OCCASIONS = ("default", "coarse", "polish", "again")
"""When a component may be used with other parameters than the defaults of its signature: see
``presets`` in :mod:`moseg_core.components.protocols`."""

_AS_CLASSES = ("parameterization", "seeder", "labeler", "optimizer", "refiner")
"""The kinds of which a class need not be installed. Embeddings are part of a problem, which is
read again from results by their names."""


@dataclass(frozen=True)
class Choice:
    """A component by name, with parameters.

    Parameters
    ----------
    name : str
    parameters : mapping of str to value
    target : callable, optional
        The class or factory itself, where it is not installed; the name is then the qualified one.

    Examples
    --------
    >>> str(Choice.read("pattern_search(expansion=2)", "optimizer"))
    'pattern_search(expansion=2)'
    >>> Choice.read({"name": "kmeans", "rounds": 5}, "seeder").parameters
    {'rounds': 5}
    """

    name: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    target: Callable[..., Any] | None = None

    def __hash__(self) -> int:
        # Parameters that a recipe's table gives may be lists; the names tell most choices apart.
        return hash((self.name, tuple(sorted(self.parameters))))

    @classmethod
    def read(
        cls, given: str | Mapping[str, Any] | Choice | Callable[..., Any], kind: Kind
    ) -> Choice:
        """From text, a table, or a class or factory that is not installed.

        Parameters of the latter are given by :func:`functools.partial`, or in a table with the
        class as its ``name``.

        Raises
        ------
        ExpressionError
            Malformed text.
        UsageError
            A table without a name; a class of a kind that has to be installed.
        """
        if isinstance(given, Choice):
            return given
        if isinstance(given, str):
            term = parse_call(given)
            return cls(term.name, dict(term.parameters))
        table = given if isinstance(given, Mapping) else {"name": given}
        name = table.get("name")
        more = {key: v for key, v in table.items() if key != "name"}
        if callable(name) and kind in _AS_CLASSES:
            target, own = with_arguments(name)
            return cls(qualified_name(target), {**own, **more}, target)
        if not isinstance(given, Mapping) or not isinstance(name, str):
            raise UsageError(f"{kind} must be a name or a table with a name, not {shown(given)}")
        return cls(name, more)

    def component(self, kind: Kind, registry: Registry) -> Component:
        """The component that is meant.

        Raises
        ------
        UsageError, PluginError
            None, or several; see :meth:`Registry.find`.
        """
        if self.target is not None:
            return uninstalled(self.target, kind)
        return registry.find(kind, self.name)

    def __str__(self) -> str:
        return format_call(self.name, parameters=self.parameters.items())


@dataclass(frozen=True, kw_only=True)
class PreparedComponent:
    """A choice that was found, loaded and checked.

    Parameters
    ----------
    component : Component
    factory : callable
        The class behind it.
    parameters : dict of str to value
    by_user : bool
        Whether the user has chosen any of them.
    presets : mapping of str to dict
        For each occasion that the class names, parameters that take the place of these.
    """

    component: Component
    factory: Callable[..., Any]
    parameters: dict[str, Any]
    by_user: bool = False
    presets: Mapping[str, dict[str, Any]] = field(default_factory=dict)

    def preset(self, occasion: str) -> PreparedComponent:
        """With the parameters that the class names for an occasion; else as it is."""
        return replace(self, parameters=self.presets.get(occasion, self.parameters))

    def tuned(self, occasion: str) -> PreparedComponent:
        """The same where the user has chosen no parameters; else as it is."""
        return self if self.by_user else self.preset(occasion)

    def varied(self) -> PreparedComponent:
        """For the starts after the first: what the class names for these, where nobody says else.

        Other parameters stay as they are.
        """
        return replace(self, parameters={**self.presets.get("again", {}), **self.parameters})

    def make(self, *arguments: Any, **more: Any) -> Any:
        """Construct the component with what the search gives it and the user's parameters.

        Raises
        ------
        PluginError
            The constructor does not take what its kind is given, or fails.
        """
        with self.guard("cannot be made"):
            return self.factory(*arguments, **more, **self.parameters)

    @property
    def who(self) -> str:
        """The component and where it comes from, for messages."""
        return self.component.who

    def guard(self, what: str = "failed") -> AbstractContextManager[None]:
        """See :meth:`moseg_core.components.discovery.registry.Component.guard`."""
        return self.component.guard(what)


def prepare(
    choice: Choice, kind: Kind, registry: Registry, *, tables: Table | None = None
) -> PreparedComponent:
    """Find a component, load it and check its parameters.

    Parameters
    ----------
    choice : Choice
    kind : str
    registry : Registry
    tables : Table, optional
        Of a recipe: their names stand for them where the component declares a table.

    Raises
    ------
    UsageError
        Unknown component, table or parameter, with the nearest name; a value out of range.
    PluginError
        The component's bundle is broken, or its presets or its spec speak of parameters that
        it does not have.
    """
    component = choice.component(kind, registry)
    target = component.load()
    if not callable(target):
        raise PluginError(
            f"{component.who} cannot be called: {component.spec.target} is a"
            f" {type(target).__name__}; {REPORT}"
        )
    try:
        declared = declared_parameters(target, reserved=PROVIDED.get(kind, ()))
    except TypeError as error:
        raise PluginError(f"{component.who} cannot be used: {error}; {REPORT}") from error
    if getattr(component.spec, "takes_centers", False) and not any(
        parameter.name == "centers" for parameter in declared
    ):
        raise PluginError(
            f"{component.who} is said to take centres and has no parameter 'centers'; {REPORT}"
        )
    names = {parameter.name for parameter in declared}
    for name in getattr(component.spec, "label_parameters", ()):
        if name not in names:
            raise PluginError(
                f"{component.who} is said to name labels in '{name}', and has no such parameter;"
                f" {REPORT}"
            )
    given = dict(choice.parameters)
    if tables is not None:
        for parameter in declared:
            named = given.get(parameter.name)
            if parameter.type is Table and isinstance(named, str):
                given[parameter.name] = named_table(tables, named)
    parameters = check_parameters(declared, given, f"{kind} '{choice.name}'")
    return PreparedComponent(
        component=component,
        factory=target,
        parameters=parameters,
        by_user=bool(parameters),
        presets=_presets(component, target, declared),
    )


def _presets(
    component: Component, target: Any, declared: tuple[Parameter, ...]
) -> dict[str, dict[str, Any]]:
    """The presets of a class, checked like what a user gives."""
    presets = getattr(target, "presets", {})
    try:
        for occasion in presets:
            if occasion not in OCCASIONS:
                raise UsageError(unknown("occasion", str(occasion), OCCASIONS))
        return {
            occasion: check_parameters(declared, dict(given), f"preset '{occasion}'")
            for occasion, given in presets.items()
        }
    except (AttributeError, TypeError, ValueError) as error:  # a UsageError is a ValueError
        raise PluginError(f"{component.who} has impossible presets: {error}; {REPORT}") from error
