"""Runs a benchmark: cases in several processes, each kept on disk as soon as it is done.

The folder of a report holds ``report.json`` with every result, ``index.html`` with tables and
pictures (:mod:`moseg_benchmark.page`) and, in ``cases/``, a record of each case
(:mod:`moseg_benchmark.records`). A later run that resumes takes over the cases that were asked in
the same way, and does the rest.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from moseg_benchmark.cases import COSTS, KMEANS, PEOPLE, BenchmarkCase, CaseResult, run_case
from moseg_benchmark.label_matching import Naming
from moseg_benchmark.learned_cases import Shelf, run_learned_case
from moseg_benchmark.learned_tables import all_tables
from moseg_benchmark.lessons import LearnedCase, Lessons, learned_cases
from moseg_benchmark.page import draw_case, write_page
from moseg_benchmark.psb import CATEGORIES, NAMINGS, Model
from moseg_benchmark.records import Records
from moseg_benchmark.tables import failures
from moseg_core import (
    Progress,
    Recipe,
    Report,
    SearchOptions,
    Workers,
    __version__,
    check_hierarchy,
    write_file,
)

Show = Callable[[int, int, CaseResult], None]
"""Called with the number of cases done, of all, and the last one's result."""


@dataclass(frozen=True, kw_only=True)
class BenchmarkRequest:
    """What to measure.

    Parameters
    ----------
    models : sequence of Model
    recipes : mapping of str to Recipe
        For a category its recipe; others get people and k-means only.
    settings : sequence of str
    seeds : sequence of int
    lessons : Lessons or None
        From which examples recipes are learned for each model.

    Raises
    ------
    UsageError, PluginError
        Unknown settings, or a recipe that names something unknown.
    """

    models: Sequence[Model]
    recipes: Mapping[str, Recipe]
    settings: Sequence[str]
    seeds: Sequence[int]
    lessons: Lessons | None = None

    @property
    def searches(self) -> tuple[str, ...]:
        """The methods that search."""
        learned = () if self.lessons is None else self.lessons.methods
        return (*(self.settings if self.recipes else ()), *learned)

    @property
    def drawn(self) -> tuple[str, ...]:
        """The methods whose results are drawn: of learned recipes those of most examples."""
        learned = () if self.lessons is None else (self.lessons.longest,)
        return (*(self.settings if self.recipes else ()), *learned)

    def __post_init__(self) -> None:
        for recipe in self.recipes.values():
            for task in recipe.hierarchies():
                for settings in self.settings:
                    check_hierarchy(task, SearchOptions(settings=settings))


def all_cases(request: BenchmarkRequest) -> list[Sequence[BenchmarkCase]]:
    """The cases of a request, those that take longest first; those of one learned recipe together.

    Learned recipes come category by category, so that a process which has the shapes of one goes on
    with them (:class:`moseg_benchmark.learned_cases.Shelf`).
    """
    learned: list[Sequence[BenchmarkCase]] = []
    if request.lessons is not None:
        learned += learned_cases(request.models, request.lessons, request.seeds)
    searches: list[BenchmarkCase] = []
    others: list[BenchmarkCase] = []
    for model in request.models:
        others += [BenchmarkCase(model=model, method=method) for method in (PEOPLE, KMEANS)]
        recipe = request.recipes.get(model.category)
        if recipe is None:
            continue
        naming = NAMINGS.get(model.category, Naming())
        others.append(BenchmarkCase(model=model, method=COSTS, recipe=recipe, naming=naming))
        searches += [
            BenchmarkCase(model=model, method=settings, seed=seed, recipe=recipe, naming=naming)
            for settings in request.settings
            for seed in request.seeds
        ]
    order = {settings: k for k, settings in enumerate(request.settings)}
    searches.sort(key=lambda case: -order[case.method])
    return [*learned, *([case] for case in (*searches, *others))]


def run_benchmark(
    request: BenchmarkRequest, folder: Path, *, workers: int = 1, resume: bool = False, show: Show
) -> list[CaseResult]:
    """Measure, and write the report.

    Parameters
    ----------
    request : BenchmarkRequest
    folder : Path
        Made where it does not exist.
    workers : int
        Number of processes; how long a search takes depends on it.
    resume : bool
        Take over cases from an earlier run into the same folder.
    show : callable

    Returns
    -------
    list of CaseResult
        By model, method and seed.

    Raises
    ------
    MosegError
        A process died, or the disk is full; what was done by then can be resumed.
    """
    records, pictures = Records(folder / "cases"), folder / "pictures"
    batches = all_cases(request)
    shelf = Shelf()  # each process has its own copy

    def measure(batch: Sequence[BenchmarkCase], *, report: Report) -> list[CaseResult]:
        results: list[CaseResult] = []
        for case in batch:
            result: CaseResult
            if isinstance(case, LearnedCase):
                result, labels, recipe = run_learned_case(case, shelf=shelf, report=report)
                if recipe is not None:
                    records.write_recipe(case, recipe)
            else:
                result, labels = run_case(case, report=report)
            records.write(case, result, labels)
            results.append(result)
        return results

    def draw(case: BenchmarkCase, *, report: Report) -> list[str]:
        labels, recipe = records.labels(case), records.recipe(case)
        if labels is None or recipe is None:
            return []
        return draw_case(case, recipe, labels, pictures)

    with Workers({"measure": measure, "draw": draw}, workers, _go_on) as pool:
        for path in (records.folder, pictures):
            path.mkdir(parents=True, exist_ok=True)
        results = _measured(batches, records if resume else None, pool, show)
        cases = [case for batch in batches for case in batch]
        drawn = _drawn(request, cases, results, pool, pictures)
    order = {method: k for k, method in enumerate((PEOPLE, KMEANS, *request.searches, COSTS))}
    ordered = sorted(results.values(), key=lambda r: (r.model, order[r.method], r.seed))
    write_page(
        folder / "index.html",
        title="Agreement with people",
        tables=all_tables(ordered, CATEGORIES),
        failed=failures(ordered),
        results=ordered,
        pictures=drawn,
    )
    document = {
        "moseg": __version__,
        "settings": list(request.settings),
        "seeds": list(request.seeds),
        "recipes": {category: recipe.name for category, recipe in request.recipes.items()},
        "learned": None
        if request.lessons is None
        else {"learner": request.lessons.learner, "examples": list(request.lessons.examples)},
        "rows": [dataclasses.asdict(result) for result in ordered],
    }
    write_file(folder / "report.json", (json.dumps(document, indent=1) + "\n").encode())
    return ordered


def _measured(
    batches: Sequence[Sequence[BenchmarkCase]], earlier: Records | None, pool: Workers, show: Show
) -> dict[str, CaseResult]:
    """The result of each case by its key, those of an earlier run where there are any."""
    results: dict[str, CaseResult] = {}
    cases = [case for batch in batches for case in batch]
    if earlier is not None:
        taken_over = {case.key: earlier.result(case) for case in cases}
        results = {key: result for key, result in taken_over.items() if result is not None}
    left = [[case for case in batch if case.key not in results] for batch in batches]
    remaining = [batch for batch in left if batch]

    def keep(k: int, found: Sequence[CaseResult]) -> bool:
        for case, result in zip(remaining[k], found, strict=True):
            results[case.key] = result
            show(len(results), len(cases), result)
        return False  # never enough

    pool.map("measure", [(batch,) for batch in remaining], enough=keep)
    return results


def _drawn(
    request: BenchmarkRequest,
    cases: Sequence[BenchmarkCase],
    results: Mapping[str, CaseResult],
    pool: Workers,
    pictures: Path,
) -> dict[CaseResult, list[str]]:
    """For each search that is drawn, of the first seed, its pictures: paths from the report."""
    for model in request.models:  # drawn anew, since people's files may have changed
        for stale in pictures.glob(f"{model.number}-person-*.png"):
            stale.unlink()
    seed = min(request.seeds)
    shown = [c for c in cases if c.searches and c.seed == seed and not results[c.key].failure]
    drawn: dict[CaseResult, list[str]] = {}
    # People's pictures are shared by the methods: one case of each model at a time.
    for method in request.drawn:
        batch = [case for case in shown if case.method == method]
        for case, names in zip(batch, pool.map("draw", [(c,) for c in batch]), strict=True):
            if names:
                drawn[results[case.key]] = [f"{pictures.name}/{name}" for name in names]
    return drawn


def _go_on(progress: Progress) -> bool:
    """Take notice of no progress, and never stop."""
    return False
