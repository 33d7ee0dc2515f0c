"""``moseg evaluate``: how well a labelling agrees with true ones."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from moseg_core.cli.console import console, message, print_json
from moseg_core.errors import UsageError
from moseg_core.io import load, read_labels
from moseg_core.metrics import fold, named_right, rand_index_error


def run_evaluate(path: Path, result: Path, truths: Sequence[Path], *, as_json: bool) -> None:
    """Compare and print one row per truth, and their mean."""
    if not truths:
        raise UsageError("evaluate takes a shape, a result and at least one true labelling")
    shape = load(path)
    found = read_labels(result, shape.n_elements)
    rows: list[dict[str, Any]] = []
    for truth in truths:
        true = read_labels(truth, shape.n_elements)
        named = None
        if found.names is not None and true.names is not None:
            if not {fold(name) for name in found.names} & {fold(name) for name in true.names}:
                message(f"{result.name} and {truth.name} have no names in common")
            named = named_right(found.labels, found.names, true.labels, true.names, shape.areas)
        rows.append(
            {
                "truth": str(truth),
                "rand_index_error": rand_index_error(found.labels, true.labels),
                "rand_index_error_by_area": rand_index_error(
                    found.labels, true.labels, shape.areas
                ),
                "named_right": named,
            }
        )
    mean: dict[str, Any] = {"truth": "mean"}
    for key in ("rand_index_error", "rand_index_error_by_area", "named_right"):
        values = [row[key] for row in rows if row[key] is not None]
        mean[key] = sum(values) / len(values) if values else None
    if as_json:
        print_json({"truths": rows, "mean": {k: v for k, v in mean.items() if k != "truth"}})
        return
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("truth", overflow="fold")
    for heading in ("1-RI by faces", "1-RI by area", "area named right"):
        table.add_column(heading, justify="right")
    for row in [*rows, mean] if len(rows) > 1 else rows:
        named = row["named_right"]
        table.add_row(
            row["truth"],
            f"{row['rand_index_error']:.4f}",
            f"{row['rand_index_error_by_area']:.4f}",
            "no names" if named is None else f"{100 * named:.1f} %",
        )
    console(sys.stdout).print(table)
