"""Recipes learned from some models of a category, tried on others: one case at a time.

A case of :mod:`moseg_benchmark.lessons` has a model and its examples. The recipe that is learned of
these (:func:`moseg_core.learn`) searches the model. What is found is compared with people, like
every segmentation; with the named parts by name; and by cost: where it costs more than the model's
own parts under the recipe, the search has missed them. Costs can be compared only where labels are
the same, so which label set was chosen is a result too, beside the one that the model has.

All that is computed of a shape while recipes are learned is kept with it (:class:`Shelf`), so that
it is there for other recipes and for the search of that shape.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from moseg_benchmark.cases import all_leaves, error_against, read_people
from moseg_benchmark.label_matching import IntArray, Naming, labels_of_names, piece_counts
from moseg_benchmark.lessons import LearnedCase, LearnedResult
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

_MOST_SHAPES = 24
"""So many shapes are kept at once: a category, and some 50 MB for each of 20 000 faces."""


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
    named = read_labels(model.names, shape)
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
            named = read_labels(case.model.names, shape)
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
        whole = replace(named, labels=named.filled(shape))  # a cost is that of the whole shape
        labels = labels_of_names(shape, whole, tasks[0].labels, Naming())
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
        -1 in the truth for an element without a label, which does not count.
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
    known = truth >= 0
    labels, truth, areas = labels[known], truth[known], areas[known]
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
