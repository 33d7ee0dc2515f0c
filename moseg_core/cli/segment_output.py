"""What ``moseg segment`` says of its result: tables, or the same as JSON, and what to do next."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from moseg_core.cli.console import console, print_terms
from moseg_core.io.result_json import evaluation_document
from moseg_core.search.number_of_parts import TRIED
from moseg_core.search.result import Result
from moseg_core.search.variants import tried_sets


def summary(result: Result) -> dict[str, Any]:
    """What a result came to, as plain data."""
    return {
        "shape": result.shape.name,
        "elements": result.shape.n_elements,
        **evaluation_document(result.evaluation),
        "parts": [
            {
                "label": name,
                "elements": part.n_elements,
                "area_share": part.area / result.shape.area,
            }
            for name, part in result.parts.items()
        ],
        "dimension": {"free": result.dimension[0], "all": result.dimension[1]},
        **({"numbers": list(result.history[TRIED])} if TRIED in result.history else {}),
        **({"label_sets": sets} if (sets := tried_sets(result.history)) else {}),
        "seed": result.seed,
        "reason": result.reason,
        "warnings": list(result.warnings),
    }


def print_tables(result: Result) -> None:
    """Print what was tried, the parts and the terms of a result."""
    out = console(sys.stdout)
    if TRIED in result.history:
        out.print(_numbers_table(result.history[TRIED]))
        out.print()
    if sets := tried_sets(result.history):
        out.print(_sets_table(sets))
        out.print()
    parts = Table(box=None, pad_edge=False, header_style="bold")
    parts.add_column("part")
    parts.add_column(f"{result.shape.noun}s", justify="right")
    parts.add_column("volume" if result.shape.solid else "area", justify="right")
    for name, part in result.parts.items():
        share = part.area / result.shape.area
        parts.add_row(name, str(part.n_elements), f"{100 * share:.1f} %")
    out.print(parts)
    out.print()
    print_terms(result.evaluation)


def next_step(shape: Path, written: Sequence[Path]) -> str:
    """What a user may do next with the files that were written; logs need not know.

    Examples
    --------
    >>> next_step(Path("horse.off"), [Path("a.glb"), Path("horse.json")])
    'next: moseg view horse.off horse.json; moseg explain horse.json'
    >>> next_step(Path("horse.off"), [Path("a.png")])
    'next: with -o result.json the result is kept, to be looked at, explained and gone on from'
    """
    kept = next((file for file in written if file.suffix.lower() == ".json"), None)
    if kept is None:
        return (
            "next: with -o result.json the result is kept, to be looked at, explained and gone on"
            " from"
        )
    result = shlex.quote(str(kept))
    return f"next: moseg view {shlex.quote(str(shape))} {result}; moseg explain {result}"


def _sets_table(sets: Mapping[str, Mapping[str, float]]) -> Table:
    """What each label set that was tried came to."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("labels", overflow="fold")
    for heading in ("typical cost", "cost", "empty", ""):
        table.add_column(heading, justify="right")
    for text, record in sets.items():
        empty = f"{record['empty']}" if record["empty"] else ""
        brief = "" if record.get("finalist", 1) else "brief search"
        costs = [f"{record[key]:.6f}" for key in ("typical cost", "cost")]
        table.add_row(text, *costs, empty, brief)
    return table


def _numbers_table(records: Sequence[Mapping[str, float]]) -> Table:
    """What each number of parts that was tried came to."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("number of parts", "cost", "empty"):
        table.add_column(heading, justify="right")
    for record in records:
        empty = f"{record['empty']}" if record["empty"] else ""
        table.add_row(f"{record['parts']}", f"{record['cost']:.6f}", empty)
    return table
