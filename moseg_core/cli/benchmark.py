"""``moseg benchmark``: how well results agree with people, over a collection of shapes."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from moseg_core.bench.cases import Row
from moseg_core.bench.psb import CATEGORIES, check_category, find_models
from moseg_core.bench.run import Request, run_benchmark
from moseg_core.bench.tables import Printed, all_tables, failures
from moseg_core.cli.console import console, message
from moseg_core.errors import UsageError
from moseg_core.problem.recipe import Recipe, load_recipe
from moseg_core.problem.settings import SearchOptions
from moseg_core.search.levels import check_hierarchy
from moseg_core.search.workers import available_workers

_USUAL = ("Fourleg=horse",)


def run_psb(
    data: Path,
    *,
    categories: Sequence[str],
    recipes: Sequence[str],
    settings: str,
    seeds: str,
    workers: int | None,
    resume: bool,
    out: Path,
    quiet: bool,
) -> None:
    """Check the request, measure, print the tables."""
    chosen = tuple(check_category(name) for name in categories)
    given = read_recipes(recipes or _USUAL)
    for category in given if recipes and chosen else ():
        if category not in chosen:
            raise UsageError(
                f"--recipe-for {category} has nothing to do: --category asks for"
                f" {', '.join(chosen)} only"
            )
    names = [name.strip() for name in settings.split(",")]
    for name in names:
        SearchOptions(settings=name)
    request = Request(
        models=find_models(data, chosen),
        recipes=given,
        settings=list(dict.fromkeys(names)),
        seeds=read_seeds(seeds),
    )
    processes = available_workers() if workers is None else SearchOptions(workers=workers).workers
    if out.exists() and not out.is_dir():
        raise UsageError(f"'{out}' is a file; the report needs a folder")
    if not out.parent.is_dir():
        raise UsageError(f"cannot write to '{out}': there is no folder '{out.parent}'")

    def show(done: int, of: int, row: Row) -> None:
        words = [f"[{done}/{of}] {row.category} {row.model} {row.method} seed {row.seed}"]
        if row.rand_index_error is not None:
            words.append(f"1-RI {row.rand_index_error:.3f}")
        if row.cost is not None:
            words.append(f"cost {row.cost:.4g}")
        if row.seconds is not None:
            words.append(f"{row.seconds:.1f} s")
        if row.failure:
            words.append(row.failure)
        message(", ".join(words), quiet=quiet)

    rows = run_benchmark(request, out, workers=processes, resume=resume, show=show)
    for table in all_tables(rows, CATEGORIES):
        _print(table)
    for line in failures(rows):
        message(f"failed: {line}")
    message(f"wrote {out / 'index.html'} and {out / 'report.json'}", quiet=quiet)


def read_recipes(words: Sequence[str]) -> dict[str, Recipe]:
    """Recipes by category, from words such as ``Fourleg=horse``.

    Raises
    ------
    UsageError
        A word of another form, or an unknown category, recipe, objective or component.
    """
    found = {}
    for word in words:
        category, equals, name = word.partition("=")
        if not equals or not name:
            raise UsageError(
                f"'--recipe-for {word}' is not understood; write --recipe-for Fourleg=horse"
            )
        recipe = load_recipe(name.strip())
        check_hierarchy(recipe.hierarchy(), SearchOptions())
        category = check_category(category)
        if category in found:
            raise UsageError(f"--recipe-for gives two recipes for {category}")
        found[category] = recipe
    return found


def read_seeds(text: str) -> list[int]:
    """Seeds from words such as ``0-2`` or ``0,5,7``.

    Raises
    ------
    UsageError
        Anything else.

    Examples
    --------
    >>> read_seeds("0-2,7")
    [0, 1, 2, 7]
    """
    seeds: list[int] = []
    for word in text.split(","):
        match = re.fullmatch(r"\s*([0-9]+)(?:-([0-9]+))?\s*", word)
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (1, 0)
        if last < first:
            raise UsageError(f"the seeds '{text}' are not understood; write 0-2 or 0,5,7")
        seeds += range(first, last + 1)
    return list(dict.fromkeys(seeds))


def _print(printed: Printed) -> None:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for k, head in enumerate(printed.heads):
        table.add_column(head, justify="left" if k == 0 else "right", overflow="fold")
    for cells in printed.rows:
        table.add_row(*cells)
    out = console(sys.stdout)
    out.print(printed.title)
    out.print(table)
    out.print()
