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

from moseg_benchmark.cases import BenchmarkCase, CaseResult, all_leaves
from moseg_benchmark.label_matching import IntArray
from moseg_benchmark.tables import Table
from moseg_core import Recipe, load, read_labels, render_picture, write_file

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


def draw_case(case: BenchmarkCase, recipe: Recipe, labels: IntArray, folder: Path) -> list[str]:
    """Draw a result and the first two people's segmentations of its model.

    Parameters
    ----------
    case : BenchmarkCase
        A search.
    recipe : Recipe
        With which it was done.
    labels : (F,) int
        What it found.
    folder : Path
        Where the pictures go; those of people that are there already stay.

    Returns
    -------
    list of str
        Names of the files, the result's first.
    """
    shape = load(case.model.mesh)
    title = f"{case.model.number}, {recipe.name}, {case.method}, seed {case.seed}"
    leaves = all_leaves(recipe)
    picture = render_picture(shape.geometry, labels, leaves, title=title, size=_SIZE, up=shape.up)
    names = [f"{case.key}.png"]
    write_file(folder / names[0], picture)
    for k, path in enumerate(case.model.people[:2]):
        name = f"{case.model.number}-person-{k + 1}.png"
        if not (folder / name).exists():
            _, parts = np.unique(read_labels(path, shape, fill=True).labels, return_inverse=True)
            words = [f"part {number + 1}" for number in range(int(parts.max()) + 1)]
            title = f"{case.model.number}, person {k + 1}"
            drawn = render_picture(
                shape.geometry, parts, words, title=title, size=_SIZE, up=shape.up
            )
            write_file(folder / name, drawn)
        names.append(name)
    return names


def write_page(
    path: Path,
    *,
    title: str,
    tables: Sequence[Table],
    failed: Sequence[str],
    results: Sequence[CaseResult],
    pictures: Mapping[CaseResult, Sequence[str]],
) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
    title : str
    tables : sequence of Table
    failed : sequence of str
        Lines about cases that failed.
    results : sequence of CaseResult
        In any order.
    pictures : mapping of CaseResult to sequence of str
        For the results to show, paths relative to the page.
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
    shown = [result for result in results if result in pictures]
    if shown:
        lines.append("<h2>Results beside two people's segmentations, worst first</h2>")
    for result in sorted(shown, key=lambda result: -(result.rand_index_error or 0.0)):
        words = f"{result.category} {result.model}, {result.recipe}, {result.method}"
        words += f", seed {result.seed}: 1-RI {result.rand_index_error:.3f}"
        words += f", cost {result.cost:.4g}"
        if result.named_right is not None:
            words += f", named right {result.named_right:.1%}"
        lines.append(f"<figure><figcaption>{html.escape(words)}</figcaption><div>")
        lines += [f'<img src="{quote(name)}" alt="">' for name in pictures[result]]
        lines.append("</div></figure>")
    write_file(path, "\n".join([*lines, "</html>", ""]).encode())


def _cells(tag: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"
