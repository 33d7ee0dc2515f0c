"""Checks of seeders: one centre per label, on or near the shape, the same for the same seed.

Weights, where a seeder gives any, are positive and finite, one for each centre.

A search ends near where it began, so what a seeder returns decides much of the result (Sec. 5).
Two centres in one place leave a part empty, and centres far away make one part of everything: no
objective can say anything of either. Seeders are tried with one label, with some, and with as
many as there are elements.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from moseg_core.components.protocols import Progress, Report, Seeding, never_stop
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.testing.check import ContractFailure, Subject, check
from moseg_core.testing.fixtures.comparison import as_numbers, expect_equal
from moseg_core.testing.fixtures.problems import evaluator_on
from moseg_core.testing.fixtures.shapes import lump
from moseg_core.testing.fixtures.trial import made
from moseg_core.types import FloatArray

#: How far outside of the box a centre may be, in diagonals of the box.
_NEAR = 0.1
_APART = 1e-9


def _problems() -> Iterator[tuple[str, ProblemEvaluator]]:
    yield "1 label on a lump", evaluator_on(lump(), 1)
    yield "3 labels on a lump", evaluator_on(lump(), 3)
    yield "4 labels on a lump", evaluator_on(lump(), 4)
    yield "8 labels on a lump of 8 faces", evaluator_on(lump(0), 8)


def _seeded(
    subject: Subject, evaluator: ProblemEvaluator, *, report: Report = never_stop
) -> Seeding:
    seeder = made(subject, meets=(evaluator,))
    found: Seeding = seeder(evaluator, rng=np.random.default_rng(0), report=report)
    return found


def _centers(subject: Subject) -> Iterator[tuple[str, ProblemEvaluator, FloatArray]]:
    for what, evaluator in _problems():
        centers = as_numbers(getattr(_seeded(subject, evaluator), "centers", None))
        if centers.ndim == 2 and centers.shape[1] == 3:  # if not, seeder-count says so
            yield f"it was asked to seed {what}", evaluator, centers


@check("seeder-count", kinds=["seeder"])
def _count(subject: Subject) -> None:
    """Every label needs a centre to begin with, be there one label or one for each element."""
    for what, evaluator in _problems():
        found = _seeded(subject, evaluator)
        n = evaluator.parameterization.n_parts
        centers = as_numbers(getattr(found, "centers", None))
        one_each = isinstance(found, Seeding) and centers.shape == (n, 3)
        if not (one_each and np.isfinite(centers).all()):
            raise ContractFailure(
                did=f"it was asked to seed {what}",
                got=f"a {type(found).__name__} with centres of shape {centers.shape}"
                + (", some of them not finite" if one_each else ""),
                expected=f"a moseg_core.Seeding with finite centers of shape ({n}, 3)",
                fix="place one centre per label of evaluator.problem.labels; look for a mean over"
                " nothing, or a division by an area of 0",
            )


@check("seeder-distinct", kinds=["seeder"])
def _distinct(subject: Subject) -> None:
    """Two centres in one place leave a part empty, which no objective can say anything of."""
    for did, evaluator, centers in _centers(subject):
        far = np.linalg.norm(centers[:, None] - centers, axis=2)
        np.fill_diagonal(far, np.inf)
        if far.min(initial=np.inf) <= _APART * evaluator.shape.frame.scale:
            i, j = np.unravel_index(far.argmin(), far.shape)
            raise ContractFailure(
                did=did,
                got=f"centres {i} and {j} both at {centers[i].round(6).tolist()}",
                expected="no two in one place",
                fix="draw elements without replacement",
            )


@check("seeder-near-shape", kinds=["seeder"])
def _near(subject: Subject) -> None:
    """A centre far from the shape gets no part, or all of it, and the search begins lost."""
    for did, evaluator, centers in _centers(subject):
        points, size = evaluator.shape.geometry.vertices, evaluator.shape.frame.scale
        inside = centers.clip(points.min(axis=0), points.max(axis=0))
        outside = np.linalg.norm(centers - inside, axis=1) / size
        if outside.max(initial=0.0) > _NEAR:
            k = int(outside.argmax())
            raise ContractFailure(
                did=did,
                got=f"centre {k} at {centers[k].round(3).tolist()}, {outside[k]:.3g} box diagonals"
                " outside the bounding box of the shape",
                expected=f"centres on the shape, or within {_NEAR:g} diagonals of its box",
                fix="return model units, as evaluator.shape.points are; unit coordinates are for"
                " vectors",
            )


@check("seeder-weights", kinds=["seeder"])
def _weights(subject: Subject) -> None:
    """A weight of 0 leaves a part empty, and one that is no number leaves nothing to compare."""
    for what, evaluator in _problems():
        given = getattr(_seeded(subject, evaluator), "weights", None)
        if given is None:
            continue
        n = evaluator.parameterization.n_parts
        weights = as_numbers(given)
        if weights.shape != (n,) or not (np.isfinite(weights) & (weights > 0)).all():
            raise ContractFailure(
                did=f"it was asked to seed {what}",
                got=f"weights of shape {weights.shape}"
                + (f": {weights.round(3).tolist()!s:.60}" if weights.shape == (n,) else ""),
                expected=f"positive, finite weights of shape ({n},), or None where all are 1",
                fix="look for the root or the logarithm of a size of 0; only ratios of weights"
                " matter, so any positive unit will do",
            )


@check("seeder-reproducible", kinds=["seeder"])
def _reproducible(subject: Subject) -> None:
    """A run is repeated with its seed; that is what users quote and compare."""
    for (what, evaluator), (_, other) in zip(_problems(), _problems(), strict=True):
        seeder = made(subject, meets=(evaluator,))
        first, second = (
            _rows(seeder(on, rng=np.random.default_rng(7), report=never_stop))
            for on in (evaluator, other)
        )
        expect_equal(
            first,
            second,
            did=f"it was asked twice to seed {what}, with rng of the same seed",
            got="centres or weights that differ by {}",
            expected="the same, to the bit",
            fix="draw from the rng that it is given and from nothing else; keep nothing of one"
            " call for the next; go through sets in sorted order",
        )


def _rows(seeding: Seeding) -> FloatArray:
    """(n, 3 or 4) float: centres, and their weights where there are any."""
    if getattr(seeding, "weights", None) is None:
        return seeding.centers
    return np.column_stack([seeding.centers, as_numbers(seeding.weights)])


@check("seeder-heeds-report", kinds=["seeder"])
def _heeds(subject: Subject) -> None:
    """Who reports progress is told when time is up; going on keeps the user waiting."""
    for what, evaluator in _problems():
        reports: list[Progress] = []

        def stop(progress: Progress, reports: list[Progress] = reports) -> bool:
            reports.append(progress)
            return True

        _seeded(subject, evaluator, report=stop)
        if len(reports) > 1:
            raise ContractFailure(
                did=f"it was asked to seed {what}, and to stop at its first report",
                got=f"{len(reports) - 1} more reports",
                expected="the best centres found so far, at once",
                fix="return when report(...) is true",
            )
