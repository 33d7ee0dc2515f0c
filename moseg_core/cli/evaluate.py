"""``moseg evaluate``: how well a labelling agrees with true ones.

All measures of :mod:`moseg_core.agreement`, against each truth and on average over them, as the
benchmark averages over the people who cut a model; and, where both sides have names, what is
taken for what. A measure that is undefined for some truths is averaged over the others.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from moseg_core.agreement import (
    Agreement,
    Confusion,
    EdgeGraph,
    compare,
    confusion,
    fold,
    labelled,
    renamed,
)
from moseg_core.cli.console import console, lines_of, message, print_json
from moseg_core.cli.flags import ShapeFlags
from moseg_core.cli.reading import limits_of, read_label_property, read_shape
from moseg_core.errors import UsageError, nearest
from moseg_core.io import Labelling, read_labels
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape

#: Pairs of names that a table of what is taken for what has at most.
_MOST_PAIRS = 10**6
# Of each measure the heading, in two lines so that all fit beside each other in 100 columns.
_HEADINGS = {
    "rand_index_error": "1-RI\nfaces",
    "rand_index_error_by_area": "1-RI\narea",
    "cut_discrepancy": "\ncuts",
    "hamming": "\nHamming",
    "missing": "\nmissing",
    "false_alarm": "false\nalarm",
    "global_consistency_error": "GCE\nfaces",
    "global_consistency_error_by_area": "GCE\narea",
    "local_consistency_error": "LCE\nfaces",
    "local_consistency_error_by_area": "LCE\narea",
    "named_right": "named\nright",
}


def run_evaluate(
    path: Path,
    result: Path,
    truths: Sequence[Path],
    *,
    reading: ShapeFlags,
    rename: str | None,
    label_property: str | None,
    as_json: bool,
) -> None:
    """Compare and print one row per truth, their mean, and what is taken for what."""
    if not truths:
        raise UsageError("evaluate takes a shape, a result and at least one true labelling")
    translation = read_rename(rename)
    shape = read_shape(path, reading)
    found = _read(result, shape, label_property, reading)
    if translation and found.names is None:
        raise UsageError(f"{result.name} has no names of labels that --rename could replace")
    given = None if found.names is None else renamed(found.names, translation)
    true = [_read(truth, shape, label_property, reading) for truth in truths]
    for note in dict.fromkeys(note for labelling in (found, *true) for note in labelling.notes):
        message(note)
    for truth, labelling in zip(truths, true, strict=True):
        if not labelled(found.labels, labelling.labels).any():
            raise UsageError(
                f"no {shape.noun} has a label both in {result.name} and in {truth.name}; there is"
                " nothing to compare"
            )
    _warn_about_names(result, given, translation, truths, true)
    graph = _edge_graph(shape)
    agreements = [
        compare(
            found.labels,
            truth.labels,
            areas=shape.areas,
            graph=graph,
            names=found.names,
            truth_names=truth.names,
            rename=translation,
        )
        for truth in true
    ]
    tables = [_confusion(shape, found, truth, translation) for truth in true]
    if as_json:
        rows = [
            {"truth": str(name), **asdict(row), "confusion": _confusion_document(table)}
            for name, row, table in zip(truths, agreements, tables, strict=True)
        ]
        mean = {**_mean(agreements), "confusion": _confusion_document(_mean_confusion(tables))}
        print_json({"truths": rows, "mean": mean, "rename": translation})
        return
    out = console(sys.stdout)
    out.print(_measures_table(truths, agreements))
    together = _mean_confusion(tables)
    if together is not None:
        out.print()
        out.print("share of the area in %: what it is (rows) and what it is called (columns)")
        for block in _confusion_tables(together, out.width):
            out.print(block)


def _read(path: Path, shape: Shape, label_property: str | None, reading: ShapeFlags) -> Labelling:
    asked, limits = read_label_property(label_property), limits_of(reading)
    return read_labels(path, shape, label_property=asked, limits=limits)


def _edge_graph(shape: Shape) -> EdgeGraph | None:
    """The edges between the faces of a mesh; None of clouds and grids, on which cuts have none."""
    mesh = shape.geometry
    if not isinstance(mesh, PolygonMesh):
        return None
    return EdgeGraph.joined(
        mesh.vertices, mesh.merged, *mesh.edges, centroids=shape.points, areas=shape.areas
    )


def read_rename(text: str | None) -> dict[str, str]:
    """Translations of names from ``head=torso,arm->limb``.

    Raises
    ------
    UsageError
        A pair of another form, or two for one name.

    Examples
    --------
    >>> read_rename("head=torso, arm->limb")
    {'head': 'torso', 'arm': 'limb'}
    """
    found: dict[str, str] = {}
    for pair in [] if text is None else text.split(","):
        given, separator, true = pair.partition("->" if "->" in pair else "=")
        given, true = given.strip(), true.strip()
        if not separator or not given or not true:
            raise UsageError(
                f"'{pair}' in --rename is not understood; write --rename given=true,given=true"
                " ('given->true' needs quotes, for the shell)"
            )
        if found.setdefault(given, true) != true:
            raise UsageError(f"--rename turns '{given}' into '{found[given]}' and '{true}'")
    return found


def _warn_about_names(
    result: Path,
    given: Sequence[str] | None,
    translation: Mapping[str, str],
    truths: Sequence[Path],
    true: Sequence[Labelling],
) -> None:
    """Say on stderr where names can hardly be meant as they stand."""
    known = {fold(name) for labelling in true for name in labelling.names or ()}
    if given is None or not known:
        return
    # No error: a part may be missing in this model and its name right in others.
    for name in sorted({fold(name) for name in translation.values()} - known):
        guess = nearest(name, known)
        hint = f"; did you mean '{guess}'?" if guess is not None else ""
        message(f"--rename to '{name}', which is a name in no truth{hint}")
    for truth, labelling in zip(truths, true, strict=True):
        if labelling.names is not None and not set(given) & set(map(fold, labelling.names)):
            message(f"{result.name} and {truth.name} have no names in common")


def _mean(rows: Sequence[Agreement]) -> dict[str, float | None]:
    """Of each measure the mean over the truths for which it is defined."""
    mean: dict[str, float | None] = {}
    for field in fields(Agreement):
        values = [getattr(row, field.name) for row in rows]
        defined = [value for value in values if value is not None]
        mean[field.name] = sum(defined) / len(defined) if defined else None
    return mean


def _measures_table(truths: Sequence[Path], rows: Sequence[Agreement]) -> Table:
    # Files that lie in one folder are told apart by their names.
    distinct = len({truth.name for truth in truths}) == len(truths)
    names = [truth.name if distinct else str(truth) for truth in truths]
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column(lines_of("\ntruth"), overflow="fold")
    for heading in _HEADINGS.values():
        table.add_column(lines_of(heading), justify="right", no_wrap=True)
    for name, row in zip(names, rows, strict=True):
        table.add_row(name, *_cells(asdict(row)))
    if len(rows) > 1:
        table.add_section()
        table.add_row("mean", *_cells(_mean(rows)), style="bold")
    return table


def _cells(row: Mapping[str, float | None]) -> list[str]:
    cells = []
    for key in _HEADINGS:
        value = row[key]
        if value is None:
            cells.append("-")
        else:
            cells.append(f"{100 * value:.1f} %" if key == "named_right" else f"{value:.3f}")
    return cells


def _confusion(
    shape: Shape, found: Labelling, truth: Labelling, translation: Mapping[str, str]
) -> Confusion | None:
    if found.names is None or truth.names is None:
        return None
    if len(found.names) * len(truth.names) > _MOST_PAIRS:
        message(f"no table of {len(found.names)} names by {len(truth.names)}: nobody could read it")
        return None
    return confusion(
        found.labels, found.names, truth.labels, truth.names, shape.areas, rename=translation
    )


def _confusion_document(table: Confusion | None) -> dict[str, Any] | None:
    if table is None:
        return None
    return {
        "true_names": list(table.true_names),
        "given_names": list(table.given_names),
        "areas": table.areas.tolist(),
    }


def _mean_confusion(tables: Sequence[Confusion | None]) -> Confusion | None:
    """The mean over the truths with names; a name that one does not have has no area there."""
    known = [table for table in tables if table is not None]
    if not known:
        return None
    names = sorted({name for table in known for name in table.true_names})
    areas = np.zeros((len(names), len(known[0].given_names)))
    for table in known:
        areas[[names.index(name) for name in table.true_names]] += table.areas
    return Confusion(tuple(names), known[0].given_names, areas / len(known))


def _confusion_tables(confusion: Confusion, width: int) -> list[Table]:
    """The table in % of the area, in as many blocks of columns as the width asks for."""
    shares = 100.0 * confusion.areas / confusion.areas.sum()
    left = max(map(len, confusion.true_names))
    blocks: list[list[int]] = [[]]
    used = left
    for column, name in enumerate(confusion.given_names):
        wide = 2 + max(len(name), len("100.0"))
        if blocks[-1] and used + wide > width:
            blocks.append([])
            used = left
        blocks[-1].append(column)
        used += wide
    tables = []
    for block in blocks:
        table = Table(box=None, pad_edge=False, header_style="bold")
        table.add_column("")
        for column in block:
            table.add_column(confusion.given_names[column], justify="right")
        for name, row in zip(confusion.true_names, shares, strict=True):
            # What is nowhere called so is left blank, so that mistakes are seen.
            table.add_row(name, *(f"{row[c]:.1f}" if row[c] > 0 else "" for c in block))
        tables.append(table)
    return tables
