"""What there is to say of a component, from the one place where it is declared: its code.

The docstring, in numpydoc's form, says what it does; the signature which parameters it has, with
their bounds and defaults (:mod:`moseg_core.components.parameters`); an objective's traits its range
and what it needs. ``moseg plugin explain`` prints it, ``tools/make_component_docs.py`` makes the
page ``docs/components.md`` of it. Neither repeats anything by hand.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from moseg_core.components.discovery.registry import Component
from moseg_core.components.objectives import Traits
from moseg_core.components.parameters import PROVIDED, Parameter, declared_parameters
from moseg_core.errors import PluginError
from moseg_core.language import Table, Target
from moseg_core.language.terms import format_value

#: Kinds whose targets take parameters.
_WITH_PARAMETERS = (
    "objective",
    "measure",
    "field",
    "parameterization",
    "seeder",
    "labeler",
    "optimizer",
    "refiner",
    "constraint",
    "embedding",
    "learner",
)


@dataclass(frozen=True, kw_only=True)
class Explained:
    """What a component says of itself.

    Parameters
    ----------
    component : Component
    headline : str
        First line of the docstring, or the summary of the spec.
    body : str
        What comes between the headline and the first section.
    sections : mapping of str to str
        The docstring's sections by title: "Returns", "Notes", ...
    about : str
        The docstring of the module: its idea and where it comes from.
    parameters : tuple of Parameter
    said : mapping of str to str
        For the name of a parameter what the docstring says of it.
    traits : Traits or None
        Of an objective: range, requirements, invariances, cost.
    """

    component: Component
    headline: str
    body: str = ""
    sections: Mapping[str, str] = field(default_factory=dict)
    about: str = ""
    parameters: tuple[Parameter, ...] = ()
    said: Mapping[str, str] = field(default_factory=dict)
    traits: Traits | None = None


def explain_component(component: Component) -> Explained:
    """Load a component and read what it says of itself.

    Parameters
    ----------
    component : Component

    Raises
    ------
    PluginError
        It cannot be loaded, or its parameters cannot be read.

    Examples
    --------
    >>> from moseg_core.components.discovery.registry import registry
    >>> found = explain_component(registry().find("seeder", "kmeans"))
    >>> rounds = found.parameters[0]
    >>> rounds.name, rounds.default, str(rounds.interval), found.said["rounds"]
    ('rounds', 100, '1 or more', 'Most rounds to run.')
    """
    target = component.load()
    if component.kind == "recipe" or not callable(target):
        return Explained(component=component, headline=component.spec.summary)
    headline, body, sections = read_docstring(getattr(target, "__doc__", None) or "")
    module = sys.modules.get(component.spec.target.partition(":")[0])
    traits = getattr(target, "traits", None)
    return Explained(
        component=component,
        headline=headline or component.spec.summary,
        body=body,
        sections=sections,
        about=inspect.cleandoc(getattr(module, "__doc__", None) or ""),
        parameters=_parameters(component, target),
        said=read_entries(sections.get("Parameters", "")),
        traits=traits if isinstance(traits, Traits) else None,
    )


def _parameters(component: Component, target: Callable[..., Any]) -> tuple[Parameter, ...]:
    if component.kind not in _WITH_PARAMETERS:
        return ()
    own = getattr(target, "parameters", None)  # of objectives, and of functions as constraints
    if isinstance(own, tuple):
        return own
    try:
        return declared_parameters(target, reserved=PROVIDED.get(component.kind, ()))
    except TypeError as error:
        raise PluginError(f"{component.who} cannot be explained: {error}") from error


def read_docstring(text: str) -> tuple[str, str, dict[str, str]]:
    r"""(headline, body, sections by title) of a numpydoc docstring.

    Examples
    --------
    >>> read_docstring("What it is.\n\n    More.\n\n    Notes\n    -----\n    Known.\n    ")
    ('What it is.', 'More.', {'Notes': 'Known.'})
    """
    pieces = re.split(r"^(\w[\w ]*)\n-{3,}\n", inspect.cleandoc(text), flags=re.MULTILINE)
    headline, _, body = pieces[0].partition("\n\n")
    titles, texts = pieces[1::2], pieces[2::2]
    sections = {title: text.strip() for title, text in zip(titles, texts, strict=True)}
    return " ".join(headline.split()), body.strip(), sections


def read_entries(section: str) -> dict[str, str]:
    r"""What a section "Parameters" says of each name; of several on a line the same.

    Examples
    --------
    >>> read_entries("low, high : float\n    Bounds.\nn : int")
    {'low': 'Bounds.', 'high': 'Bounds.', 'n': ''}
    """
    found: dict[str, str] = {}
    names: list[str] = []
    for line in section.splitlines():
        if line and not line[0].isspace():
            names = [name.strip(" *") for name in line.partition(" :")[0].split(",")]
            found.update(dict.fromkeys(names, ""))
        else:
            for name in names:
                found[name] = f"{found[name]} {line.strip()}".strip()
    return found


def bounds(parameter: Parameter) -> str:
    """What is allowed, in words.

    Examples
    --------
    >>> from moseg_core.components.parameters import Interval
    >>> bounds(Parameter(name="n", type=int, interval=Interval(1), optional=True))
    'whole number, 1 or more, or none'
    """
    kinds = {
        int: "whole number",
        float: "number",
        bool: "0 or 1",
        str: "text",
        Target: "a target such as 0.06+-0.02",
        Table: "a table of the recipe, by its name",
    }
    words = kinds[parameter.type]
    if str(parameter.interval) != "any number":
        value = " its value" if parameter.type is Target else ""
        words += f",{value} {parameter.interval}"
    return f"{words}, or none" if parameter.optional else words


def default(parameter: Parameter) -> str:
    """The default, as one would write it.

    Examples
    --------
    >>> default(Parameter(name="n", type=float, default=1e-6))
    '1e-06'
    >>> default(Parameter(name="n", type=bool, default=True))
    '1'
    """
    if parameter.required:
        return "must be given"
    if parameter.default is None:
        return "none"
    if parameter.type in (str, Target):
        return format_value(parameter.default)
    if parameter.type is Table:
        return "a table of the component's own"
    return f"{parameter.default:g}"


def span(traits: Traits) -> str:
    """The range of an objective, in words.

    Examples
    --------
    >>> span(Traits(arity="unary", range=(0, 1))), span(Traits(arity="global"))
    ('0 to 1', 'any number')
    """
    low, high = (f"{end:g}".replace("inf", "infinity") for end in traits.range)
    return "any number" if (low, high) == ("-infinity", "infinity") else f"{low} to {high}"


def plain(text: str) -> str:
    """Text of a docstring without its marks for code and names.

    Examples
    --------
    >>> plain("``s1``, see :func:`moseg_core.load` and :class:`~moseg_core.Part`")
    's1, see moseg_core.load and moseg_core.Part'
    """
    return re.sub(r":\w+:`~?([^`]+)`", r"\1", text).replace("`", "")
