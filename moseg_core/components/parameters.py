"""Parameters of components: declared once, in the signature, and checked everywhere.

A component's parameters are the keyword-only arguments of the function or class that implements
it. Their defaults and annotations are the declaration, bounds included::

    def area_fraction(part, *, most: Annotated[float, Interval(0, 1)] = 1.0): ...

A quantity of which people know what is usual is declared as a
:class:`~moseg_core.language.target.Target` and given as ``area=0.06+-0.02``; an Interval then
bounds its value::

    def size(part, *, area: Annotated[Target | None, Interval(0, 1)] = None): ...

What takes more than a call can hold is declared as a :class:`~moseg_core.language.table.Table`; the
call names a table of the recipe, ``among=looks``, and the component gets the table itself::

    def likely(part, *, kind: str, among: Table): ...

From that one place come the check of ``key=value`` in an expression or a recipe, the defaults,
and what the documentation shows.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from moseg_core.errors import ExpressionError, UsageError, unknown
from moseg_core.language import Table, Target, parse_target
from moseg_core.language.table import GIVEN

KINDS: dict[type, str] = {
    float: "a number",
    int: "a number",
    bool: "true or false",
    str: "a word",
    Target: "a target",
    Table: "a table",
}
"""The types that a parameter can have, as users are told."""


PROVIDED: Mapping[str, tuple[str, ...]] = {
    "optimizer": ("rng",),
    "parameterization": ("labels", "expected_shares"),
}
"""By kind the keyword-only arguments that the search provides, where a component takes them."""


@dataclass(frozen=True)
class Interval:
    """Closed bounds of a number, or of a target's value, for use in ``Annotated``.

    Examples
    --------
    >>> 0.5 in Interval(0, 1), 2 in Interval(0, 1)
    (True, False)
    """

    low: float = -math.inf
    high: float = math.inf

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high

    def __str__(self) -> str:
        if self.low == -math.inf and self.high == math.inf:
            return "any number"
        if self.high == math.inf:
            return f"{self.low:g} or more"
        if self.low == -math.inf:
            return f"{self.high:g} or less"
        return f"{self.low:g} to {self.high:g}"


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One declared parameter.

    Parameters
    ----------
    name : str
    type : type
        ``float``, ``int``, ``bool``, ``str``, :class:`~moseg_core.Target` or
        :class:`~moseg_core.Table`.
    default : object or None
        None where a value must be given, or where None is the default.
    interval : Interval
        Allowed values of a number; of a target, those of its value.
    required : bool
    optional : bool
        Whether None is allowed.
    """

    name: str
    type: type
    default: Any = None
    interval: Interval = Interval()
    required: bool = False
    optional: bool = False

    def check(self, value: Any, owner: str) -> Any:
        """The value in the declared type, or a UsageError that names `owner` and parameter."""
        if value is None and self.optional:
            return None
        if self.type is Target:
            value = self._target(value, owner)
            self._check_number(value.value, owner)
            return value
        if self.type is Table:
            return self._table(value, owner)
        if isinstance(value, Target):
            raise self._must_be(owner, f"the target {value}")
        if isinstance(value, Mapping):
            raise self._must_be(owner, "a table")
        if self.type in (int, float):
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise self._must_be(owner, repr(value))
            self._check_number(value, owner)
        elif self.type is bool:
            if value not in (0, 1):
                raise self._must_be(owner, repr(value))
        elif not isinstance(value, str):
            plain = value is None or isinstance(value, (int, float))
            word = str(value).lower()  # as it was written: true, none
            advice = f'; in quotes it is one: {self.name}="{word}"' if plain else ""
            raise self._must_be(owner, f"{value!r}{advice}")
        return self.type(value)

    def _target(self, value: Any, owner: str) -> Target:
        if isinstance(value, Target):
            return value
        if isinstance(value, str):  # the tables of TOML have no targets
            try:
                return parse_target(value)
            except ExpressionError as error:
                raise self._must_be(owner, f"{value!r}; {_ADVICE}") from error
        raise self._must_be(owner, f"{value!r}; {_ADVICE}")

    def _table(self, value: Any, owner: str) -> Table:
        if not isinstance(value, Mapping):
            raise self._must_be(
                owner, f"{value!r}; name one of the recipe's tables: {self.name}=looks"
            )
        return value if isinstance(value, Table) else Table(value)

    def _check_number(self, value: float, owner: str) -> None:
        if not math.isfinite(value):
            raise UsageError(f"{owner}: parameter '{self.name}' must be finite, not {value}")
        if self.type is int and value != int(value):
            raise UsageError(f"{owner}: parameter '{self.name}' must be whole, not {value:g}")
        if value not in self.interval:
            raise UsageError(
                f"{owner}: parameter '{self.name}' is {value:g}; allowed is {self.interval}"
            )

    def _must_be(self, owner: str, found: str) -> UsageError:
        kind = KINDS[self.type]
        return UsageError(f"{owner}: parameter '{self.name}' must be {kind}, not {found}")


_ADVICE = "write 0.06+-0.02: a typical value and how far from it is still usual"


def declared_parameters(
    target: Callable[..., Any], *, reserved: Collection[str] = ()
) -> tuple[Parameter, ...]:
    """The keyword-only arguments of a function, a class's ``__init__`` or an object's ``__call__``.

    Parameters
    ----------
    target : callable
    reserved : collection of str
        Keyword-only arguments that the caller provides, not the user.

    Raises
    ------
    TypeError
        A parameter whose type is none of float, int, bool, str, Target and Table, or whose
        annotation names something that does not exist; one called ``given``, which calls have for
        tables; an object without a signature.

    Examples
    --------
    >>> def tube(part, *, radius: Annotated[float, Interval(0)] = 1.0): ...
    >>> [(p.name, p.type, str(p.interval)) for p in declared_parameters(tube)]
    [('radius', <class 'float'>, '0 or more')]
    """
    function: Any = target
    if isinstance(target, type):
        function = getattr(target, "__init__")  # noqa: B009  # mypy
    elif not inspect.isroutine(target):
        function = getattr(target, "__call__")  # noqa: B004, B009  # an object; mypy
    try:
        hints = get_type_hints(function, include_extras=True)
        signature = inspect.signature(target)
    except (NameError, ValueError) as error:
        raise TypeError(f"its signature cannot be read: {error}") from error
    found = []
    for parameter in signature.parameters.values():
        if parameter.kind is not inspect.Parameter.KEYWORD_ONLY or parameter.name in reserved:
            continue
        if parameter.name == GIVEN:
            raise TypeError(
                f"no parameter can be called '{GIVEN}': in a call that key takes parameters from a"
                " table"
            )
        required = parameter.default is inspect.Parameter.empty
        annotation = hints.get(parameter.name, float if required else type(parameter.default))
        kind, interval, optional = _read_annotation(annotation)
        if kind not in KINDS:
            raise TypeError(
                f"parameter '{parameter.name}' of {getattr(target, '__name__', target)!r} must be"
                f" annotated as float, int, bool, str, Target or Table, not {annotation!r}"
            )
        found.append(
            Parameter(
                name=parameter.name,
                type=kind,
                default=None if required else parameter.default,
                interval=interval,
                required=required,
                optional=optional,
            )
        )
    return tuple(found)


def takes(target: Callable[..., Any], name: str) -> bool:
    """Whether a function or class takes a keyword-only argument of a name.

    Examples
    --------
    >>> def thirds(shape, n_parts, *, labels): ...
    >>> takes(thirds, "labels"), takes(thirds, "n_parts")
    (True, False)
    """
    try:
        found = inspect.signature(target).parameters.get(name)
    except (TypeError, ValueError):  # written in another language
        return False
    return found is not None and found.kind is inspect.Parameter.KEYWORD_ONLY


def check_parameters(
    declared: tuple[Parameter, ...], given: Mapping[str, Any], owner: str
) -> dict[str, Any]:
    """The given values, checked against the declaration.

    Parameters
    ----------
    declared : tuple of Parameter
    given : mapping of str to value
    owner : str
        Whose parameters they are, for messages: ``"optimizer 'core:pattern_search'"``.

    Raises
    ------
    UsageError
        An unknown parameter, with the nearest name; one that is missing or out of range.
    """
    by_name = {parameter.name: parameter for parameter in declared}
    for name in given:
        if name not in by_name:
            raise UsageError(f"{owner}: {unknown('parameter', name, by_name)}")
    for parameter in declared:
        if parameter.required and parameter.name not in given:
            raise UsageError(f"{owner}: parameter '{parameter.name}' is missing")
    return {name: by_name[name].check(value, owner) for name, value in given.items()}


def _read_annotation(annotation: Any) -> tuple[Any, Interval, bool]:
    """(type, interval, whether None is allowed) of ``Annotated[float | None, Interval(...)]``."""
    interval = Interval()
    if get_origin(annotation) is Annotated:
        annotation, *extras = get_args(annotation)
        interval = next((extra for extra in extras if isinstance(extra, Interval)), interval)
    choices = get_args(annotation)
    optional = type(None) in choices
    if optional:
        rest = [choice for choice in choices if choice is not type(None)]
        annotation = rest[0] if len(rest) == 1 else annotation
    return annotation, interval, optional
