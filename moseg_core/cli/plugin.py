"""``moseg plugin``: what is installed, and what is wrong with it. Imports no component."""

from __future__ import annotations

import json
import sys
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from moseg_core.plugins import Bundle, registry


def run_list(*, as_json: bool) -> None:
    """Print bundles, versions, components and problems."""
    bundles = registry().bundles
    if as_json:
        print(json.dumps([_document(bundle) for bundle in bundles], indent=2))
        return
    out = Console(file=sys.stdout, width=None if sys.stdout.isatty() else 120, highlight=False)
    for bundle in bundles:
        name, rest = Text(bundle.name, "bold"), f"  {bundle.distribution} {bundle.version}"
        out.print(name.append(rest, "not bold"))
        if bundle.problem:
            out.print(f"  set aside: {bundle.problem}", style="red", markup=False)
        if bundle.note:
            out.print(f"  note: {bundle.note}", style="yellow", markup=False)
        table = Table(box=None, pad_edge=False, show_header=False)
        for component in bundle.components:
            table.add_row(f"  {component.kind}", component.id, Text(component.spec.summary))
        if bundle.components:
            out.print(table)
        out.print()


def _document(bundle: Bundle) -> dict[str, Any]:
    return {
        "name": bundle.name,
        "distribution": bundle.distribution,
        "version": bundle.version,
        "module": bundle.module,
        "contract": bundle.contract,
        "note": bundle.note,
        "problem": bundle.problem,
        "components": [
            {
                "kind": component.kind,
                "id": component.id,
                "target": component.spec.target,
                "summary": component.spec.summary,
            }
            for component in bundle.components
        ],
    }
