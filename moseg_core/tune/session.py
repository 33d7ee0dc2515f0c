"""What is tuned: a recipe's weights and a result's centres, and the search that goes on from them.

Somebody who is no programmer finds the words for a shape by looking: one term counts more, another
is left out, a centre goes where the part is. Each :meth:`Session.search` states the recipe with the
weights that are asked for, and goes on from the present result (Sec. 7: the optimizer alone, from
the centres there are), with the centres that were moved by hand; or begins anew. Results before
are kept, so that a step can be taken back.

Nothing is written here: a session hands out the recipe and the result, and whoever serves it
(:mod:`moseg_core.tune.server`) puts them into files.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from moseg_core.components.protocols import Report
from moseg_core.errors import UsageError, unknown
from moseg_core.language import Expression, Term, parse
from moseg_core.problem.recipe import Recipe
from moseg_core.problem.settings import SearchOptions
from moseg_core.problem.variants import Variants
from moseg_core.search.result import Result
from moseg_core.search.variants import solve_variants
from moseg_core.shape.shape import Shape

MOST_WEIGHT = 1e6
"""The largest weight that may be asked for, with either sign."""


@dataclass(frozen=True, kw_only=True)
class Wish:
    """What a search is asked for.

    Parameters
    ----------
    weights : tuple of float
        Of each term of the recipe, in its order; 0 leaves the term out.
    moved : mapping of str to int
        Labels whose centres were moved, each with the input's element where its centre is to be.
    anew : bool
        Whether to begin from seeds again, not from the present result.
    hold : bool
        Whether centres that were moved stay where they are.

    Examples
    --------
    >>> Wish.read({"weights": [1, 2.5], "moved": {"head": 12}}).weights
    (1.0, 2.5)
    """

    weights: tuple[float, ...]
    moved: Mapping[str, int] = field(default_factory=dict)
    anew: bool = False
    hold: bool = False

    @classmethod
    def read(cls, document: object) -> Wish:
        """From plain data, as a browser sends them.

        Raises
        ------
        UsageError
            Anything else than the fields above, or a value of another kind.
        """
        if not isinstance(document, dict):
            raise UsageError("a wish is an object with 'weights', 'moved', 'anew' and 'hold'")
        for key in document:
            if key not in (allowed := ("weights", "moved", "anew", "hold")):
                raise UsageError(unknown("key", str(key), allowed))
        weights, moved = document.get("weights"), document.get("moved", {})
        if not isinstance(weights, list) or not all(map(_is_number, weights)):
            raise UsageError("'weights' are numbers, one for each term")
        if not isinstance(moved, dict) or not all(type(k) is int for k in moved.values()):
            raise UsageError("'moved' has the number of an element for each label")
        flags = {key: document.get(key, False) for key in ("anew", "hold")}
        for key, value in flags.items():
            if not isinstance(value, bool):
                raise UsageError(f"'{key}' is true or false")
        return cls(weights=tuple(map(float, weights)), moved=moved, **flags)


def _is_number(value: Any) -> bool:
    return (
        isinstance(value, int | float)
        and not isinstance(value, bool)
        and math.isfinite(value)
        and abs(value) <= MOST_WEIGHT
    )


class Session:
    """A shape, a recipe whose weights change, and the results so far.

    Parameters
    ----------
    shape : Shape
    recipe : Recipe
        As it was given; only the weights of its first level are tuned.
    options : SearchOptions
        How to search, but for the processes.
    sets : sequence of sequence of str, optional
        The label sets that may be chosen, of those that the recipe declares; all by default.

    Attributes
    ----------
    terms : tuple of Term
        The terms of the recipe, as it was given.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> from moseg_core.problem.recipe import load_recipe
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> options = SearchOptions.of(
    ...     {"restarts": 1, "resolution": 300, "optimizer": "pattern_search(max_evaluations=50)"}
    ... )
    >>> session = Session(hammer, load_recipe("hammer"), options)
    >>> result = session.search(Wish(weights=session.weights), lambda progress: False)
    >>> heavier = Wish(weights=(9.0, *session.weights[1:]), moved={"head": 0})
    >>> session.search(heavier, lambda progress: False) is session.result, session.earlier
    (True, 1)
    >>> session.recipe().statement.minimize[:2]
    '9*'
    """

    def __init__(
        self,
        shape: Shape,
        recipe: Recipe,
        options: SearchOptions,
        *,
        sets: Sequence[Sequence[str]] | None = None,
    ) -> None:
        self.shape, self._recipe, self._options, self._sets = shape, recipe, options, sets
        self.terms: tuple[Term, ...] = parse(recipe.statement.minimize).terms
        #: The weights of each search with what it found; the last is the present one.
        self._steps: list[tuple[tuple[float, ...], Result]] = []

    @property
    def weights(self) -> tuple[float, ...]:
        """Of each term, as the present result was searched with; the recipe's before the first."""
        return self._steps[-1][0] if self._steps else tuple(term.weight for term in self.terms)

    @property
    def result(self) -> Result:
        """The present one; there is none before the first search."""
        return self._steps[-1][1]

    @property
    def earlier(self) -> int:
        """How many results there are before the present one."""
        return max(0, len(self._steps) - 1)

    def recipe(self, weights: Sequence[float] | None = None) -> Recipe:
        """The recipe with certain weights, by default those of the present result.

        Raises
        ------
        UsageError
            As many weights as there are terms are needed, and one that is not 0.
        """
        weights = self.weights if weights is None else weights
        if len(weights) != len(self.terms):
            raise UsageError(f"{len(weights)} weights for {len(self.terms)} terms")
        kept = tuple(
            replace(term, weight=weight)
            for term, weight in zip(self.terms, weights, strict=True)
            if weight != 0
        )
        if not kept:
            raise UsageError("every term has weight 0; give one of them a weight")
        if weights == tuple(term.weight for term in self.terms):
            return self._recipe  # in its author's spelling
        statement = replace(self._recipe.statement, minimize=str(Expression(kept)))
        return replace(self._recipe, statement=statement)

    def search(self, wish: Wish, report: Report, *, workers: int = 1) -> Result:
        """Search as is wished; the result is the present one from then on.

        Parameters
        ----------
        wish : Wish
        report, workers
            As for :func:`moseg_core.segment`. One process, where other threads run.

        Raises
        ------
        UsageError
            Weights or labels that are none of the recipe's, an element that is none.
        ShapeError, PluginError
            As for :func:`moseg_core.segment`. The present result stays what it was.
        """
        variants = Variants.of(self.recipe(wish.weights).statement, self._sets)
        options = replace(self._options, workers=workers)
        if wish.anew or not self._steps:
            result = solve_variants(self.shape, variants, options, report=report)
        else:
            start = self._moved(wish.moved)
            result = solve_variants(
                self.shape,
                variants.having(start.problem.labels, "the present result", exactly=True),
                options,
                start=start,
                freeze=sorted(wish.moved) if wish.hold else (),
                report=report,
            )
        self._steps.append((wish.weights, result))
        return result

    def back(self) -> Result:
        """Take the last search back.

        Raises
        ------
        UsageError
            There is no result before it.
        """
        if not self.earlier:
            raise UsageError("this is the first result")
        self._steps.pop()
        return self.result

    def _moved(self, moved: Mapping[str, int]) -> Result:
        """The present result, of its first level, with some centres moved to elements.

        Of a label with several centres the one is moved that is nearest.
        """
        present = self.result.levels.get("", self.result)
        names, centers, partitioned = present.problem.labels, present.centers, present.partitioned
        positions = centers.positions.copy()
        parts = np.arange(len(positions)) if centers.parts is None else centers.parts
        for label, element in moved.items():
            if label not in names:
                raise UsageError(unknown("label", label, names))
            if not 0 <= element < partitioned.n_elements:
                raise UsageError(
                    f"there is no {partitioned.noun} {element}; they are counted from 0 to"
                    f" {partitioned.n_elements - 1}"
                )
            place = partitioned.points[element]
            own = np.flatnonzero(parts == names.index(label))
            nearest = own[np.argmin(np.linalg.norm(positions[own] - place, axis=1))]
            positions[nearest] = place
        return replace(present, centers=replace(centers, positions=positions))
