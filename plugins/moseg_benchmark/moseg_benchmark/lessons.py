"""From which models recipes are learned, and which they are tried on.

Each model is searched with a recipe that was learned from others of its category: of the same
collection, so that each is left out in turn, or of another one. How many examples it takes shows
when fewer are given: the next ones in cyclic order, so that every model is an example as often as
any other. The work itself is :mod:`moseg_benchmark.learned_cases`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from moseg_benchmark.cases import BenchmarkCase, CaseResult
from moseg_benchmark.psb import Model

LEARNED = "learned"
"""What the methods of learned recipes begin with: "learned" from all, "learned 2" from two."""


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
