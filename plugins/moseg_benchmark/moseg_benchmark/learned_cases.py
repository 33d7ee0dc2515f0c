"""Recipes learned from some models of a category, tried on others.

Each model is searched with a recipe that was learned from others of its category
(:func:`moseg_core.learn`): of the same collection, so that each is left out in turn, or of another
one. How many examples it takes shows when fewer are given: the next ones in cyclic order, so that
every model is an example as often as any other.

What is found is compared with people, like every segmentation; with the named parts by name; and
by cost: where it costs more than the model's own parts under the recipe, the search has missed
them. Costs can be compared only where labels are the same, so which label set was chosen is a
result too, beside the one that the model has.

All that is computed of a shape while recipes are learned is kept with it (:class:`Shelf`), so that
it is there for other recipes and for the search of that shape.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from moseg_benchmark.cases import BenchmarkCase, CaseResult, all_leaves, error_against, read_people
from moseg_benchmark.label_matching import IntArray, Naming, labels_of_names, piece_counts
from moseg_benchmark.psb import Model
from moseg_core import (
    Example,
    Labelling,
    MosegError,
    Recipe,
    Report,
    Result,
    Shape,
    UsageError,
    learn,
    load,
    read_labels,
    segment_variants,
)
from moseg_core.agreement import fold, named_right

LEARNED = "learned"
"""What the methods of learned recipes begin with: "learned" from all, "learned 2" from two."""

_MOST_SHAPES = 24
"""So many shapes are kept at once: a category, and some 50 MB for each of 20 000 faces."""


@dataclass(frozen=True, kw_only=True)
class Lessons:
    """What to learn from.

    Parameters
    ----------
    examples : tuple of int or None
        How many examples each recipe is learned from, at most; None for all that there are.
    learner : str
        By name and with parameters.
    teachers : tuple of Model or None
        The models to learn from; None for those that are searched, each without itself.
    """

    examples: tuple[int | None, ...] = (None,)
    learner: str = "profiles"
    teachers: tuple[Model, ...] | None = None

    @property
    def methods(self) -> tuple[str, ...]:
        """The method of each number of examples."""
        return tuple(method_of(n) for n in self.examples)

    @property
    def longest(self) -> str:
        """The method of the greatest number of examples."""
        return method_of(None if None in self.examples else max(n or 0 for n in self.examples))


def method_of(n: int | None) -> str:
    """The method of recipes learned from so many examples.

    Examples
    --------
    >>> method_of(2), method_of(None)
    ('learned 2', 'learned')
    """
    return LEARNED if n is None else f"{LEARNED} {n}"


@dataclass(frozen=True, kw_only=True)
class LearnedCase(BenchmarkCase):
    """A model with the examples that its recipe is learned from.

    Parameters
    ----------
    examples : tuple of Model
    learner : str
    """

    examples: tuple[Model, ...]
    learner: str = "profiles"

    @property
    def lesson_key(self) -> str:
        """A name for the file of the recipe, which is the same for all seeds."""
        return f"{self.model.number}-{self.method.replace(' ', '-')}"

    @property
    def key(self) -> str:
        """A name for files."""
        return f"{self.lesson_key}-{self.seed}"

    def read_result(self, document: Mapping[str, Any]) -> LearnedResult:
        """A result of such a case from plain data."""
        return LearnedResult.read(document)


@dataclass(frozen=True, kw_only=True)
class LearnedResult(CaseResult):
    """What the case of a learned recipe came to.

    Parameters
    ----------
    examples : int
        How many it was learned from.
    learning_seconds : float or None
        Wall-clock time of learning, without what was known of the examples before.
    numbers_right : float or None
        Share of the area whose name is right with its number (``finger2``), 0 to 1, 1 is best; None
        where no name of the model bears a number.
    search_cost : float or None
        Of what the search had found before a refiner moved boundaries; else the same as the cost.
    own_cost : float or None
        Of the named parts under the recipe; None where it has no such label set.
    label_set : str
        How many parts of each kind were found: "body, 4 leg".
    own_label_set : str
        How many the model has; empty where its parts are not named.
    offered : bool
        Whether the recipe has the model's own label set.
    """

    examples: int = 0
    learning_seconds: float | None = None
    numbers_right: float | None = None
    search_cost: float | None = None
    own_cost: float | None = None
    label_set: str = ""
    own_label_set: str = ""
    offered: bool = False


def learned_cases(
    models: Sequence[Model], lessons: Lessons, seeds: Sequence[int]
) -> list[list[LearnedCase]]:
    """The cases of all models, those of one recipe together.

    Parameters
    ----------
    models : sequence of Model
        To search.
    lessons : Lessons
    seeds : sequence of int

    Returns
    -------
    list of list of LearnedCase
        By category, model and number of examples; in each list one for each seed.
    """
    teachers = models if lessons.teachers is None else lessons.teachers
    cases = []
    for category in dict.fromkeys(model.category for model in models):
        own = [model for model in models if model.category == category]
        taught = [model for model in teachers if model.category == category]
        for place, model in enumerate(own):
            others = following(model, place, taught)
            for n, method in zip(lessons.examples, lessons.methods, strict=True):
                cases.append(
                    [
                        LearnedCase(
                            model=model,
                            method=method,
                            seed=seed,
                            examples=tuple(others[:n]),
                            learner=lessons.learner,
                        )
                        for seed in seeds
                    ]
                )
    return cases


def following(model: Model, place: int, teachers: Sequence[Model]) -> list[Model]:
    """The models that can be learned from, in cyclic order, from the one after `model` on.

    Parameters
    ----------
    model : Model
        Never an example for itself.
    place : int
        Where the order begins when `model` is none of the teachers.
    teachers : sequence of Model
        Those that do not teach, having no names or one, are passed over.
    """
    numbers = [teacher.number for teacher in teachers]
    first = numbers.index(model.number) + 1 if model.number in numbers else place
    turned = [teachers[(first + k) % len(teachers)] for k in range(len(teachers))]
    return [other for other in turned if other.number != model.number and other.teaches]


class Shelf:
    """Shapes and recipes of one category, kept while a process works on it."""

    def __init__(self) -> None:
        self._category = ""
        self._shapes: dict[Path, Shape] = {}
        self._recipes: dict[tuple[frozenset[Path], str], tuple[Recipe, float]] = {}

    def turn_to(self, category: str) -> None:
        """Put away what belongs to another category."""
        if category != self._category:
            self._shapes.clear()
            self._recipes.clear()
        self._category = category

    def shape(self, model: Model) -> Shape:
        """The shape of a model, with whatever was computed of it."""
        shape = self._shapes.pop(model.mesh, None) or load(model.mesh)
        while len(self._shapes) >= _MOST_SHAPES:
            del self._shapes[next(iter(self._shapes))]
        self._shapes[model.mesh] = shape  # the last one used is the last to go
        return shape

    def recipe(self, examples: Sequence[Model], learner: str) -> tuple[Recipe, float]:
        """What is learned from models with named parts, and the seconds that it took."""
        key = (frozenset(model.mesh for model in examples), learner)
        if key not in self._recipes:
            given = [_example(model, self.shape(model)) for model in examples]
            began = time.perf_counter()
            recipe = learn(given, learner=learner)
            self._recipes[key] = recipe, time.perf_counter() - began
        return self._recipes[key]


def _example(model: Model, shape: Shape) -> Example:
    assert model.names is not None  # others are no examples
    named = read_labels(model.names, shape.n_elements)
    return Example(shape, named.labels, named.names or ())


def run_learned_case(
    case: LearnedCase, *, shelf: Shelf, report: Report
) -> tuple[LearnedResult, IntArray | None, Recipe | None]:
    """Learn a recipe, search with it, and compare.

    Parameters
    ----------
    case : LearnedCase
    shelf : Shelf
        Of the process; what it holds does not change the result.
    report : callable
        Told how far the search has come; True asks it to stop.

    Returns
    -------
    result : LearnedResult
    labels : (F,) int or None
        What was found, in the order of :func:`moseg_benchmark.cases.all_leaves`.
    recipe : Recipe or None
        What was learned; None where that failed.
    """
    subject = {**case.subject, "examples": len(case.examples)}
    recipe = None
    try:
        if not case.examples:
            raise UsageError("there is no other model of the category to learn from")
        shelf.turn_to(case.model.category)
        recipe, seconds = shelf.recipe(case.examples, case.learner)
        subject |= {"recipe": recipe.name, "learning_seconds": seconds}
        shape = shelf.shape(case.model)
        people = read_people(case.model, shape)
        began = time.perf_counter()
        result = segment_variants(shape, recipe, settings="default", seed=case.seed, report=report)
        subject["seconds"] = time.perf_counter() - began
        leaves = all_leaves(recipe)
        labels = np.array([leaves.index(name) for name in result.problem.labels])[result.labels]
        subject |= {
            "rand_index_error": error_against(labels, people),
            "cost": result.cost,
            "search_cost": result.history.get("refine", ({"value": result.cost},))[0]["value"],
            "empty": len(result.evaluation.empty),
            "label_set": described(_kinds(result.problem.labels)),
        }
        if case.model.names is not None:
            named = read_labels(case.model.names, shape.n_elements)
            subject |= _beside_names(shape, result, recipe, named)
    except MosegError as error:
        return LearnedResult(**subject, failure=str(error)), None, recipe
    except Exception as error:  # noqa: BLE001  # a bug in one case must not lose the others' results
        return LearnedResult(**subject, failure=f"{type(error).__name__}: {error}"), None, recipe
    return LearnedResult(**subject), labels, recipe


def _beside_names(shape: Shape, result: Result, recipe: Recipe, named: Labelling) -> dict[str, Any]:
    """What is to be said of a result beside the named parts."""
    names = named.names or ()
    own = piece_counts(shape, named)
    tasks = [task for task in recipe.hierarchies() if _kinds(task.labels) == own]
    found = result.labels.astype(np.int64)
    values: dict[str, Any] = {
        "named_right": named_right(found, result.problem.labels, named.labels, names, shape.areas),
        "numbers_right": numbers_right(
            found, result.problem.labels, named.labels, names, shape.areas
        ),
        "own_label_set": described(own),
        "offered": bool(tasks),
    }
    if tasks:
        labels = labels_of_names(shape, named, tasks[0].labels, Naming())
        values["own_cost"] = tasks[0].evaluate(shape, labels).cost.value
    return values


def numbers_right(
    labels: IntArray,
    names: Sequence[str],
    truth: IntArray,
    true_names: Sequence[str],
    areas: np.ndarray[Any, np.dtype[np.float64]],
) -> float | None:
    """Share of the area that bears the right name with its number, where the true one has any.

    Parameters
    ----------
    labels, truth : (F,) int
    names, true_names : sequence of str
    areas : (F,) float

    Returns
    -------
    float or None
        0 to 1, 1 is best; None where no true name that occurs bears a number.

    Examples
    --------
    >>> labels, areas = np.array([0, 1, 2]), np.ones(3)
    >>> numbers_right(labels, ["rib1", "rib2", "toe1"], np.array([1, 1, 2]),
    ...               ["rib1", "rib2", "toe"], areas)
    0.6666666666666666
    """
    numbered = [fold(name) != name for name in true_names]
    if not any(numbered[k] for k in np.unique(truth).tolist()):
        return None
    exact, kinds = np.array(names)[labels], np.array([fold(name) for name in names])[labels]
    given = np.where(np.array(numbered)[truth], exact, kinds)
    return float(areas[given == np.array(true_names)[truth]].sum() / areas.sum())


def _kinds(labels: Iterable[str]) -> dict[str, int]:
    """How many labels there are of each kind, kinds in alphabetical order."""
    kinds = [fold(label) for label in labels]
    return {kind: kinds.count(kind) for kind in sorted(set(kinds))}


def described(counts: Mapping[str, int]) -> str:
    """A label set in words.

    Examples
    --------
    >>> described({"body": 1, "leg": 4})
    'body, 4 leg'
    """
    return ", ".join(f"{n} {kind}" if n > 1 else kind for kind, n in counts.items())
