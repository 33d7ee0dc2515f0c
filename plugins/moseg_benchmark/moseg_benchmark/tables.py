"""A benchmark's results summed up: how well methods agree with people, and what people cost.

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

from moseg_benchmark.cases import COSTS, KMEANS, PEOPLE, CaseResult

Cells = list[str]


@dataclass(frozen=True)
class Table:
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


def mean_by_model(
    results: Sequence[CaseResult], value: Callable[[CaseResult], float | None]
) -> dict[int, float]:
    """For each model the mean over its results, of those that have the value."""
    values: dict[int, list[float]] = {}
    for result in results:
        number = value(result)
        if number is not None:
            values.setdefault(result.model, []).append(number)
    return {model: statistics.fmean(numbers) for model, numbers in values.items()}


def agreement_table(results: Sequence[CaseResult], categories: Sequence[str]) -> Table:
    """1 - Rand Index, names and seconds by category and method.

    Parameters
    ----------
    results : sequence of CaseResult
    categories : sequence of str
        In the order of the lines.
    """
    methods = list(dict.fromkeys(result.method for result in results if result.method != COSTS))
    searches = [method for method in methods if method not in (PEOPLE, KMEANS)]
    heads = ["category", "models", *methods]
    for method in searches:
        heads += [f"{method}: named right", f"{method}: seconds", f"{method}: failed"]
    columns: list[list[float | None]] = []
    rows: list[Cells] = []
    for category in categories:
        of_category = [result for result in results if result.category == category]
        if not of_category:
            continue
        by_method = {m: [r for r in of_category if r.method == m] for m in methods}
        numbers = [_mean(by_method[m], lambda result: result.rand_index_error) for m in methods]
        failed: list[str] = []
        for method in searches:
            numbers.append(_mean(by_method[method], lambda result: result.named_right))
            numbers.append(_mean(by_method[method], lambda result: result.seconds))
            count = sum(bool(result.failure) for result in by_method[method])
            failed.append(f"{count} of {len(by_method[method])}" if count else "")
        columns.append(numbers)
        models = len({result.model for result in of_category})
        rows.append(_row(category, models, numbers, methods, failed))
    if len(columns) > 1:
        means = [
            statistics.fmean(known) if (known := [v for v in column if v is not None]) else None
            for column in zip(*columns, strict=True)
        ]
        models = len({result.model for result in results})
        rows.append(_row("mean", models, means, methods, [""] * len(searches)))
    return Table("1 - Rand Index (0 is best), area named right, seconds", heads, rows)


def _mean(
    results: Sequence[CaseResult], value: Callable[[CaseResult], float | None]
) -> float | None:
    known = mean_by_model(results, value)
    return statistics.fmean(known.values()) if known else None


def _row(
    name: str,
    models: int,
    numbers: Sequence[float | None],
    methods: Sequence[str],
    failed: Sequence[str],
) -> Cells:
    cells = [name, str(models), *(number_text(value, ".3f") for value in numbers[: len(methods)])]
    for k, text in enumerate(failed):
        named, seconds = numbers[len(methods) + 2 * k : len(methods) + 2 * k + 2]
        cells += [number_text(named, ".1%"), number_text(seconds, ".1f"), text]
    return cells


def number_text(value: float | None, style: str) -> str:
    """A number in a style such as ".3f"; nothing for None."""
    return "" if value is None else format(value, style)


def cost_table(results: Sequence[CaseResult]) -> Table:
    """What people's parts and found ones cost under the recipe, model by model.

    Parameters
    ----------
    results : sequence of CaseResult
    """
    searches = list(
        dict.fromkeys(r.method for r in results if r.method not in (PEOPLE, KMEANS, COSTS))
    )
    heads = ["category", "recipe", "model", "named parts", "people", "people below"]
    heads += [f"{method}: found" for method in searches] + ["verdict"]
    rows: list[Cells] = []
    for costs in (result for result in results if result.method == COSTS):
        same = [r for r in results if r.model == costs.model and r.recipe == costs.recipe]
        found = [
            [r.cost for r in same if r.method == method and r.cost is not None and not r.empty]
            for method in searches
        ]
        least = min((cost for values in found for cost in values), default=None)
        people = sorted(costs.people)
        named = costs.cost if costs.cost is not None and not costs.empty else None
        span = f"{people[0]:.3g} to {people[-1]:.3g} ({len(people)})" if people else ""
        if costs.incomplete:
            span += f"{', ' if span else ''}{costs.incomplete} lack a part"
        below = "" if least is None or not people else str(sum(cost < least for cost in people))
        cells = [costs.category, costs.recipe, str(costs.model)]
        cells += [number_text(named, ".4g"), span, below, *map(_spread, found)]
        rows.append([*cells, costs.failure or verdict(named, people, least)])
    return Table("Cost of people's parts beside the cost found", heads, rows)


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
    costs = [*people, *([] if named is None else [named])]
    if found is None or not costs:
        return ""
    above = [cost > found for cost in costs]
    if all(above):
        return "recipe"
    return "both" if any(above) else "search"


def failures(results: Sequence[CaseResult]) -> list[str]:
    """A line for each case that failed, with its reason."""
    return [
        f"{result.category} {result.model}, {result.method}"
        f"{f', seed {result.seed}' if result.seed else ''}: {result.failure}"
        for result in results
        if result.failure
    ]
