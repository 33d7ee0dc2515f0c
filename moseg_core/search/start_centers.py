"""Where a search begins that somebody has given a start: centres in the order of the problem.

A start is centres, an earlier result, or one that was laid onto this shape
(:mod:`moseg_core.search.alignment`). It fits a problem if it is in the same space (Sec. 9), has the
same labels, and one centre for each or as many as the parameterization has.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from moseg_core.components.chosen import Choice
from moseg_core.components.protocols import Centers
from moseg_core.errors import UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import ORIGINAL, Problem
from moseg_core.search.alignment import Alignment
from moseg_core.search.result import Result
from moseg_core.types import IntArray


def start_centers(start: Centers | Result | Alignment | None, problem: Problem) -> Centers | None:
    """Centres in the problem's order, or a UsageError where they do not fit it."""
    if isinstance(start, Alignment):
        start = matched_centers(start.labels, start.centers, problem, embedding=start.embedding)
    if isinstance(start, Result):
        if isinstance(start.problem, Hierarchy):
            raise UsageError(
                "the start is a result of several levels, whose centres belong to different"
                " partitions; start from a result of one level, such as result.levels['']"
            )
        embedding = start.problem.embedding
        start = matched_centers(start.problem.labels, start.centers, problem, embedding=embedding)
    n = len(problem.labels)
    if start is not None and not isinstance(start, Centers):
        raise UsageError(f"the start must be Centers, a Result or an Alignment, not {start!r:.60}")
    if start is None:
        return None
    parts = np.arange(n) if start.parts is None else np.asarray(start.parts)
    count = len(parts) if parts.ndim == 1 else 0
    if np.shape(start.positions) != (count, 3) or np.shape(start.weights) != (count,):
        raise UsageError(f"the start needs a centre and a weight for each of {n} labels")
    if parts.dtype.kind not in "iu" or np.unique(parts).tolist() != [*range(n)]:
        raise UsageError(f"the start must say for each centre which of {n} labels it belongs to")
    order = np.argsort(parts, kind="stable")
    return Centers(
        positions=np.asarray(start.positions)[order],
        weights=np.asarray(start.weights)[order],
        parts=None if count == n else parts[order].astype(np.int64),
    )


def check_counts(start: Centers, allowed: IntArray, labels: Sequence[str]) -> None:
    """Refuse a start that has another number of centres for a label than the parameterization.

    One for each label is a start for all.
    """
    given = start.per_part
    if (given == 1).all() or (given == allowed).all():
        return
    k = int(np.flatnonzero(given != allowed)[0])
    raise UsageError(
        f"the start has {given[k]} centres for label '{labels[k]}', and the parameterization"
        f" {allowed[k]}; give as many, such as --parameterization"
        f""" 'voronoi(centers="{_counted(given, labels)}")', or begin without a start"""
    )


def _counted(counts: IntArray, labels: Sequence[str]) -> str:
    """How many centres labels have, where it is not one."""
    return ",".join(f"{name}={c}" for name, c in zip(labels, counts, strict=True) if c > 1)


def matched_centers(
    names: Sequence[str],
    centers: Centers,
    problem: Problem,
    *,
    embedding: str | Choice | None = None,
) -> Centers:
    """The centres of an earlier result in the order of a problem's labels.

    Parameters
    ----------
    names : sequence of str
        The labels of the earlier result.
    centers : Centers
    problem : Problem
    embedding : str, Choice or None
        That of the earlier result.

    Raises
    ------
    UsageError
        The two do not have the same labels, or their partitions are in different spaces.
    """
    there, here = (
        ORIGINAL if choice is None else Choice.read(choice, "embedding").name.rpartition(":")[2]
        for choice in (embedding, problem.embedding)
    )
    if there != here:
        raise UsageError(
            f"the start has its centres in the space '{there}', and the partition is to be found in"
            f" '{here}'; go on in the same space (--embedding"
            f" {'none' if embedding is None else embedding}), or begin without a start"
        )
    if sorted(names) != sorted(problem.labels):
        raise UsageError(
            f"the start has the labels {', '.join(names)}; the problem has"
            f" {', '.join(problem.labels)}"
        )
    return centers.ordered(np.array([list(names).index(name) for name in problem.labels]))
