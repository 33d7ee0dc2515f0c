"""Runs a benchmark: cases in several processes, each kept on disk as soon as it is done.

The folder of a report holds ``report.json`` with every row, ``index.html`` with tables and pictures
and, in ``cases/``, a file for each case with what was asked and what came out, and its labels. A
later run that resumes takes over the cases that were asked in the same way, and does the rest.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from moseg_core import __version__
from moseg_core.bench.cases import COSTS, KMEANS, PEOPLE, Case, Row, run_case
from moseg_core.bench.names import Naming
from moseg_core.bench.page import draw_case, write_page
from moseg_core.bench.psb import CATEGORIES, NAMINGS, Model
from moseg_core.bench.tables import all_tables, failures
from moseg_core.components.protocols import Report
from moseg_core.errors import MosegError
from moseg_core.io import encode_seg, read_labels, write_file
from moseg_core.problem.recipe import Recipe
from moseg_core.search.workers import Workers

Show = Callable[[int, int, Row], None]
"""Told the number of cases done, of all, and the last one's row."""


@dataclass(frozen=True, kw_only=True)
class Request:
    """What to measure.

    Parameters
    ----------
    models : sequence of Model
    recipes : mapping of str to Recipe
        For a category its recipe; others get people and k-means only.
    settings : sequence of str
    seeds : sequence of int
    """

    models: Sequence[Model]
    recipes: Mapping[str, Recipe]
    settings: Sequence[str]
    seeds: Sequence[int]


def all_cases(request: Request) -> list[Case]:
    """The cases of a request, those that take longest first."""
    searches, others = [], []
    for model in request.models:
        others += [Case(model=model, method=PEOPLE), Case(model=model, method=KMEANS)]
        recipe = request.recipes.get(model.category)
        if recipe is None:
            continue
        naming = NAMINGS.get((model.category, recipe.name), Naming())
        others.append(Case(model=model, method=COSTS, recipe=recipe, naming=naming))
        searches += [
            Case(model=model, method=settings, seed=seed, recipe=recipe, naming=naming)
            for settings in request.settings
            for seed in request.seeds
        ]
    order = {settings: k for k, settings in enumerate(request.settings)}
    searches.sort(key=lambda case: -order[case.method])
    return searches + others


def run_benchmark(
    request: Request, folder: Path, *, workers: int = 1, resume: bool = False, show: Show
) -> list[Row]:
    """Measure, and write the report.

    Parameters
    ----------
    request : Request
    folder : Path
        Made where it does not exist.
    workers : int
        Number of processes; how long a search takes depends on it.
    resume : bool
        Take over cases from an earlier run into the same folder.
    show : callable

    Returns
    -------
    list of Row
        By model, method and seed.
    """
    kept = folder / "cases"
    kept.mkdir(parents=True, exist_ok=True)
    pictures = folder / "pictures"
    pictures.mkdir(exist_ok=True)
    for model in request.models:  # drawn anew, since people's files may have changed
        for stale in pictures.glob(f"{model.number}-person-*.png"):
            stale.unlink()
    cases = all_cases(request)
    rows: dict[str, Row] = {}
    if resume:
        rows = {case.key: row for case in cases if (row := _kept(case, kept)) is not None}
    waiting = [case for case in cases if case.key not in rows]

    def measure(case: Case, *, report: Report) -> Row:
        row, labels = run_case(case, report=report)
        if labels is not None:
            write_file(kept / f"{case.key}.seg", encode_seg(labels))
        elements = 0 if labels is None else len(labels)
        document = {
            "asked": _asked(case),
            "elements": elements,
            "row": dataclasses.asdict(row),
        }
        write_file(kept / f"{case.key}.json", (json.dumps(document, indent=1) + "\n").encode())
        return row

    def draw(case: Case, *, report: Report) -> list[str]:
        seg = kept / f"{case.key}.seg"
        try:
            count = seg.read_bytes().count(b"\n")
            return draw_case(case, read_labels(seg, count).labels, pictures)
        except MosegError:  # labels changed by somebody: the row stands, without a picture
            return []

    def done(k: int, row: Row) -> bool:
        rows[waiting[k].key] = row
        show(len(rows), len(cases), row)
        return False

    with Workers({"measure": measure, "draw": draw}, workers, lambda progress: False) as pool:
        pool.map("measure", [(case,) for case in waiting], enough=done)
        first = min(request.seeds)
        shown = [c for c in cases if c.searches and c.seed == first and not rows[c.key].failure]
        # People's pictures are shared by the settings: one case of each model at a time.
        drawn: dict[Row, list[str]] = {}
        for settings in request.settings:
            batch = [case for case in shown if case.method == settings]
            for case, names in zip(batch, pool.map("draw", [(c,) for c in batch]), strict=True):
                if names:
                    drawn[rows[case.key]] = [f"pictures/{name}" for name in names]
    place = {method: k for k, method in enumerate((PEOPLE, KMEANS, *request.settings, COSTS))}
    found = sorted(rows.values(), key=lambda row: (row.model, place[row.method], row.seed))
    write_page(
        folder / "index.html",
        title="Agreement with people",
        tables=all_tables(found, CATEGORIES),
        failed=failures(found),
        rows=found,
        pictures=drawn,
    )
    document = {
        "moseg": __version__,
        "settings": list(request.settings),
        "seeds": list(request.seeds),
        "recipes": {category: recipe.name for category, recipe in request.recipes.items()},
        "rows": [dataclasses.asdict(row) for row in found],
    }
    write_file(folder / "report.json", (json.dumps(document, indent=1) + "\n").encode())
    return found


def _asked(case: Case) -> dict[str, Any]:
    """What tells a case from one that was asked otherwise, as plain data."""
    return {
        "moseg": __version__,
        "data": _digest(case.model),
        "labels": list(case.recipe.labels) if case.recipe else [],
        "minimize": case.recipe.minimize if case.recipe else "",
        "method": repr(case.recipe.statement.search) if case.recipe else "",
        "parts": repr(case.recipe.statement.parts) if case.recipe else "",
        "rename": dict(case.naming.rename),
        "merge": dict(case.naming.merge),
    }


def _digest(model: Model) -> str:
    """Hexadecimal digest of all files of a model."""
    digest = hashlib.sha256()
    for path in (model.mesh, *model.people, *([model.names] if model.names else [])):
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


def _kept(case: Case, folder: Path) -> Row | None:
    """The row of an earlier run that asked the same and did not fail."""
    path = folder / f"{case.key}.json"
    seg = path.with_suffix(".seg")
    if not path.is_file() or (case.searches and not seg.is_file()):
        return None
    try:
        document = json.loads(path.read_bytes())
        asked, row = document["asked"], Row.read(document["row"])
        complete = not case.searches or seg.read_bytes().count(b"\n") == document["elements"]
    except (ValueError, KeyError, TypeError):  # cut short or changed by somebody
        return None
    if asked != _asked(case) or not complete:
        return None
    return None if row.failure and row.cost is None else row
