"""How well learned recipes do, summed up: by category, and by how many examples they learned from.

Numbers are means as in :mod:`moseg_benchmark.tables`: a model's over its people and seeds, a
category's over its models, the last line over categories. Two more questions are asked of the
recipes:

- *Did the search find the parts?* Where what was found costs more than the model's own parts, both
  before and after a refiner moved boundaries, it did not. Asked where the labels found are those
  that the model has; of several seeds the middle one counts.
- *Were the right labels chosen?* Asked where the models of a category differ in theirs. A recipe
  that was learned from others has perhaps never seen the label set of a model.
"""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Callable, Sequence

from moseg_benchmark.cases import COSTS, KMEANS, PEOPLE, CaseResult
from moseg_benchmark.lessons import LearnedResult
from moseg_benchmark.tables import (
    Table,
    agreement_table,
    cost_table,
    mean_by_model,
    number_text,
)

Value = Callable[[CaseResult], float | None]


def all_tables(results: Sequence[CaseResult], categories: Sequence[str]) -> list[Table]:
    """The tables of a report that have something to say.

    Parameters
    ----------
    results : sequence of CaseResult
    categories : sequence of str
        In the order of the lines.
    """
    learned = learned_tables(results, categories)
    by_hand = [result for result in results if not isinstance(result, LearnedResult)]
    searched = any(result.recipe for result in by_hand)
    tables = [*learned]
    if searched or not learned:
        tables += [agreement_table(by_hand, categories), cost_table(by_hand)]
    return [table for table in tables if table.rows]


def learned_tables(results: Sequence[CaseResult], categories: Sequence[str]) -> list[Table]:
    """The tables about learned recipes, of those that have something to say.

    Parameters
    ----------
    results : sequence of CaseResult
        Of all methods.
    categories : sequence of str
        In the order of the lines.
    """
    learned = [result for result in results if isinstance(result, LearnedResult)]
    if not learned:
        return []
    searches = [result for result in results if result.method not in (PEOPLE, KMEANS, COSTS)]
    compared = [result for result in results if result.method != COSTS]
    tables = [
        means_table(
            "1 - Rand Index (0 is best)", compared, categories, lambda r: r.rand_index_error, ".3f"
        ),
        means_table("Area named right", searches, categories, lambda r: r.named_right, ".1%"),
        means_table("Area named right, with numbers", learned, categories, _numbers_right, ".1%"),
        means_table("Seconds of a search", searches, categories, lambda r: r.seconds, ".1f"),
        means_table("Seconds of learning", learned, categories, _learning_seconds, ".1f"),
        found_table(learned, categories),
        missed_table(learned),
        choice_table(learned, categories),
        wrong_choice_table(learned),
    ]
    return [table for table in tables if table.rows]


def _numbers_right(result: CaseResult) -> float | None:
    return result.numbers_right if isinstance(result, LearnedResult) else None


def _learning_seconds(result: CaseResult) -> float | None:
    return result.learning_seconds if isinstance(result, LearnedResult) else None


def means_table(
    title: str, results: Sequence[CaseResult], categories: Sequence[str], value: Value, style: str
) -> Table:
    """The mean of one value by category and method; cases without one are counted.

    Parameters
    ----------
    title : str
    results : sequence of CaseResult
    categories : sequence of str
    value : callable
    style : str
        How numbers are written: ".3f".
    """
    methods = _methods(results)
    rows: list[list[str]] = []
    columns: list[list[float]] = [[] for _ in methods]
    for category in categories:
        own = [result for result in results if result.category == category]
        if not any(value(result) is not None for result in own):
            continue
        cells = [category, str(len({result.model for result in own}))]
        for method, column in zip(methods, columns, strict=True):
            of_method = [result for result in own if result.method == method]
            means = mean_by_model(of_method, value)
            failed = sum(bool(result.failure) for result in of_method)
            text = ""
            if means:
                column.append(statistics.fmean(means.values()))
                text = number_text(column[-1], style)
            cells.append(f"{text} ({failed} failed)".strip() if failed else text)
        rows.append(cells)
    if len(rows) > 1:
        last = [number_text(statistics.fmean(c) if c else None, style) for c in columns]
        rows.append(["mean", str(sum(int(cells[1]) for cells in rows)), *last])
    return Table(title, ["category", "models", *methods], rows)


def excess(results: Sequence[LearnedResult]) -> float | None:
    """By how much what was found costs more than a model's own parts, for the middle seed.

    Parameters
    ----------
    results : sequence of LearnedResult
        Of one model and method.

    Returns
    -------
    float or None
        Negative where it costs less; None where nothing was found with the labels that the model
        has.
    """
    pairs = [(_least(r), r.own_cost) for r in results if r.label_set == r.own_label_set]
    known = [cost - own for cost, own in pairs if cost is not None and own is not None]
    return statistics.median_low(known) if known else None


def _least(result: LearnedResult) -> float | None:
    """The cost of what was found, before or after boundaries were moved."""
    costs = [cost for cost in (result.cost, result.search_cost) if cost is not None]
    return min(costs, default=None)


def found_table(results: Sequence[LearnedResult], categories: Sequence[str]) -> Table:
    """Of how many models what was found costs more than their own parts.

    Parameters
    ----------
    results : sequence of LearnedResult
    categories : sequence of str
    """
    methods = _methods(results)
    rows, above, compared = list[list[str]](), Counter[str](), Counter[str]()
    for category in categories:
        cells = [category]
        for method in methods:
            known = [
                more
                for own in _by_model(results, method, category).values()
                if (more := excess(own)) is not None
            ]
            count = sum(more > 0 for more in known)
            above[method] += count
            compared[method] += len(known)
            cells.append(f"{count} of {len(known)}" if known else "")
        if any(cells[1:]):
            rows.append(cells)
    if len(rows) > 1:
        rows.append(["all", *(f"{above[method]} of {compared[method]}" for method in methods)])
    title = "Models of which what was found costs more than their own parts (same labels)"
    return Table(title, ["category", *methods], rows)


def missed_table(results: Sequence[LearnedResult]) -> Table:
    """The models of which what was found costs more than their own parts, with both costs.

    Parameters
    ----------
    results : sequence of LearnedResult
    """
    rows = []
    for method in _methods(results):
        for model, own in _by_model(results, method).items():
            if (excess(own) or 0.0) <= 0:
                continue
            same = [r for r in own if r.label_set == r.own_label_set]
            found = ", ".join(number_text(_least(r), ".4g") for r in same)
            parts = number_text(same[0].own_cost, ".4g")
            rows.append([own[0].category, str(model), method, parts, found])
    heads = ["category", "model", "method", "own parts", "found, by seed"]
    return Table("What the search has missed", heads, rows)


def choice_table(results: Sequence[LearnedResult], categories: Sequence[str]) -> Table:
    """How often the label set of a model was chosen, in categories whose models differ.

    Parameters
    ----------
    results : sequence of LearnedResult
    categories : sequence of str
    """
    heads = ["category", "method", "label sets", "right", "wrong", "not in the recipe"]
    rows, totals = list[list[str]](), dict[str, Counter[str]]()
    for category in categories:
        own = [r for r in results if r.category == category and r.label_set and r.own_label_set]
        sets = len({result.own_label_set for result in own})
        if sets < 2:
            continue
        for method in _methods(own):
            counts = Counter(_choice(result) for result in own if result.method == method)
            totals.setdefault(method, Counter()).update(counts)
            rows.append([category, method, str(sets), *_counted(counts)])
    if len({cells[0] for cells in rows}) > 1:
        rows += [["all", method, "", *_counted(counts)] for method, counts in totals.items()]
    return Table("Label sets chosen, in searches", heads, rows)


def wrong_choice_table(results: Sequence[LearnedResult]) -> Table:
    """Each model for which another label set was chosen than its own, which the recipe has too.

    Parameters
    ----------
    results : sequence of LearnedResult
    """
    wrong = Counter(
        (r.category, r.model, r.method, r.own_label_set, r.label_set)
        for r in results
        if r.label_set and r.own_label_set and _choice(r) == "wrong"
    )
    rows = [[*map(str, words), str(count)] for words, count in wrong.items()]
    heads = ["category", "model", "method", "its own", "chosen", "searches"]
    return Table("Label sets chosen wrongly", heads, rows)


def _choice(result: LearnedResult) -> str:
    if not result.offered:
        return "not in the recipe"
    return "right" if result.label_set == result.own_label_set else "wrong"


def _counted(counts: Counter[str]) -> list[str]:
    return [str(counts[word]) for word in ("right", "wrong", "not in the recipe")]


def _methods(results: Sequence[CaseResult]) -> list[str]:
    """Those of some results, in their order."""
    return list(dict.fromkeys(result.method for result in results))


def _by_model(
    results: Sequence[LearnedResult], method: str, category: str = ""
) -> dict[int, list[LearnedResult]]:
    """The results of a method, of one category or all, by model."""
    found: dict[int, list[LearnedResult]] = {}
    for result in results:
        if result.method == method and category in ("", result.category):
            found.setdefault(result.model, []).append(result)
    return found
