"""What a benchmark measures, one case at a time.

A case is a model with a method: what people say of it, compared with each other; k-means on the
face centroids with as many clusters as people see parts (the benchmark's own baseline); a recipe
under some settings and a seed; or what people's parts cost under the recipe. Whatever goes wrong
in a case becomes part of its result, so that one bad mesh does not end an hour's work.
"""

from __future__ import annotations

import itertools
import statistics
import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from moseg_benchmark.label_matching import (
    IntArray,
    Naming,
    fitting_set,
    labels_by_overlap,
    labels_of_names,
)
from moseg_benchmark.psb import Model
from moseg_core import (
    Hierarchy,
    Labelling,
    MosegError,
    Recipe,
    Report,
    Shape,
    UsageError,
    load,
    read_labels,
    segment_variants,
)
from moseg_core.agreement import named_right, rand_index_error

PEOPLE, KMEANS, COSTS = "people", "k-means", "costs"
"""Methods that need no recipe's search."""


@dataclass(frozen=True, kw_only=True)
class BenchmarkCase:
    """One thing to measure.

    Parameters
    ----------
    model : Model
    method : str
        "people", "k-means", "costs", or the settings of a search.
    seed : int
    recipe : Recipe or None
        For searches and costs.
    naming : Naming
    """

    model: Model
    method: str
    seed: int = 0
    recipe: Recipe | None = None
    naming: Naming = field(default_factory=Naming)

    @property
    def searches(self) -> bool:
        """Whether it is a recipe's search."""
        return self.method not in (PEOPLE, KMEANS, COSTS)

    @property
    def subject(self) -> dict[str, Any]:
        """What a result says of its case."""
        return {
            "model": self.model.number,
            "category": self.model.category,
            "method": self.method,
            "recipe": self.recipe.name if self.recipe else "",
            "seed": self.seed,
        }

    @property
    def key(self) -> str:
        """A name for files."""
        recipe = f"-{self.recipe.name}" if self.recipe else ""
        return f"{self.model.number}{recipe}-{self.method}-{self.seed}"

    def read_result(self, document: Mapping[str, Any]) -> CaseResult:
        """A result of such a case from plain data."""
        return CaseResult.read(document)


@dataclass(frozen=True, kw_only=True)
class CaseResult:
    """What a case came to; None stands for what it does not measure.

    Parameters
    ----------
    model : int
    category, method, recipe : str
    seed : int
    rand_index_error : float or None
        1 - Rand Index by faces, mean over people, 0 to 1; 0 is best.
    named_right : float or None
        Share of the area with the right name, 0 to 1; 1 is best.
    seconds : float or None
        Wall-clock time of the search.
    cost : float or None
        Of the labelling, under the recipe; of the named parts, for "costs".
    empty : int
        Labels without a part.
    people : tuple of float
        For "costs": of each person's parts, where every label has one.
    incomplete : int
        For "costs": people some label of whom has no part.
    failure : str
        Why there are no numbers, or not all.
    """

    model: int
    category: str
    method: str
    recipe: str = ""
    seed: int = 0
    rand_index_error: float | None = None
    named_right: float | None = None
    seconds: float | None = None
    cost: float | None = None
    empty: int = 0
    people: tuple[float, ...] = ()
    incomplete: int = 0
    failure: str = ""

    @classmethod
    def read(cls, document: Mapping[str, Any]) -> Self:
        """From plain data, as :func:`dataclasses.asdict` makes them."""
        return cls(**{**document, "people": tuple(document["people"])})


def run_case(case: BenchmarkCase, *, report: Report) -> tuple[CaseResult, IntArray | None]:
    """Measure one case.

    Parameters
    ----------
    case : BenchmarkCase
    report : callable
        Told how far a search has come; True asks it to stop.

    Returns
    -------
    result : CaseResult
    labels : (F,) int or None
        The labelling that was measured, where there is a single one.
    """
    subject = case.subject
    try:
        shape = load(case.model.mesh)
        people = read_people(case.model, shape)
        values, labels = _measure(case, shape, people, report)
    except MosegError as error:
        return CaseResult(**subject, failure=str(error)), None
    except Exception as error:  # noqa: BLE001  # a bug in one case must not lose the others' results
        return CaseResult(**subject, failure=f"{type(error).__name__}: {error}"), None
    return CaseResult(**subject, **values), labels


def read_people(model: Model, shape: Shape) -> list[IntArray]:
    """Each person's segmentation of a model; -1 for elements that somebody has left out.

    Raises
    ------
    UsageError
        There are none.
    """
    if not model.people:
        raise UsageError("there are no segmentations by people")
    return [read_labels(path, shape).labels for path in model.people]


def _measure(
    case: BenchmarkCase, shape: Shape, people: list[IntArray], report: Report
) -> tuple[dict[str, Any], IntArray | None]:
    if case.method == PEOPLE:
        return {"rand_index_error": _error_between(people)}, None
    if case.method == KMEANS:
        counts = (len(np.unique(person[person >= 0])) for person in people)
        labels = cluster(shape, round(statistics.median(counts)))
        return {"rand_index_error": error_against(labels, people)}, labels
    assert case.recipe is not None  # everything else has one
    tasks = case.recipe.hierarchies()
    named = _named_parts(case, shape)
    if case.method == COSTS:
        return _costs(case, shape, tasks, named, people), None
    began = time.perf_counter()
    result = segment_variants(
        shape,
        case.recipe,
        settings=case.method,
        seed=case.seed,
        report=report,
    )
    seconds = time.perf_counter() - began
    leaves = all_leaves(case.recipe)
    # A part that could not be divided is that of its first leaf.
    first = [leaves.index(_first_leaf(tasks, name)) for name in result.problem.labels]
    labels = np.array(first)[result.labels]
    values: dict[str, Any] = {
        "rand_index_error": error_against(labels, people),
        "seconds": seconds,
        "cost": result.cost,
        "empty": len(result.evaluation.empty),
    }
    wanted = _wanted(case, shape, tasks, named)
    if wanted is not None:
        values["named_right"] = named_right(
            result.labels.astype(np.int64),
            result.problem.labels,
            *wanted,
            shape.areas,
        )
    return values, labels


def all_leaves(recipe: Recipe) -> list[str]:
    """The labels that a recipe's results can have, of whichever label set; each once."""
    return list(dict.fromkeys(leaf for task in recipe.hierarchies() for leaf in task.labels))


def _first_leaf(tasks: Sequence[Hierarchy], name: str) -> str:
    """The leaf of a label, or the first below it."""
    task = next(t for t in tasks if name.partition("/")[0] in t.problem.labels)
    return task.labels[task.first_leaf(name)]


def _wanted(
    case: BenchmarkCase, shape: Shape, tasks: Sequence[Hierarchy], named: Labelling | None
) -> tuple[IntArray, tuple[str, ...]] | None:
    """The recipe's labels of the named parts; None where it has no label for some of them."""
    if named is None or named.names is None:
        return None
    try:
        task = tasks[fitting_set(shape, named, [t.labels for t in tasks], case.naming)]
        return labels_of_names(shape, named, task.labels, case.naming), task.labels
    except UsageError:
        return None


def _named_parts(case: BenchmarkCase, shape: Shape) -> Labelling | None:
    if case.model.names is None:
        return None
    return read_labels(case.model.names, shape)


def error_against(labels: IntArray, people: list[IntArray]) -> float:
    """1 - Rand Index, mean over people."""
    return statistics.fmean(rand_index_error(labels, person) for person in people)


def _error_between(people: list[IntArray]) -> float:
    """1 - Rand Index, mean over pairs of people."""
    pairs = list(itertools.combinations(people, 2))
    if not pairs:
        raise UsageError("one person alone has nobody to agree with")
    return statistics.fmean(rand_index_error(a, b) for a, b in pairs)


def cluster(shape: Shape, n: int) -> IntArray:
    """K-means clusters of the elements' centroids, each counting alike.

    Parameters
    ----------
    shape : Shape
    n : int

    Returns
    -------
    (F,) int
        The same in every run; now and then fewer than `n` different ones.
    """
    from scipy.cluster.vq import kmeans2

    with warnings.catch_warnings():
        # An empty cluster, which the benchmark's measures do not mind.
        warnings.simplefilter("ignore", UserWarning)
        _, labels = kmeans2(shape.unit_points, n, minit="++", iter=50, rng=np.random.default_rng(0))
    return np.asarray(labels, np.int64)


def _costs(
    case: BenchmarkCase,
    shape: Shape,
    tasks: Sequence[Hierarchy],
    named: Labelling | None,
    people: list[IntArray],
) -> dict[str, Any]:
    """What the named parts, and each person's, cost under the recipe for their label set."""
    if named is None:
        raise UsageError("there are no named parts, which the recipe's labels could be given to")
    # A cost is that of the whole shape.
    named = replace(named, labels=named.filled(shape))
    task = tasks[fitting_set(shape, named, [t.labels for t in tasks], case.naming)]
    labels = labels_of_names(shape, named, task.labels, case.naming)
    of_names = task.evaluate(shape, labels)
    costs, incomplete = [], 0
    for person in people:
        of_person = task.evaluate(shape, labels_by_overlap(person, labels, shape.areas))
        if of_person.empty:
            incomplete += 1
        else:
            costs.append(of_person.cost.value)
    missing = ", ".join(of_names.empty)
    return {
        "cost": of_names.cost.value,
        "empty": len(of_names.empty),
        "people": tuple(costs),
        "incomplete": incomplete,
        "failure": f"the named parts leave {missing} without one" if missing else "",
    }
