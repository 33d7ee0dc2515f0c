"""Measures and fields by name: what objectives share, whichever bundle it comes from.

An objective asks for a measure of a part, ``part.measure("basic:hull_volume")``, or for a field,
``part.field("basic:thickness")``. A :class:`Lookup` finds the function behind the name, loads it
once, and blames it by its own name where it fails, whichever objective had asked for it.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, cast

from moseg_core.components.discovery.registry import Component, Registry, registry
from moseg_core.components.discovery.specs import FieldSpec, Kind, MeasureSpec, Requirement


@dataclass(frozen=True, kw_only=True)
class FoundMeasure:
    """A measure that was found by name.

    Parameters
    ----------
    id : str
        ``bundle:name``.
    function : callable
        Of a part and the measure's own parameters.
    keep : bool
        Whether values are kept beyond the part's life.
    requires : tuple of {"volume", "adjacency", "surface"}
        What the shape must have.
    """

    id: str
    function: Callable[..., Any]
    keep: bool
    requires: tuple[Requirement, ...] = ()


@dataclass(frozen=True, kw_only=True)
class FoundField:
    """A field that was found by name.

    Parameters
    ----------
    id : str
        ``bundle:name``.
    source : str
        The distribution and the target: what tells it from another of the same id.
    function : callable
        Of a shape and the field's own parameters.
    requires : tuple of {"volume", "adjacency", "surface"}
        What the shape must have.
    defaults : mapping of str to object
        What the field's own parameters are where nobody says: values that were asked for with
        them are the same as those that were asked for without.
    """

    id: str
    source: str
    function: Callable[..., Any]
    requires: tuple[Requirement, ...]
    defaults: Mapping[str, Any] = field(default_factory=dict)


class Lookup:
    """Finds measures and fields; each is loaded once.

    Parameters
    ----------
    source : Registry, optional
        Where to look; everything installed by default.

    Examples
    --------
    >>> Lookup().measure("basic:hull_volume").id
    'basic:hull_volume'
    """

    def __init__(self, source: Registry | None = None) -> None:
        self._source = source
        self._measures: dict[str, FoundMeasure] = {}
        self._fields: dict[str, FoundField] = {}

    def measure(self, name: str) -> FoundMeasure:
        """The measure of a name.

        Raises
        ------
        UsageError
            No installed bundle has it, or several have; names the nearest.
        PluginError
            Its bundle is broken.
        """
        if name not in self._measures:
            component = self._found("measure", name)
            if component.id not in self._measures:
                spec = cast(MeasureSpec, component.spec)
                self._measures[component.id] = FoundMeasure(
                    id=component.id,
                    function=_named_on_failure(component, component.load()),
                    keep=spec.keep,
                    requires=spec.requires,
                )
            self._measures[name] = self._measures[component.id]
        return self._measures[name]

    def field(self, name: str) -> FoundField:
        """The field of a name.

        Raises
        ------
        UsageError
            No installed bundle has it, or several have; names the nearest.
        PluginError
            Its bundle is broken.
        """
        if name not in self._fields:
            component = self._found("field", name)
            if component.id not in self._fields:
                function = component.load()
                self._fields[component.id] = FoundField(
                    id=component.id,
                    source=f"{component.distribution} {component.spec.target}",
                    function=_named_on_failure(component, function),
                    requires=cast(FieldSpec, component.spec).requires,
                    defaults=_defaults(function),
                )
            self._fields[name] = self._fields[component.id]
        return self._fields[name]

    def _found(self, kind: Kind, name: str) -> Component:
        return (registry() if self._source is None else self._source).find(kind, name)


def _defaults(function: Callable[..., Any]) -> dict[str, Any]:
    """The defaults of a field's own parameters; none where it does not show its signature."""
    try:
        parameters = inspect.signature(function).parameters
    except (TypeError, ValueError):
        return {}
    return {
        name: one.default
        for name, one in parameters.items()
        if one.kind is one.KEYWORD_ONLY and one.default is not one.empty
    }


def _named_on_failure(component: Component, function: Callable[..., Any]) -> Callable[..., Any]:
    """The function of a component, which is named where it fails, whoever had asked for it."""

    def called(subject: Any, /, **parameters: Any) -> Any:
        with component.guard():
            return function(subject, **parameters)

    return called
