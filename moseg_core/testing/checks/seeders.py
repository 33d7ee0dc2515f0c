"""Checks of seeders: one centre per label, on or near the shape, the same for the same seed.

A search ends near where it began, so what a seeder returns decides much of the result (Sec. 5).
Two centres in one place leave a part empty, and centres far away make one part of everything: no
objective can say anything of either. Seeders are tried with one label, with some, and with as
many as there are elements.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from moseg_core.components.protocols import Progress, Report, Seeding
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.testing.check import ContractFailure, Subject, check
from moseg_core.testing.fixtures.problems import as_numbers, evaluator, pebble, silent, unlike
from moseg_core.testing.fixtures.trial import values_for
from moseg_core.types import FloatArray

#: How far outside of the box a centre may be, in diagonals of the box.
_NEAR = 0.1
_APART = 1e-9


def _seeded(
    subject: Subject, stage: ProblemEvaluator, *, seed: int = 0, report: Report = silent
) -> Seeding:
    seeder = subject.load()(**values_for(subject, stage))
    found: Seeding = seeder(stage, rng=np.random.default_rng(seed), report=report)
    return found


def _stages() -> Iterator[tuple[str, ProblemEvaluator]]:
    yield "1 label on a pebble", evaluator(1)
    yield "4 labels on a pebble", evaluator(4)
    yield "8 labels on a pebble of 8 faces", evaluator(8, pebble(0))


def _centers(subject: Subject) -> Iterator[tuple[str, ProblemEvaluator, FloatArray]]:
    for what, stage in _stages():
        centers = as_numbers(getattr(_seeded(subject, stage), "centers", None))
        if centers.ndim == 2 and centers.shape[1] == 3:  # if not, seeder-count says so
            yield what, stage, centers


@check(
    "seeder-count",
    kinds=["seeder"],
    why="every label needs a centre to begin with, be there one label or one for each element",
)
def _count(subject: Subject) -> None:
    for what, stage in _stages():
        found = _seeded(subject, stage)
        n = stage.parameterization.n_parts
        centers = as_numbers(getattr(found, "centers", None))
        if not isinstance(found, Seeding) or centers.shape != (n, 3):
            raise ContractFailure(
                did=f"it was asked to seed {what}",
                got=f"a {type(found).__name__} with centres of shape {centers.shape}",
                expected=f"a moseg_core.Seeding with centers of shape ({n}, 3)",
                fix="place one centre per label of evaluator.problem.labels",
            )
        if not np.isfinite(centers).all():
            raise ContractFailure(
                did=f"it was asked to seed {what}",
                got="centres that are not finite",
                expected="places in model units",
                fix="look for a mean over nothing, or a division by an area of 0",
            )


@check(
    "seeder-distinct",
    kinds=["seeder"],
    why="two centres in one place leave a part empty, which no objective can say anything of",
)
def _distinct(subject: Subject) -> None:
    for what, stage, centers in _centers(subject):
        far = np.linalg.norm(centers[:, None] - centers, axis=2) + np.diag(
            np.full(len(centers), np.inf)
        )
        if len(centers) > 1 and far.min() <= _APART * stage.shape.frame.scale:
            i, j = np.unravel_index(far.argmin(), far.shape)
            raise ContractFailure(
                did=f"it was asked to seed {what}",
                got=f"centres {i} and {j} both at {centers[i].round(6).tolist()}",
                expected="no two in one place",
                fix="draw elements without replacement",
            )


@check(
    "seeder-near-shape",
    kinds=["seeder"],
    why="a centre far from the shape gets no part, or all of it, and the search begins lost",
)
def _near(subject: Subject) -> None:
    for what, stage, centers in _centers(subject):
        points, size = stage.shape.geometry.vertices, stage.shape.frame.scale
        low, high = points.min(axis=0), points.max(axis=0)
        outside = np.linalg.norm(centers - centers.clip(low, high), axis=1) / size
        if outside.max(initial=0.0) > _NEAR:
            k = int(outside.argmax())
            raise ContractFailure(
                did=f"it was asked to seed {what}",
                got=f"centre {k} at {centers[k].round(3).tolist()}, {outside[k]:.3g} box diagonals"
                " outside the bounding box of the shape",
                expected=f"centres on the shape, or within {_NEAR:g} diagonals of its box",
                fix="return model units, as evaluator.shape.points are; unit coordinates are for"
                " vectors",
            )


@check(
    "seeder-reproducible",
    kinds=["seeder"],
    why="a run is repeated with its seed; that is what users quote and compare",
)
def _reproducible(subject: Subject) -> None:
    for (what, stage), (_, other) in zip(_stages(), _stages(), strict=True):
        seeder = subject.load()(**values_for(subject, stage))
        first, second = (
            seeder(on, rng=np.random.default_rng(7), report=silent).centers for on in (stage, other)
        )
        difference = unlike(first, second)
        if difference is not None:
            raise ContractFailure(
                did=f"it was asked twice to seed {what}, with rng of the same seed",
                got=f"centres that differ by {difference:.3g}",
                expected="the same, to the bit",
                fix="draw from the rng that it is given and from nothing else; keep nothing of"
                " one call for the next; go through sets in sorted order",
            )


@check(
    "seeder-heeds-report",
    kinds=["seeder"],
    why="who reports progress is told when time is up; going on keeps the user waiting",
)
def _heeds(subject: Subject) -> None:
    for what, stage in _stages():
        asked: list[Progress] = []

        def stop(progress: Progress, asked: list[Progress] = asked) -> bool:
            asked.append(progress)
            return True

        _seeded(subject, stage, report=stop)
        if len(asked) > 1:
            raise ContractFailure(
                did=f"it was asked to seed {what}, and to stop at its first report",
                got=f"{len(asked) - 1} more reports",
                expected="the best centres found so far, at once",
                fix="return when report(...) is true",
            )
