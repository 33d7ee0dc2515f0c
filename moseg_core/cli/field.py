"""``moseg field``: what a field says of a shape, in numbers, in colours and in files."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.table import Table

from moseg_core.cli.console import console, message, print_json
from moseg_core.cli.flags import ShapeFlags
from moseg_core.cli.reading import read_shape
from moseg_core.cli.saving import check_distinct, raise_last
from moseg_core.cli.working_folder import working_folder_kept
from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.discovery.registry import registry
from moseg_core.components.field import FieldSummary, field_values
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import MosegError, UsageError, unknown
from moseg_core.io import write_file
from moseg_core.io.whole_file import check_destination
from moseg_core.io.write.field_files import encode_field
from moseg_core.problem.recipe import load_recipe
from moseg_core.view.field_picture import render_field

FORMATS = (".png", ".ply", ".npy", ".csv")


def run_field(
    source: Path,
    call: str,
    *,
    recipe: str | None,
    reading: ShapeFlags,
    outputs: Sequence[Path],
    as_json: bool,
) -> None:
    """Compute a field, print its mean and extremes, write what is asked for."""
    for path in outputs:
        if path.suffix.lower() not in FORMATS:
            asked = unknown("suffix", path.suffix, FORMATS) if path.suffix else "no suffix"
            raise UsageError(f"a field is written as {', '.join(FORMATS)}: {asked}, in '{path}'")
        check_destination(path)
    check_distinct(outputs, read=[source], what="the field")
    choice = Choice.read(call, "field")
    tables = None if recipe is None else load_recipe(recipe).statement.given
    chosen = prepare(choice, "field", registry(), tables=tables)
    name, parameters = chosen.component.id, chosen.parameters
    shape = read_shape(source, reading)
    with working_folder_kept():
        values = field_values(shape, name, **parameters)
        whole = Segmentation.from_labels(shape, np.zeros(shape.n_elements, np.int32), 1)
        summary = whole.parts[0].field(name, **parameters)
    title = str(Choice(name, choice.parameters))  # tables by their names
    failures: list[MosegError] = []
    for path in outputs:
        format = path.suffix.lower()
        if format == ".png":
            data = render_field(
                shape.geometry,
                values,
                title=f"{title} on {shape.name}",
                mean=summary.mean,
                up=shape.up,
            )
        else:
            data = encode_field(shape, values, format.removeprefix("."))
        try:
            write_file(path, data)
        except MosegError as error:
            failures.append(error)
        else:
            message(f"wrote {path}")
    try:
        if as_json:
            print_json({"field": title, "elements": shape.n_elements, **summary._asdict()})
        else:
            console(sys.stdout).print(_table(title, shape.n_elements, shape.noun, summary))
    finally:  # also where nobody takes what is printed
        raise_last(failures)


def _table(title: str, count: int, noun: str, summary: FieldSummary[float]) -> Table:
    table = Table(title=f"{title}: {count} {noun}s", box=None, pad_edge=False, title_justify="left")
    shown = ("least", "mean", "greatest", "spread")
    for name in shown:
        table.add_column(name, justify="right")
    table.add_row(*(f"{getattr(summary, name):.6g}" for name in shown))
    return table
