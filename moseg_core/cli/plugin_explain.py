"""``moseg plugin explain`` and ``moseg objectives NAME``: what a component does, in its words."""

from __future__ import annotations

import math
import re
import sys
import textwrap
from typing import Any

from rich.console import Console
from rich.table import Table

from moseg_core import language
from moseg_core.cli.console import cell, console, lines_of, print_json
from moseg_core.cli.recipes import read_shipped
from moseg_core.components.discovery.registry import Component, registry
from moseg_core.components.discovery.specs import (
    FieldSpec,
    Kind,
    MeasureSpec,
    ParameterizationSpec,
    Spec,
)
from moseg_core.components.explanation import (
    Explained,
    bounds,
    default,
    explain_component,
    plain,
    span,
)
from moseg_core.components.objectives import Traits
from moseg_core.errors import PluginError, UsageError, unknown

#: Sections of a docstring that are shown, under these titles.
_SHOWN = {"Returns": "value", "Raises": "raises", "Notes": "notes", "References": "references"}


def run_explain_plugin(name: str, *, as_json: bool, kind: Kind | None = None) -> None:
    """Print what is known of the components of a name, or of those of one kind."""
    found = [explain_component(component) for component in _named(name, kind)]
    if as_json:
        print_json([_document(explained) for explained in found])
        return
    out = console(sys.stdout)
    for explained in found:
        _print(explained, out)


def _named(name: str, kind: Kind | None) -> list[Component]:
    """The components of an id, one of each kind that has it; or of a name in one bundle.

    Raises
    ------
    UsageError
        None, with the nearest; or several bundles have the name, with their ids.
    PluginError
        The bundle that an id names is set aside.
    """
    known = registry()
    components = known.components(kind)
    found = [c for c in components if name in (c.id, c.spec.name)]
    if len({c.bundle for c in found}) > 1:
        ids = ", ".join(sorted({c.id for c in found}))
        raise UsageError(f"{kind or 'component'} '{name}' is ambiguous; say which: {ids}")
    if found:
        return found
    namespace = name.partition(":")[0]
    for bundle in known.bundles:
        if bundle.problem and bundle.name == namespace:
            raise PluginError(f"bundle '{bundle.name}' is set aside: {bundle.problem}")
    names = [c.id if ":" in name else c.spec.name for c in components]
    listed = f"moseg {kind}s" if kind else "moseg plugin list"
    raise UsageError(f"{unknown(kind or 'component', name, names)} (see '{listed}')")


def _print(explained: Explained, out: Console) -> None:
    component = explained.component
    head = cell(component.id, "bold").append(f"  {component.kind}", "not bold")
    out.print(head)
    _paragraph(component.spec.summary, out)
    if _words(explained.headline) != _words(component.spec.summary):
        _paragraph(explained.headline, out)
    _paragraph(explained.body, out)
    for section, title in _SHOWN.items():
        _paragraph(explained.sections.get(section, ""), out, title=title)
    if explained.parameters:
        out.print("parameters", style="bold")
        out.print(_parameter_table(explained))
        out.print()
    facts = Table(box=None, pad_edge=False, show_header=False)
    facts.add_column(style="bold", no_wrap=True)
    facts.add_column(overflow="fold")
    for key, value in _facts(explained).items():
        facts.add_row(key, value)
    out.print(facts)
    out.print()
    if explained.about and "Notes" not in explained.sections:
        _paragraph(explained.about, out, title="about")


def _words(line: str) -> list[str]:
    """What a line says, however it is set: many a docstring begins with the spec's summary."""
    return re.findall(r"\w+", line.lower())


def _paragraph(text: str, out: Console, *, title: str = "") -> None:
    if text:
        if title:
            out.print(title, style="bold")
        out.print(lines_of(textwrap.indent(plain(text), "  ")))
        out.print()


def _parameter_table(explained: Explained) -> Table:
    table = Table(box=None, pad_edge=False, show_header=False)
    for parameter in explained.parameters:
        table.add_row(
            f"  {parameter.name} = {default(parameter)}",
            bounds(parameter),
            plain(explained.said.get(parameter.name, "")),
        )
    return table


def _facts(explained: Explained) -> dict[str, str]:
    """What can be looked up, by what it is called."""
    component, traits = explained.component, explained.traits
    facts: dict[str, str] = {}
    if traits is not None:
        facts = {
            "takes": traits.takes,
            "range": span(traits),
            "needs": ", ".join(sorted(traits.requires)) or "nothing but the parts",
            "unchanged by": ", ".join(sorted(traits.invariant_to)) or "nothing is declared",
            "cost": traits.cost,
            **({"reads": fields} if (fields := _fields_of(traits)) else {}),
        }
        if traits.share is not None:
            facts["expects"] = "a share of the area, where its parameters tell which"
    if isinstance(component.spec, FieldSpec):
        facts = {
            "needs": ", ".join(component.spec.requires) or "nothing but the elements",
            "unchanged by": ", ".join(component.spec.invariant_to) or "nothing is declared",
            "to see it": f"moseg field SHAPE {component.id} -o picture.png",
        }
    if isinstance(component.spec, (MeasureSpec, ParameterizationSpec)):
        facts["needs"] = ", ".join(component.spec.requires) or "nothing of the shape"
    suffixes = getattr(component.spec, "suffixes", ())
    if suffixes:
        facts["files"] = " ".join(suffixes)
    if component.kind == "recipe":
        recipe, problem = read_shipped(component)
        if recipe is None:
            facts["cannot be used"] = str(problem)
        else:
            facts["labels"] = ", ".join(recipe.labels)
            if recipe.statement.variants:
                facts["variants"] = "; ".join(map(", ".join, recipe.statement.variants))
            number = " --parts 5" if recipe.statement.is_open else ""
            facts["to use it"] = f"moseg segment SHAPE --recipe {component.id}{number} -o x.png"
        facts["its text"] = f"moseg recipes {component.id}"
    if component.kind == "command":
        facts["its options"] = f"moseg {component.spec.name} --help"
    return facts | {"from": component.distribution, "target": component.spec.target}


def _document(explained: Explained) -> dict[str, Any]:
    component, traits = explained.component, explained.traits
    return {
        "id": component.id,
        "kind": component.kind,
        "summary": component.spec.summary,
        "distribution": component.distribution,
        "target": component.spec.target,
        "headline": explained.headline,
        "body": explained.body,
        "sections": dict(explained.sections),
        "about": explained.about,
        "parameters": [
            {
                "name": parameter.name,
                "type": parameter.type.__name__,
                "required": parameter.required,
                "optional": parameter.optional,
                "default": _plain(parameter.default),
                "low": _finite(parameter.interval.low),
                "high": _finite(parameter.interval.high),
                "says": explained.said.get(parameter.name, ""),
            }
            for parameter in explained.parameters
        ],
        "traits": None
        if traits is None
        else {
            "arity": traits.arity,
            "takes": traits.takes,
            "range": [_finite(end) for end in traits.range],
            "requires": sorted(traits.requires),
            "invariant_to": sorted(traits.invariant_to),
            "cost": traits.cost,
            "expects_share": traits.share is not None,
            "fields": _fields_of(traits),
        },
        **_of_field(component.spec),
    }


def _plain(value: Any) -> Any:
    """The value of a parameter as JSON can say it: a target as it is written."""
    if isinstance(value, language.Table):
        return value.document()
    return str(value) if isinstance(value, language.Target) else value


def _of_field(spec: Spec) -> dict[str, Any]:
    """What a spec says of a field, or requires of a shape; nothing of another component."""
    if isinstance(spec, (MeasureSpec, ParameterizationSpec)):
        return {"requires": list(spec.requires)}
    if not isinstance(spec, FieldSpec):
        return {}
    return {"requires": list(spec.requires), "invariant_to": list(spec.invariant_to)}


def _fields_of(traits: Traits) -> str:
    """Which fields an objective reads, in words; empty for none."""
    if callable(traits.fields):
        return "fields that depend on its parameters"
    return ", ".join(traits.fields)


def _finite(number: float) -> float | None:
    """The number, or None where it is infinite, which JSON cannot say."""
    return number if math.isfinite(number) else None
