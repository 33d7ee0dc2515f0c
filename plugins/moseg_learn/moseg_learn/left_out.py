"""How well a learned recipe does: each example left out in turn, and cut by what the rest teach.

What comes out is compared with the labels of the example itself: by 1 - Rand Index, which looks at
regions alone; by the share of the area that bears the right name, numbers aside; and by cost. Where
what was found costs more than the example's own parts, the search has missed them; where it costs
less and is wrong, the recipe does not say enough.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from moseg_core import (
    Choice,
    Example,
    Labelling,
    MosegError,
    Progress,
    Recipe,
    Report,
    UsageError,
    Workers,
    learn,
    segment_variants,
)
from moseg_core.agreement import named_right, rand_index_error
from moseg_learn.names import labels_of
from moseg_learn.pieces import Pieces, pieces_of


@dataclass(frozen=True, kw_only=True)
class LeftOut:
    """What became of one example under the recipe of all others.

    Parameters
    ----------
    name : str
        Of the shape.
    rand_index_error : float or None
        0 to 1, 0 is best; None where it could not be segmented.
    named_right : float or None
        Share of the area, 0 to 1; 1 is best.
    cost : float or None
        Of what was found.
    own_cost : float or None
        Of the example's own parts; None where the recipe has no labels for them.
    failure : str
        Why something is missing.
    """

    name: str
    rand_index_error: float | None = None
    named_right: float | None = None
    cost: float | None = None
    own_cost: float | None = None
    failure: str = ""


def leave_one_out(
    examples: Sequence[Example],
    *,
    learner: str,
    seed: int = 0,
    workers: int = 1,
    show: Callable[[int, LeftOut], None],
) -> list[LeftOut]:
    """Try each example on the recipe of the others.

    Parameters
    ----------
    examples : sequence of Example
        Two or more.
    learner : str
        By name and with parameters.
    seed : int
        Of the searches.
    workers : int
        Number of processes.
    show : callable
        Called with the number of those done, and the last one.

    Raises
    ------
    UsageError
        There is one example only.
    """
    if len(examples) < 2:
        raise UsageError("--check leaves one example out, so it needs two or more")

    numbers = str(Choice.read(learner, "learner").parameters.get("numbers", "alike"))

    def tried(k: int, *, report: Report) -> LeftOut:
        rest = [example for i, example in enumerate(examples) if i != k]
        return _tried(examples[k], learn(rest, learner=learner), numbers, seed, report)

    found: dict[int, LeftOut] = {}

    def keep(k: int, result: LeftOut) -> bool:
        found[k] = result
        show(len(found), result)
        return False  # never enough

    with Workers({"try": tried}, workers, _go_on) as pool:
        pool.map("try", [(k,) for k in range(len(examples))], enough=keep)
    return [found[k] for k in range(len(examples))]


def _go_on(progress: Progress) -> bool:
    """Take notice of no progress, and never stop."""
    return False


def _tried(example: Example, recipe: Recipe, numbers: str, seed: int, report: Report) -> LeftOut:
    shape, name = example.shape, example.shape.name
    own = pieces_of(example, numbers=numbers)
    try:
        result = segment_variants(shape, recipe, seed=seed, report=report)
    except MosegError as error:
        return LeftOut(name=name, failure=str(error))
    own_cost, failure = None, ""
    try:
        own_cost = cost_of(own, recipe)
    except UsageError as error:
        failure = str(error)
    return LeftOut(
        name=name,
        rand_index_error=rand_index_error(result.labels.astype(np.int64), own.labels),
        named_right=named_right(
            result.labels.astype(np.int64),
            result.problem.labels,
            own.labels,
            own.kinds,
            shape.areas,
        ),
        cost=result.cost,
        own_cost=own_cost,
        failure=failure,
    )


def cost_of(pieces: Pieces, recipe: Recipe) -> float:
    """What the parts of an example cost under a recipe.

    Parameters
    ----------
    pieces : Pieces
        On the elements of the shape as its user gave it.
    recipe : Recipe

    Raises
    ------
    UsageError
        The recipe has no labels for these parts.
    """
    counts, declared = pieces.counts(), recipe.statement.declared
    named = {
        kind: [label for label in declared if label in labels_of(kind, len(declared) + 1)]
        or [label for label in declared if label == kind]
        for kind in counts
    }
    lacking = [kind for kind, n in counts.items() if n > len(named[kind])]
    if lacking:
        raise UsageError(
            f"the recipe has no labels for {pieces.described()}: too few for {lacking[0]}, of"
            f" {', '.join(recipe.labels)}"
        )
    label_of: list[str] = []
    for kind, n in counts.items():
        label_of += named[kind][:n]
    stated = replace(recipe.statement, variants=(tuple(label_of),))
    (task,) = replace(recipe, statement=stated).hierarchies()
    order = np.array([task.labels.index(label) for label in label_of])
    # A cost is that of the whole shape, what nobody has labelled included.
    whole = Labelling(labels=pieces.labels, names=pieces.kinds).filled(pieces.shape)
    return task.evaluate(pieces.shape, order[whole]).cost.value
