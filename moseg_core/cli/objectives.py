"""``moseg objectives``: the words that expressions are made of, and what one of them means.

The list imports no objective: what each is about and where it is small is the summary of its spec.
One of them is explained as by ``moseg plugin explain`` (:mod:`moseg_core.cli.plugin_explain`).
"""

from __future__ import annotations

import sys

from rich.table import Table

from moseg_core.cli.console import console, print_json
from moseg_core.components.discovery.registry import Component, registry

#: What summaries begin with, in the order of the list; others come last.
_ABOUT = ("one part", "two parts", "several parts", "all parts")


def run_objectives(name: str | None, *, as_json: bool) -> None:
    """Print the list, or all that is known of one objective."""
    if name is not None:
        from moseg_core.cli.plugin_explain import run_explain_plugin

        run_explain_plugin(name, kind="objective", as_json=as_json)
        return
    found = sorted(registry().components("objective"), key=_order)
    if as_json:
        print_json([_document(component) for component in found])
        return
    short = set(registry().names("objective"))
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("objective", "bundle", "about", "small where it is"):
        table.add_column(heading, overflow="fold")
    for component in found:
        called = component.spec.name if component.spec.name in short else component.id
        about, _, small = component.spec.summary.rpartition(": ")
        table.add_row(called, component.bundle, about, small)
    console(sys.stdout).print(table)


def _order(component: Component) -> tuple[int, str]:
    about = component.spec.summary.partition(": ")[0]
    return _ABOUT.index(about) if about in _ABOUT else len(_ABOUT), component.id


def _document(component: Component) -> dict[str, str]:
    return {
        "name": component.spec.name,
        "id": component.id,
        "bundle": component.bundle,
        "distribution": component.distribution,
        "summary": component.spec.summary,
    }
