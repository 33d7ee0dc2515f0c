"""Components that no bundle brings: a class or function that somebody has at hand.

An author tries a component before there is a package around it, ``segment(optimizer=MyClass)``,
and has the contract kit check it, ``cases_of(MyClass, kind="optimizer")``. Such a component is
called by its qualified name, ``module:Class``, and no name that is looked up means it; so a result
says what it was made by, and whoever wants it again has to give the same class again.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from moseg_core.components.discovery.hookspecs import HOOKS
from moseg_core.components.discovery.registry import NOT_INSTALLED, Component
from moseg_core.components.discovery.specs import NAME, Kind, Spec
from moseg_core.errors import UsageError

_SPECS: dict[Kind, type[Spec]] = dict(HOOKS.values())


@dataclass(frozen=True)
class UninstalledComponent(Component):
    """A component that no bundle brings.

    Parameters
    ----------
    bundle, distribution, spec
        See :class:`Component`; the bundle is the module, the distribution
        :data:`NOT_INSTALLED`.
    target : callable
        The class or function itself.
    """

    target: Callable[..., Any]

    @property
    def id(self) -> str:
        """``module:Class``, as :func:`qualified_name` says."""
        return qualified_name(self.target)

    def load(self) -> Callable[..., Any]:
        """The class or function itself."""
        return self.target


def uninstalled(target: Callable[..., Any], kind: Kind) -> UninstalledComponent:
    """A class or function as a component of a kind, of which nothing is declared.

    Parameters
    ----------
    target : callable
    kind : Kind

    Raises
    ------
    UsageError
        The kind needs to be told more, such as the suffixes of a reader.

    Examples
    --------
    >>> class MyOptimizer:
    ...     pass
    >>> component = uninstalled(MyOptimizer, "optimizer")
    >>> component.id.endswith(":MyOptimizer"), component.spec.name
    (True, 'my_optimizer')
    """
    module, _, qualified = qualified_name(target).partition(":")
    plain = re.sub(r"\W", "_", qualified.rpartition(".")[2])
    name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", plain).lower().lstrip("_0123456789")
    try:
        spec = _SPECS[kind](
            name=name if NAME.match(name) else kind,
            target=f"{re.sub(r'[^A-Za-z0-9_.]', '_', module)}:{plain}",
        )
    except TypeError as error:
        wanted = _SPECS[kind].__name__
        raise UsageError(
            f"of a {kind} that is not installed more must be known: give a {wanted} ({error})"
        ) from error
    return UninstalledComponent(bundle=module, distribution=NOT_INSTALLED, spec=spec, target=target)


def qualified_name(target: Callable[..., Any]) -> str:
    """``module:Class.inner`` of a class or function; of other objects that of their class.

    Examples
    --------
    >>> from fractions import Fraction
    >>> qualified_name(Fraction), qualified_name(Fraction.from_float)
    ('fractions:Fraction', 'fractions:Fraction.from_float')
    """
    named = target if hasattr(target, "__qualname__") else type(target)
    return f"{named.__module__}:{named.__qualname__}"


def with_arguments(target: Callable[..., Any]) -> tuple[Callable[..., Any], dict[str, Any]]:
    """What a :func:`functools.partial` of keyword arguments calls, and these; else itself.

    Examples
    --------
    >>> with_arguments(functools.partial(sorted, reverse=True))
    (<built-in function sorted>, {'reverse': True})
    """
    if isinstance(target, functools.partial) and not target.args:
        return target.func, dict(target.keywords)
    return target, {}
