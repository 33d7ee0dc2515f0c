"""A benchmark's rows summed up: how well methods agree with people, and what people cost.

As in Chen et al. 2009 (doi:10.1145/1531326.1531379), a model's number is the mean over its
people, here also over seeds; a category's the mean over its models; the last line is the mean over
categories. Cases that failed are left out and counted.

The second table asks about the *recipe*. Where people's parts cost more than what was found, the
recipe wants something else than people do; where they cost less, the search missed it.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from moseg_core.bench.cases import COSTS, KMEANS, PEOPLE, Row

Cells = list[str]


@dataclass(frozen=True)
class Printed:
    """A table ready to print.

    Parameters
    ----------
    title : str
    heads : list of str
    rows : list of list of str
    """

    title: str
    heads: Cells
    rows: list[Cells]


def all_tables(rows: Sequence[Row], categories: Sequence[str]) -> list[Printed]:
    """The tables of a report that have something to say."""
    return [table for table in (agreement_table(rows, categories), cost_table(rows)) if table.rows]


def mean_by_model(rows: Sequence[Row], value: Callable[[Row], float | None]) -> dict[int, float]:
    """For each model the mean over its rows, of those that have the value."""
    found: dict[int, list[float]] = {}
    for row in rows:
        number = value(row)
        if number is not None:
            found.setdefault(row.model, []).append(number)
    return {model: statistics.fmean(numbers) for model, numbers in found.items()}


def agreement_table(rows: Sequence[Row], categories: Sequence[str]) -> Printed:
    """1 - Rand Index, names and seconds by category and method.

    Parameters
    ----------
    rows : sequence of Row
    categories : sequence of str
        In the order of the lines.
    """
    methods = list(dict.fromkeys(row.method for row in rows if row.method != COSTS))
    searches = [method for method in methods if method not in (PEOPLE, KMEANS)]
    heads = ["category", "models", *methods]
    for method in searches:
        heads += [f"{method}: named right", f"{method}: seconds", f"{method}: failed"]
    lines: list[list[float | None]] = []
    printed: list[Cells] = []
    for category in categories:
        mine = [row for row in rows if row.category == category]
        if not mine:
            continue
        by_method = {m: [row for row in mine if row.method == m] for m in methods}
        numbers = [_mean(by_method[m], lambda row: row.rand_index_error) for m in methods]
        failed: list[str] = []
        for method in searches:
            numbers.append(_mean(by_method[method], lambda row: row.named_right))
            numbers.append(_mean(by_method[method], lambda row: row.seconds))
            failures = sum(bool(row.failure) for row in by_method[method])
            failed.append(f"{failures} of {len(by_method[method])}" if failures else "")
        lines.append(numbers)
        printed.append(_line(category, len({row.model for row in mine}), numbers, methods, failed))
    if len(lines) > 1:
        means = [
            statistics.fmean(known) if (known := [v for v in column if v is not None]) else None
            for column in zip(*lines, strict=True)
        ]
        models = len({row.model for row in rows})
        printed.append(_line("mean", models, means, methods, [""] * len(searches)))
    return Printed("1 - Rand Index (0 is best), area named right, seconds", heads, printed)


def _mean(rows: Sequence[Row], value: Callable[[Row], float | None]) -> float | None:
    known = mean_by_model(rows, value)
    return statistics.fmean(known.values()) if known else None


def _line(
    name: str,
    models: int,
    numbers: Sequence[float | None],
    methods: Sequence[str],
    failed: Sequence[str],
) -> Cells:
    cells = [name, str(models), *(_number(value, ".3f") for value in numbers[: len(methods)])]
    for k, text in enumerate(failed):
        named, seconds = numbers[len(methods) + 2 * k : len(methods) + 2 * k + 2]
        cells += [_number(named, ".1%"), _number(seconds, ".1f"), text]
    return cells


def _number(value: float | None, style: str) -> str:
    return "" if value is None else format(value, style)


def cost_table(rows: Sequence[Row]) -> Printed:
    """What people's parts and found ones cost under the recipe, model by model.

    Parameters
    ----------
    rows : sequence of Row
    """
    searches = list(
        dict.fromkeys(row.method for row in rows if row.method not in (PEOPLE, KMEANS, COSTS))
    )
    heads = ["category", "recipe", "model", "named parts", "people", "people below"]
    heads += [f"{method}: found" for method in searches] + ["verdict"]
    printed: list[Cells] = []
    for row in (row for row in rows if row.method == COSTS):
        same = [o for o in rows if o.model == row.model and o.recipe == row.recipe]
        found = [
            [o.cost for o in same if o.method == method and o.cost is not None and not o.empty]
            for method in searches
        ]
        least = min((cost for costs in found for cost in costs), default=None)
        people = sorted(row.people)
        whole = row.cost if row.cost is not None and not row.empty else None
        span = f"{people[0]:.3g} to {people[-1]:.3g} ({len(people)})" if people else ""
        if row.incomplete:
            span += f"{', ' if span else ''}{row.incomplete} lack a part"
        below = "" if least is None or not people else str(sum(cost < least for cost in people))
        cells = [row.category, row.recipe, str(row.model), _number(whole, ".4g"), span, below]
        cells += [_spread(costs) for costs in found]
        printed.append([*cells, row.failure or verdict(whole, people, least)])
    return Printed("Cost of people's parts beside the cost found", heads, printed)


def _spread(costs: Sequence[float]) -> str:
    """The median of several costs, and the least and greatest."""
    if not costs:
        return ""
    median = f"{statistics.median(costs):.4g}"
    return median if len(costs) == 1 else f"{median} ({min(costs):.3g} to {max(costs):.3g})"


def verdict(named: float | None, people: Sequence[float], found: float | None) -> str:
    """What to work on, from the least cost found and the costs of people's parts.

    Parameters
    ----------
    named : float or None
        Cost of the named parts.
    people : sequence of float
    found : float or None

    Returns
    -------
    str
        "recipe" where all people's parts cost more than what was found, "search" where all cost
        less, "both" in between; empty where one of the two is missing.

    Examples
    --------
    >>> verdict(8.1, [7.9, 9.0], 6.5), verdict(8.1, [7.9, 9.0], 9.5), verdict(None, [], 1.0)
    ('recipe', 'search', '')
    """
    given = [*people, *([] if named is None else [named])]
    if found is None or not given:
        return ""
    above = [cost > found for cost in given]
    if all(above):
        return "recipe"
    return "both" if any(above) else "search"


def failures(rows: Sequence[Row]) -> list[str]:
    """A line for each case that failed, with its reason."""
    return [
        f"{row.category} {row.model}, {row.method}{f', seed {row.seed}' if row.seed else ''}:"
        f" {row.failure}"
        for row in rows
        if row.failure
    ]
