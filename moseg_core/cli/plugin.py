"""``moseg plugin``: what is installed, and what is wrong with it. Imports no component."""

from __future__ import annotations

import json
import shutil
import sys
import textwrap
from collections.abc import Iterator
from typing import Any

from rich.console import Console
from rich.text import Text

from moseg_core.components.discovery.registry import Bundle, registry
from moseg_core.untrusted.terminal import printable, printable_json

_WIDTH_OFF_TERMINAL = 120
#: Characters that a summary has on a line at least, however narrow the terminal.
_LEAST_ROOM = 20


def run_list(*, as_json: bool) -> None:
    """Print bundles, versions, components and problems."""
    bundles = registry().bundles
    if as_json:
        print(printable_json(json.dumps([_document(bundle) for bundle in bundles], indent=2)))
        return
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else _WIDTH_OFF_TERMINAL
    text = Text()
    for bundle in bundles:
        text.append(printable(bundle.name), "bold")
        text.append(printable(f"  {bundle.distribution} {bundle.version}") + "\n")
        if bundle.problem:
            text.append(printable(f"  set aside: {bundle.problem}") + "\n", "red")
        if bundle.note:
            text.append(printable(f"  note: {bundle.note}") + "\n", "yellow")
        rows = "".join(printable(row) + "\n" for row in _rows(bundle, width))
        text.append(rows + "\n")
    # Lines are laid out already: a rich table for each bundle takes longer than finding them all.
    Console(file=sys.stdout, highlight=False, markup=False, soft_wrap=True).print(text, end="")


def _rows(bundle: Bundle, width: int) -> Iterator[str]:
    """A line for each component, its columns aligned within the bundle; long summaries fold."""
    if not bundle.components:
        return
    kinds = max(len(component.kind) for component in bundle.components)
    ids = max(len(component.id) for component in bundle.components)
    for component in bundle.components:
        head = f"  {component.kind:{kinds}}  {component.id:{ids}}  "
        summary = component.spec.summary
        if len(head) + len(summary) <= width:
            yield (head + summary).rstrip()
            continue
        room = max(width - len(head), _LEAST_ROOM)
        for k, line in enumerate(textwrap.wrap(summary, room)):
            yield (head if k == 0 else " " * len(head)) + line


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
