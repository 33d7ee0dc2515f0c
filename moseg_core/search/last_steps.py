"""What is done with a result once its search is over: a refiner moves boundaries, labels exchange.

:func:`moseg_core.segment` takes these steps with what its search has found. They are about input
elements, so that they take longer the more of these there are; and of several problems for one
shape, such as those of a recipe's label sets (:mod:`moseg_core.search.variants`), only one result
is wanted in the end. There the searches go without them, and they are taken with the result that is
chosen. Which that is they hardly ever change: on 95 models, with label sets learned from four
others, the choice before the refiner agreed with people as well as the choice after it.

A refiner is checked when the steps are made, so that what is wrong with it is known before the
search.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from moseg_core.components.protocols import Centers, Report
from moseg_core.errors import MosegError
from moseg_core.search.exchange import best_order
from moseg_core.search.incumbents import ended_with
from moseg_core.search.refinement import ReadyRefiner, Refinement
from moseg_core.search.request import Request
from moseg_core.search.restarts import Listener
from moseg_core.search.result import REFINE, Result, find_warnings


@dataclass(frozen=True, eq=False, kw_only=True)
class LastSteps:
    """The refiner, if there is one, and the last exchange of labels.

    Parameters
    ----------
    request : Request
        What the result was found for.
    refiner : ReadyRefiner or None
    lacking : str
        What the refiner has said that it goes without.
    """

    request: Request
    refiner: ReadyRefiner | None
    lacking: str

    @classmethod
    def of(cls, request: Request) -> LastSteps:
        """The steps, the refiner made and checked.

        Raises
        ------
        MosegError
            It cannot be made of its parameters, or cannot work on this shape.
        """
        if "refiner" not in request.ready:
            return cls(request=request, refiner=None, lacking="")
        refiner = ReadyRefiner.of(request.ready["refiner"])
        return cls(request=request, refiner=refiner, lacking=refiner.check(request.whole))

    def taken(self, result: Result, listener: Listener, *, report: Report) -> Result:
        """The result after these steps.

        Parameters
        ----------
        result : Result
            Of the request's problem, on its shape.
        listener : Listener
            Knows whether the user has asked to stop; nothing is done any more then.
        report : callable
            Receives progress; True ends the refiner.

        Raises
        ------
        MosegError
            A component has failed; the error has the result as its ``result``.
        """
        found = Refinement(labels=result.labels, evaluation=result.evaluation)
        if self.refiner is not None:
            found = self.refiner.refine(
                self.request.whole,
                found,
                report=report,
                interrupted=listener.stopped,
                warning=self.lacking,
            )
        centers = result.centers
        if found.failure is None and not listener.stopped:
            centers, found = self._exchanged(centers, found)
        is_as_it_was = found.labels is result.labels and found.failure is None
        if is_as_it_was and not (found.warning or listener.stopped):
            return result
        ended = self._result(result, centers, found, interrupted=listener.stopped)
        if found.failure is not None:
            found.failure.result = ended
            raise found.failure
        return ended

    def _exchanged(self, centers: Centers, found: Refinement) -> tuple[Centers, Refinement]:
        """Centres and labels after an exchange of labels; what a refiner moved may call for it.

        Where an exchange is about labels of different numbers of centres, no vector is sure to have
        its partition, and the centres are only near.
        """
        whole, names = self.request.whole, self.request.whole.problem.labels
        vector = whole.parameterization.encode(centers)
        try:
            order = best_order(whole, vector, found.labels, frozen=self.request.frozen)
            if (order == np.arange(len(order))).all():
                return centers, found
            labels = np.argsort(order).astype(np.int32)[found.labels]
            evaluation = whole.evaluate_labels(labels)
        except MosegError as error:
            return centers, replace(found, failure=error)
        if not self.request.exchanges:
            moved = [f"'{names[k]}'" for k in np.flatnonzero(order != np.arange(len(order)))]
            said = (
                f"exchanging the labels {', '.join(moved[:-1])} and {moved[-1]} would lower the"
                f" cost from {found.evaluation.cost.value:.4g} to {evaluation.cost.value:.4g};"
                " --settings default does so"
            )
            warning = "; ".join(filter(None, [found.warning, said]))
            return centers, replace(found, warning=warning)
        moved_centers = whole.parameterization.decode(whole.parameterization.permute(vector, order))
        return moved_centers, replace(found, labels=labels, evaluation=evaluation)

    def _result(
        self, result: Result, centers: Centers, found: Refinement, *, interrupted: bool
    ) -> Result:
        """The result with labels, cost and centres as they are now, and what there is to say."""
        whole = self.request.whole
        reason = result.reason
        if found.failure is not None:
            reason = "failed"
        elif interrupted:
            reason = "interrupted"
        names = whole.problem.labels
        told = find_warnings(result.evaluation, result.segmentation, names, result.reason)
        segmentation = whole.segmentation(found.labels).view(result.shape.space)
        warnings = [*find_warnings(found.evaluation, segmentation, names, reason)]
        warnings += [text for text in result.warnings if text not in told]
        warnings += [found.warning] if found.warning else []
        history = {**result.history, **({REFINE: found.history} if found.history else {})}
        return replace(
            result,
            labels=found.labels,
            evaluation=found.evaluation,
            centers=centers,
            history=history,
            incumbents=ended_with(
                result.incumbents,
                cost=found.evaluation.cost,
                centers=centers,
                size=whole.shape.frame.scale,
            ),
            reason=reason,
            warnings=tuple(warnings),
        )
