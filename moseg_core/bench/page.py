"""A benchmark to look at: tables, and each result beside two people's segmentations.

One HTML file, with its pictures in a folder beside it and nothing from elsewhere. The worst
agreement comes first, since that is what there is to learn from.
"""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from pathlib import Path
from urllib.parse import quote

import numpy as np

from moseg_core.bench.cases import Case, Row
from moseg_core.bench.tables import Printed
from moseg_core.components.protocols import Report
from moseg_core.io import load, read_labels, write_file
from moseg_core.types import IntArray
from moseg_core.view.picture import render_picture

_SIZE = (700, 350)
_STYLE = """
body { font: 15px/1.4 sans-serif; margin: 2em; color: #222 }
table { border-collapse: collapse; margin: 1em 0 2em }
td, th { padding: .2em .8em; text-align: right; border-bottom: 1px solid #ddd }
td:first-child, th:first-child { text-align: left }
figure { margin: 2em 0 }
figure div { display: flex; flex-wrap: wrap }
img { width: 33%; min-width: 20em }
"""


def draw_case(
    case: Case, labels: IntArray, folder: Path, *, report: Report | None = None
) -> list[str]:
    """Draw a result and the first two people's segmentations of its model.

    Parameters
    ----------
    case : Case
        A search.
    labels : (F,) int
        What it found.
    folder : Path
        Where the pictures go; those of people that are there already stay.
    report : callable, optional
        Not used: a picture is quick.

    Returns
    -------
    list of str
        Names of the files, the result's first.
    """
    assert case.recipe is not None  # a search has one
    shape = load(case.model.mesh)
    own = f"{case.key}.png"
    title = f"{case.model.number}, {case.recipe.name}, {case.method}, seed {case.seed}"
    leaves = case.recipe.hierarchy().labels
    picture = render_picture(shape.geometry, labels, leaves, title=title, size=_SIZE)
    write_file(folder / own, picture)
    names = [own]
    for k, path in enumerate(case.model.people[:2]):
        name = f"{case.model.number}-person-{k + 1}.png"
        if not (folder / name).exists():
            _, parts = np.unique(read_labels(path, shape.n_elements).labels, return_inverse=True)
            words = [f"part {number + 1}" for number in range(int(parts.max()) + 1)]
            title = f"{case.model.number}, person {k + 1}"
            drawn = render_picture(shape.geometry, parts, words, title=title, size=_SIZE)
            write_file(folder / name, drawn)
        names.append(name)
    return names


def write_page(
    path: Path,
    *,
    title: str,
    tables: Sequence[Printed],
    failed: Sequence[str],
    rows: Sequence[Row],
    pictures: Mapping[Row, Sequence[str]],
) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
    title : str
    tables : sequence of Printed
    failed : sequence of str
        Lines about cases that failed.
    rows : sequence of Row
        In any order.
    pictures : mapping of Row to sequence of str
        For the rows to show, paths relative to the page.
    """
    lines = [
        "<!doctype html>",
        f'<html lang="en"><meta charset="utf-8"><title>{html.escape(title)}</title>',
        f"<style>{_STYLE}</style><h1>{html.escape(title)}</h1>",
    ]
    for table in tables:
        lines += [f"<h2>{html.escape(table.title)}</h2><table>", _cells("th", table.heads)]
        lines += [_cells("td", cells) for cells in table.rows]
        lines.append("</table>")
    if failed:
        lines += ["<h2>Failed</h2><ul>", *(f"<li>{html.escape(line)}" for line in failed), "</ul>"]
    shown = [row for row in rows if row in pictures]
    if shown:
        lines.append("<h2>Results beside two people's segmentations, worst first</h2>")
    for row in sorted(shown, key=lambda row: -(row.rand_index_error or 0.0)):
        words = f"{row.category} {row.model}, {row.recipe}, {row.method}, seed {row.seed}"
        words += f": 1-RI {row.rand_index_error:.3f}, cost {row.cost:.4g}"
        if row.named_right is not None:
            words += f", named right {row.named_right:.1%}"
        lines.append(f"<figure><figcaption>{html.escape(words)}</figcaption><div>")
        lines += [f'<img src="{quote(name)}" alt="">' for name in pictures[row]]
        lines.append("</div></figure>")
    write_file(path, "\n".join([*lines, "</html>", ""]).encode())


def _cells(tag: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"
