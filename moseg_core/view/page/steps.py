"""The steps of a search for a page: which part each element belonged to on the way to the result.

A result keeps the centres that were the best now and then (:mod:`moseg_core.search.incumbents`).
The partition that they stand for is computed here, when the page is written, by the
parameterization of the search (Sec. 4). Of a large shape that is done on super-elements, as the
search had done it: a page of a million faces then takes seconds, not minutes.

From one step to the next few elements change their parts. So the page carries the labels of the
result, and for each step before it what is different from the one that follows
(:func:`packed_changes`).
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.cost import Cost
from moseg_core.errors import MosegError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.search.checked_partition import make_partition
from moseg_core.search.incumbents import Incumbent, thinned
from moseg_core.search.pieces import without_small_pieces
from moseg_core.search.restarts import searched_shape
from moseg_core.search.result import Result
from moseg_core.shape.pins import NO_PINS
from moseg_core.types import FloatArray, IntArray

#: Elements above which (by half) a shape is partitioned on super-elements.
_MOST_ELEMENTS = 20_000
#: What the changes of all steps together may take on a page, bytes.
MOST_BYTES = 600_000


@dataclass(frozen=True, eq=False, kw_only=True)
class Step:
    """A moment of the search.

    Parameters
    ----------
    stage : str
        As :class:`~moseg_core.search.incumbents.Incumbent` calls it.
    evaluations : int
    cost : Cost
    labels : (F,) int
        Of the shape's elements.
    places : (c, 3) float, model units
        Of the centres, on or near the shape as the user gave it.
    parts : (c,) int
        The part of each centre.
    """

    stage: str
    evaluations: int
    cost: Cost
    labels: IntArray
    places: FloatArray
    parts: IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class SearchSteps:
    """How a search went.

    Parameters
    ----------
    before : tuple of Step
        From the start on.
    last : Incumbent
        The result.
    refined : bool
        Whether its boundaries were moved after the search.
    """

    before: tuple[Step, ...]
    last: Incumbent
    refined: bool


def search_steps(result: Result) -> SearchSteps | None:
    """The steps of the search that led to a result.

    Parameters
    ----------
    result : Result

    Returns
    -------
    SearchSteps or None
        None where the result knows of none, is one of several levels, or has a parameterization
        that is not there any more.
    """
    before = result.incumbents[:-1]
    if not before or isinstance(result.problem, Hierarchy):
        return None
    try:
        steps = _partitioned(result, before)
    except MosegError:  # a page without steps is better than none
        return None
    return SearchSteps(before=steps, last=result.incumbents[-1], refined=result.refined)


def _partitioned(result: Result, before: Sequence[Incumbent]) -> tuple[Step, ...]:
    problem = result.problem
    assert not isinstance(problem, Hierarchy)
    share = float(result.method.get("ignore_pieces_below", 0.0))
    kept = without_small_pieces(result.shape, share) if share > 0.0 else None
    shape = result.shape if kept is None else kept.shape
    searched = problem.embed(shape)
    level = searched_shape(searched, _MOST_ELEMENTS, NO_PINS)
    choice = Choice.read(result.method["parameterization"], "parameterization")
    ready = prepare(choice, "parameterization", problem.registry)
    partition = make_partition(ready, level, problem)
    labels = partition.labels(np.array([partition.encode(step.centers) for step in before]))
    if level is not searched and level.members is not None:
        labels = labels[:, level.members]
    if kept is not None:
        labels = labels[:, kept.nearest]
    steps = []
    for step, row in zip(before, labels, strict=True):
        places = step.centers.positions
        if problem.embedding is not None:  # where the nearest element is in the shape as it was
            away = searched.points[None] - places[:, None]
            places = shape.points[np.argmin((away**2).sum(axis=2), axis=1)]
        parts = step.centers.parts
        steps.append(
            Step(
                stage=step.stage,
                evaluations=step.evaluations,
                cost=step.cost,
                labels=row,
                places=places,
                parts=np.arange(len(places)) if parts is None else parts,
            )
        )
    return tuple(steps)


def packed_changes(
    steps: Sequence[Step], drawn: IntArray, labels: IntArray, *, most_bytes: int = MOST_BYTES
) -> list[tuple[Step, str]]:
    """Steps with what is different from the one after them, in base64; the last from the result.

    Parameters
    ----------
    steps : sequence of Step
    drawn : (T,) int
        The element of the shape that each triangle or point on the page is of.
    labels : (T,) int
        Of these, in the result.
    most_bytes : int
        Where they would take more, steps are left out.
    """
    kept = list(steps)
    while True:
        rows = [step.labels[drawn] for step in kept]
        following = [*rows[1:], labels] if rows else []
        packed = [
            base64.b64encode(runs(after, row)).decode("ascii")
            for row, after in zip(rows, following, strict=True)
        ]
        if sum(map(len, packed)) <= most_bytes or len(kept) < 2:
            return list(zip(kept, packed, strict=True))
        kept = thinned(kept, max(2, len(kept) // 2)) if len(kept) > 2 else kept[:1]


def runs(base: IntArray, labels: IntArray) -> bytes:
    """Where labels are others than in a base, as runs: how many are alike, how many not, the label.

    Whole numbers of seven bits a byte, the least first; the eighth says that more follow (LEB128).

    Examples
    --------
    >>> runs(np.array([0, 0, 0, 0, 0]), np.array([0, 0, 3, 3, 0])).hex(" ")
    '02 02 03'
    >>> runs(np.zeros(400, int), np.repeat([0, 1], 200)).hex(" ")
    'c8 01 c8 01 01'
    """
    changed = np.flatnonzero(base != labels)
    if len(changed) == 0:
        return b""
    new = labels[changed]
    first = np.flatnonzero(np.concatenate([[True], (np.diff(changed) > 1) | (np.diff(new) != 0)]))
    starts, lengths = changed[first], np.diff([*first, len(changed)])
    skipped = starts - np.concatenate([[0], (starts + lengths)[:-1]])
    return _leb128(np.column_stack([skipped, lengths, new[first]]).reshape(-1))


def _leb128(numbers: IntArray) -> bytes:
    written = bytearray()
    for number in numbers.tolist():
        while number >= 128:
            written.append(number & 127 | 128)
            number >>= 7
        written.append(number)
    return bytes(written)
