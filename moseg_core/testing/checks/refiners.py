"""Checks of refiners: a labelling with its boundaries moved, no part lost, pins obeyed.

What a refiner returns is the result: its labels are written to files, and objectives are asked
about its parts. So it is a labelling by the problem's labels, each of which keeps its part, and
what the user has pinned stays pinned. Refiners are tried with one label, with some, and with a part
of a single element, which whatever smooths boundaries likes to swallow.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from moseg_core.components.protocols import Progress, Report, never_stop
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.pins import Pins
from moseg_core.testing.check import ContractFailure, Subject, check
from moseg_core.testing.fixtures.problems import evaluator_on, labellings
from moseg_core.testing.fixtures.shapes import lump
from moseg_core.testing.fixtures.trial import made
from moseg_core.types import Int32Array


def _labellings() -> Iterator[tuple[str, ProblemEvaluator, Int32Array]]:
    for n in (1, 2, 3, 4):
        evaluator = evaluator_on(lump(), n)
        for labels in labellings(evaluator, 2):
            yield f"{n} label{'s' * (n > 1)} on a lump", evaluator, labels
    evaluator = evaluator_on(lump(), 2)
    labels = np.zeros(evaluator.shape.n_elements, np.int32)
    labels[7] = 1
    yield "2 labels on a lump, one of them of a single face", evaluator, labels


def _refined(
    subject: Subject,
    evaluator: ProblemEvaluator,
    labels: Int32Array,
    *,
    report: Report = never_stop,
) -> Any:
    refiner = made(subject, meets=(evaluator,))
    handed = labels.copy()
    handed.flags.writeable = False
    return refiner(evaluator, handed, report=report)


def _refinements(subject: Subject) -> Iterator[tuple[str, int, Int32Array, np.ndarray]]:
    """What it is asked, the number of labels, the labelling before, and what is returned."""
    for what, evaluator, labels in _labellings():
        found = np.asarray(_refined(subject, evaluator, labels))
        yield f"it was asked to refine {what}", evaluator.parameterization.n_parts, labels, found


def _is_labelling(found: np.ndarray, labels: Int32Array, n: int) -> bool:
    fits = found.shape == labels.shape and np.issubdtype(found.dtype, np.integer)
    return bool(fits and found.min() >= 0 and found.max() < n)


@check("refiner-labels", kinds=["refiner"])
def _labels(subject: Subject) -> None:
    """Parts are made of the labels, and a label that there is not would be written as one."""
    for did, n, labels, found in _refinements(subject):
        if not _is_labelling(found, labels, n):
            span = f" from {found.min()} to {found.max()}" if found.size and found.ndim else ""
            raise ContractFailure(
                did=did,
                got=f"an array of {found.dtype} of shape {found.shape}{span}",
                expected=f"labels from 0 to {n - 1} as an array of int of shape {labels.shape}",
                fix="return a label for every element of evaluator.shape, in its order",
            )


@check("refiner-keeps-parts", kinds=["refiner"])
def _keeps_parts(subject: Subject) -> None:
    """A part that is smoothed away is missing from the result, and was asked for by name."""
    for did, n, labels, found in _refinements(subject):
        if not _is_labelling(found, labels, n):
            continue  # refiner-labels says so
        lost = np.setdiff1d(labels, found)
        if lost.size:
            raise ContractFailure(
                did=did,
                got=f"no element with the label {lost[0]}, which had {(labels == lost[0]).sum()}",
                expected=f"elements with each of the labels 0 to {labels.max()}",
                fix="leave a part some elements, such as those far from its boundary, or as it was",
            )


@check("refiner-obeys-pins", kinds=["refiner"])
def _obeys_pins(subject: Subject) -> None:
    """The user has said which label an element bears, and no boundary may be moved across it."""
    for what, evaluator, labels in _labellings():
        n = evaluator.parameterization.n_parts
        pairs = evaluator.shape.adjacency.pairs  # type: ignore[union-attr]  # a mesh has neighbours
        pinned = np.unique(pairs[labels[pairs[:, 0]] != labels[pairs[:, 1]]])
        pins = Pins(elements=pinned, labels=labels[pinned].astype(np.int64))
        found = np.asarray(_refined(subject, evaluator_on(lump(), n, pins=pins), labels))
        if _is_labelling(found, labels, n) and pins.broken(found):
            k = pinned[int(np.argmax(found[pinned] != labels[pinned]))]
            raise ContractFailure(
                did=f"it was asked to refine {what}, all faces along boundaries pinned",
                got=f"label {found[k]} for face {k}, which is pinned to {labels[k]}",
                expected="its own label for every pinned face",
                fix="look at evaluator.pins: elements, and the label of each",
            )


@check("refiner-heeds-report", kinds=["refiner"])
def _heeds(subject: Subject) -> None:
    """Who reports progress is told when time is up; going on keeps the user waiting."""
    for what, evaluator, labels in _labellings():
        reports: list[Progress] = []

        def stop(progress: Progress, reports: list[Progress] = reports) -> bool:
            reports.append(progress)
            return True

        _refined(subject, evaluator, labels, report=stop)
        if len(reports) > 1:
            raise ContractFailure(
                did=f"it was asked to refine {what}, and to stop at its first report",
                got=f"{len(reports) - 1} more reports",
                expected="the labels as far as they are refined, at once",
                fix="return when report(...) is true",
            )
