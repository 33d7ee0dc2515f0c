"""Boundaries moved once the search is over: a refiner at work, and what it may return.

A search finds centres, and the boundaries between their parts are where a weighted Voronoi diagram
has them: spheres, which pass near a crease and seldom through it. People cut along creases. A
*refiner* (:class:`~moseg_core.components.protocols.Refiner`) takes the labels that the best vector
gives to the input's own elements, and moves boundaries from there. None is used unless the request
or the recipe asks for one: the paper has none.

A refiner is a stranger's code, so what it returns is checked here. Labels and cost of the result
are then those of the refined labelling, and its centres still those of the partition that the
search has found: a start from the result begins there, and boundaries cannot be clipped along
them (:mod:`moseg_core.search.clipped_result`). Where the refiner fails, or the user has asked to
stop before its turn, the labels stay as the search left them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from moseg_core.components.chosen import PreparedComponent
from moseg_core.components.profile import stage
from moseg_core.components.protocols import Refiner, Report
from moseg_core.errors import REPORT, MosegError, PluginError, ShapeError
from moseg_core.problem.aggregate import Evaluation
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.labels import checked_labels
from moseg_core.types import Int32Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Refinement:
    """A labelling and its cost, and how they came from those that the search had found.

    Parameters
    ----------
    labels : (F,) int32
    evaluation : Evaluation
        Of these labels.
    history : tuple of dict
        The cost before and after, each with the number of elements that have changed their part
        by then; empty where nothing was refined.
    warning : str
        Why nothing was refined, where something was to be; or what the refiner went without.
    failure : MosegError or None
        What the refiner, or the evaluation of its labels, ended with.
    """

    labels: Int32Array
    evaluation: Evaluation
    history: tuple[dict[str, float], ...] = ()
    warning: str = ""
    failure: MosegError | None = None


MUCH_DEARER = 1.5
"""How many times as high the cost of refined labels may be before it is worth a warning."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ReadyRefiner:
    """A refiner that was made before the search: what is wrong with it is told at once.

    Parameters
    ----------
    ready : PreparedComponent
    refiner : Refiner
    """

    ready: PreparedComponent
    refiner: Refiner

    @classmethod
    def of(cls, ready: PreparedComponent) -> ReadyRefiner:
        """The component, made.

        Raises
        ------
        PluginError, UsageError
            It cannot be made of its parameters.
        """
        return cls(ready=ready, refiner=ready.make())

    def check(self, evaluator: ProblemEvaluator) -> str:
        """Ask the refiner, if it can say so, whether it can work on this.

        Returns
        -------
        str
            What the user should know of it; empty where all is well.

        Raises
        ------
        MosegError
            It cannot, and says why.
        """
        probe = getattr(self.refiner, "check", None)
        if probe is None:
            return ""
        with self.ready.guard():
            said = probe(evaluator)
        return said if isinstance(said, str) else ""

    @stage("refine")
    def refine(
        self,
        evaluator: ProblemEvaluator,
        found: Refinement,
        *,
        report: Report,
        interrupted: bool = False,
        warning: str = "",
    ) -> Refinement:
        """Move the boundaries of a labelling, or say why they stay where they are.

        Parameters
        ----------
        evaluator : ProblemEvaluator
            On the input's own elements.
        found : Refinement
            What the search has found, not refined yet.
        report : callable
        interrupted : bool
            Whether the user has asked to stop, so that this is left out.
        warning : str
            What :meth:`check` has said.
        """
        if interrupted:
            return replace(
                found, warning="the boundaries are not refined, since the run was interrupted"
            )
        try:
            labels = self._labels(evaluator, found.labels, report)
            evaluation = evaluator.evaluate_labels(labels)
        except MosegError as error:
            reason = f"the boundaries are not refined: {error}"
            return replace(found, warning=reason, failure=error)
        moved = int((labels != found.labels).sum())
        history = _record(found.evaluation, 0), _record(evaluation, moved)
        before, after = found.evaluation.cost.value, evaluation.cost.value
        if after > MUCH_DEARER * before > 0.0:
            dearer = (
                f"the refiner has raised the cost from {before:.4g} to {after:.4g}; look at the"
                " boundaries, or leave it out: --refiner none"
            )
            warning = "; ".join(filter(None, [warning, dearer]))
        return Refinement(labels=labels, evaluation=evaluation, history=history, warning=warning)

    def _labels(
        self, evaluator: ProblemEvaluator, labels: Int32Array, report: Report
    ) -> Int32Array:
        """Run the refiner, and check what it returns."""
        handed = labels.copy()
        handed.flags.writeable = False
        with self.ready.guard():
            answer = self.refiner(evaluator, handed, report=report)
        refined = self._checked(evaluator, answer)
        names, pins, shape = evaluator.problem.labels, evaluator.pins, evaluator.shape
        lost = evaluator.segmentation(refined).summary.empty(shape)
        lost &= ~evaluator.segmentation(labels).summary.empty(shape)
        if lost.any():
            raise self._broken(f"left nothing of the part '{names[int(lost.argmax())]}'")
        of = pins.elements
        strayed = (refined[of] != pins.labels) & (refined[of] != labels[of])
        if strayed.any():
            k = int(strayed.argmax())
            raise self._broken(
                f"gave the label '{names[refined[of[k]]]}' to element {of[k]}, which is pinned to"
                f" '{names[pins.labels[k]]}'"
            )
        return refined

    def _checked(self, evaluator: ProblemEvaluator, answer: Any) -> Int32Array:
        """(F,) int32: what was returned, if it is a labelling."""
        try:
            found = checked_labels(evaluator.shape, answer, len(evaluator.problem.labels))
        except ShapeError as error:
            raise self._broken(f"must return a labelling: {error}") from error
        return np.array(found, dtype=np.int32, order="C")

    def _broken(self, how: str) -> PluginError:
        return PluginError(f"{self.ready.who} {how}; {REPORT}")


def _record(evaluation: Evaluation, moved: int) -> dict[str, float]:
    """A record of the history."""
    cost = evaluation.cost
    return {"value": cost.value, "empty": cost.empty, "moved": moved}
