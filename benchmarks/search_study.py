"""Where searches end, with each ingredient of the seeder, against the cost of people's own parts.

    python benchmarks/search_study.py [PSB] [--cases FILE] [--only NAME ...] [--budget 10000]
        [--seeds 5] [--quick]

Every search may ask for the costs of equally many candidates on 2000 super-elements, those of the
seeding included: seeded starts, each taken to its end by the pattern search, until the evaluations
are used up. The best cost counts. Seeders, cumulatively:

- ``paper``: Algorithm 3, weights of 1, labels by assignment (``evolution``);
- ``sizes``: weights follow expected sizes, or evolve (``sized_evolution`` without the rest);
- ``labelled``: labels are inherited;
- ``places``: centres at furthest points;
- ``relocation``: races and relocations.

For each case: the cost of the truth, and the median and the best over the seeds. Where the truth is
cheaper than the median that was found, the search has failed. Truth is people's labels, a label of
a super-element being the one of most of its area.

Cases are the five samples under the printed recipes and, where the folder of the Princeton
Segmentation Benchmark is given (meshes in ``off``, named labels in ``labels``), ten of its models.
Others come from a TOML file, ``mapping`` from the names of the truth to labels: to one, or to
several for the connected pieces from large to small; "" gives an area to its neighbours::

    [[case]]
    name = "horse 389"
    mesh = "off/389.off"
    truth = "labels/389_labels.txt"
    recipe = "paper_horse"
    mapping = {torso = "body", head = "head", leg = ["leg1", "leg2", "leg3", "leg4"], tail = ""}

A recipe is a name or a file, and `mesh`, `truth` and such a file are sought in the folder of the
cases. Names that the mapping leaves out are taken as they are.
"""

from __future__ import annotations

import argparse
import statistics
import time
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

import moseg_core as moseg
from moseg_core.io import read_labels
from moseg_core.problem.settings import SearchOptions
from moseg_core.search.beginning import begin
from moseg_core.search.checked_partition import make_partition
from moseg_core.search.request import prepare_components
from moseg_core.search.run import go_on

RESOLUTION = 2000
#: The seeder of each column.
SEEDERS = {
    "paper": "evolution",
    "sizes": "sized_evolution(places=0, labelled=false, relocations=0)",
    "labelled": "sized_evolution(places=0, relocations=0)",
    "places": "sized_evolution(relocations=0)",
    "relocation": "sized_evolution",
}

Target = str | Sequence[str]


@dataclass(frozen=True, kw_only=True)
class Case:
    """A shape with true labels, and the recipe that it is searched under."""

    name: str
    mesh: Path
    truth: Path
    recipe: str
    mapping: Mapping[str, Target] = field(default_factory=dict)


def sample_cases() -> list[Case]:
    """The samples, under recipes in words that people use, with the names of the samples' truth."""
    folder = Path(__file__).parent / "search_cases"
    animal, dove = str(folder / "animal.toml"), str(folder / "dove.toml")
    arms = {f"arm{k + 1}": label for k, label in enumerate(numbered("leg", 8))}
    recipes: dict[str, tuple[str, Mapping[str, Target]]] = {
        "hammer": ("hammer", {}),
        "horse": (animal, {}),
        "bulldog": (animal, {}),
        "dove": (dove, {}),
        "octopus": ("octopus", {"head": "body", **arms}),
    }
    return [
        Case(
            name=name,
            mesh=moseg.sample_path(name),
            truth=moseg.sample_labels_path(name),
            recipe=recipe,
            mapping=mapping,
        )
        for name, (recipe, mapping) in recipes.items()
    ]


def benchmark_cases(folder: Path) -> list[Case]:
    """Ten models of the benchmark, under the recipes in words that people use."""
    animal = {"torso": "body", "earhorn": "head", "tail": "body", "leg": numbered("leg", 4)}
    models: list[tuple[str, Mapping[str, Target], Iterable[int]]] = [
        ("words_fourleg", animal, (381, 385)),
        ("words_octopus", {"leg": numbered("leg", 8)}, (121, 129)),
        ("words_bird", {"leg": "body", "wing": numbered("wing", 2)}, (241, 245)),
        ("words_hand", {}, (181, 189)),
        ("words_table", {"support": "top", "leg": numbered("leg", 4)}, (141, 153)),
    ]
    return [
        Case(
            name=f"{recipe} {number}",
            mesh=folder / "off" / f"{number}.off",
            truth=folder / "labels" / f"{number}_labels.txt",
            recipe=recipe,
            mapping=mapping,
        )
        for recipe, mapping, numbers in models
        for number in numbers
    ]


def numbered(stem: str, count: int) -> list[str]:
    """Labels with a number: leg1, leg2, ..."""
    return [f"{stem}{k + 1}" for k in range(count)]


def cases_of(path: Path) -> list[Case]:
    """The cases of a TOML file."""
    found = []
    for row in tomllib.loads(path.read_text())["case"]:
        recipe = path.parent / row["recipe"]
        found.append(
            Case(
                name=row["name"],
                mesh=path.parent / row["mesh"],
                truth=path.parent / row["truth"],
                recipe=str(recipe) if recipe.is_file() else row["recipe"],
                mapping=row.get("mapping", {}),
            )
        )
    return found


class Study:
    """A case, ready for searches."""

    def __init__(self, case: Case) -> None:
        shape = moseg.load(case.mesh)
        self.case = case
        self.recipe = moseg.load_recipe(case.recipe)
        self.problem = moseg.Problem.of(self.recipe.statement)
        embedded = self.problem.embed(shape)
        self.level = moseg.coarsen(embedded, RESOLUTION)
        self.shape = shape

    def evaluator(self) -> moseg.ProblemEvaluator:
        """A fresh one, which has counted nothing and remembers nothing."""
        ready = prepare_components(
            self.problem, SearchOptions().settled(self.recipe.statement.search)
        )
        partition = make_partition(ready["parameterization"], self.level, self.problem)
        return moseg.ProblemEvaluator(self.level, self.problem, partition)

    def search(self, seeder: str, budget: int, seed: int) -> tuple[float, float, int]:
        """Least cost within the budget, infinite with an empty part; seconds; number of starts."""
        evaluator = self.evaluator()
        options = SearchOptions(seeder=seeder, optimizer="pattern_search", settings="paper")
        ready = prepare_components(self.problem, options.settled(self.recipe.statement.search))
        coarse = {**ready, "optimizer": ready["optimizer"].preset("coarse")}
        began, starts = time.process_time(), 0

        def spent(_: moseg.Progress) -> bool:
            return evaluator.evaluations >= budget

        while evaluator.evaluations < budget:
            rng = np.random.default_rng([seed, starts])
            run = begin(evaluator, coarse, rng=rng, report=spent)
            left = budget - evaluator.evaluations
            go_on(run, evaluator, coarse["optimizer"], report=spent, until=left)
            starts += 1
        assert evaluator.best is not None
        cost = evaluator.best[0]
        value = cost.value if cost.empty == 0 else float("inf")
        return value, time.process_time() - began, starts

    def truth(self) -> float | None:
        """What people's parts cost on super-elements; None where the recipe has no word for one."""
        given = read_labels(self.case.truth, self.shape.n_elements)
        names = given.names or ()
        members = self.level.members
        assert members is not None
        shares = np.zeros((self.level.n_elements, len(names)))
        np.add.at(shares, (members, given.labels), self.shape.areas)
        labels = self._named(shares.argmax(axis=1), names)
        if labels is None:
            return None
        return self._least(labels)

    def _named(self, truth: np.ndarray, names: Sequence[str]) -> np.ndarray | None:
        """(F,) the recipe's labels: those mapped to, piece by piece where there are several."""
        known = self.problem.labels
        labels = np.full(len(truth), -1, np.int32)
        for number, name in enumerate(names):
            target = self.case.mapping.get(name, name)
            if isinstance(target, str):
                if target:
                    labels[truth == number] = known.index(target)
                continue
            pieces = self._pieces(truth == number)
            for label, piece in zip(target, pieces, strict=False):
                labels[piece] = known.index(label)
        if set(range(len(known))) - set(labels.tolist()):
            return None
        pairs = self.level.adjacency.pairs if self.level.adjacency is not None else np.empty((0, 2))
        while (labels < 0).any():
            first, second = pairs[(labels[pairs[:, 0]] < 0) & (labels[pairs[:, 1]] >= 0)].T
            if not len(first):
                return None
            labels[first] = labels[second]
        return labels

    def _pieces(self, inside: np.ndarray) -> list[np.ndarray]:
        """Connected pieces of some elements, large ones first."""
        adjacency = self.level.adjacency
        assert adjacency is not None
        elements = np.flatnonzero(inside)
        graph: Any = sparse.csr_matrix(adjacency.matrix)[elements][:, elements]
        count, piece = csgraph.connected_components(graph, directed=False)
        pieces = [elements[piece == k] for k in range(count)]
        return sorted(pieces, key=lambda piece: -float(self.level.areas[piece].sum()))

    def _least(self, labels: np.ndarray) -> float | None:
        """The cost of a labelling, pieces of one name exchanged as long as that makes it less."""
        evaluator = self.evaluator()
        best = evaluator.evaluate_labels(labels).cost
        groups = [t for t in self.case.mapping.values() if not isinstance(t, str)]
        better = True
        while better:
            better = False
            for first, second in (pair for group in groups for pair in combinations(group, 2)):
                i, j = (self.problem.labels.index(name) for name in (first, second))
                order = np.arange(len(self.problem.labels), dtype=np.int32)
                order[[i, j]] = j, i
                cost = evaluator.evaluate_labels(order[labels]).cost
                if cost < best:
                    best, labels, better = cost, order[labels], True
        return best.value if best.empty == 0 else None


def main() -> None:
    """Print the table, a line as soon as it is known."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("psb", nargs="?", type=Path)
    parser.add_argument("--cases", type=Path)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--columns", nargs="*", default=list(SEEDERS), choices=list(SEEDERS))
    parser.add_argument("--budget", type=int, default=10_000)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--quick", action="store_true", help="one sample, two seeds, 1500 each")
    given = parser.parse_args()
    cases = cases_of(given.cases) if given.cases else sample_cases()
    if given.psb:
        cases += benchmark_cases(given.psb)
    if given.quick:
        cases, given.seeds, given.budget = cases[:1], 2, 1500
    if given.only:
        cases = [case for case in cases if case.name in given.only]
    columns = given.columns
    head = "".join(f"{name:>22s}" for name in columns)
    print(f"{'cost: median (best), failed *':30s}{'labels':>7s}{'truth':>9s}{head}")
    failures, compared = dict.fromkeys(columns, 0), 0
    for case in cases:
        if not (case.mesh.exists() and case.truth.exists()):
            print(f"{case.name:30s} left out: {case.mesh} or its truth is not there")
            continue
        study = Study(case)
        truth = study.truth()
        compared += truth is not None
        said = "-" if truth is None else f"{truth:.3f}"
        print(f"{case.name:30s}{len(study.problem.labels):7d}{said:>9s}", end="", flush=True)
        seconds = []
        for column in columns:
            seeds = range(given.seeds)
            found = [study.search(SEEDERS[column], given.budget, seed) for seed in seeds]
            median, best = (f([value for value, _, _ in found]) for f in (statistics.median, min))
            failed = truth is not None and truth < median
            failures[column] += failed
            print(f"{f'{median:.3f} ({best:.3f})' + '*' * failed:>22s}", end="", flush=True)
            seconds.append(statistics.mean(s for _, s, _ in found))
        print("   " + " ".join(f"{s:.0f}" for s in seconds) + " s")
    ends = "".join(f"{f'{failures[c]} of {compared}':>22s}" for c in columns)
    print(f"{'truth is cheaper':46s}{ends}")


if __name__ == "__main__":
    main()
