"""The aggregate objective: the weighted sum of all terms on a segmentation (Sec. 3).

The values of calls (:mod:`moseg_core.problem.calls`) are added up in the order written: calls
within a term, times the weight, then term after term. Rounding is monotone, so replacing values by
lower bounds in that same sum gives a lower bound of the cost to the last bit;
:mod:`moseg_core.search.evaluator` uses this to leave out what cannot matter.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from moseg_core.components.cost import Cost
from moseg_core.components.detail import Detail
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.binding import BoundTerm
from moseg_core.problem.calls import call_details, empty_parts, term_values

Values = list[list[float | None]]
"""Per term and call the value, or None where it is not known or left out."""


@dataclass(frozen=True, kw_only=True)
class CallValue:
    """The value of an objective for certain parts.

    Parameters
    ----------
    labels : tuple of str
        The parts' labels; empty for a global objective.
    value : float or None
        None where the term is left out because one of the parts is empty.
    details : tuple of Detail
        What the value comes from, where the objective tells.
    """

    labels: tuple[str, ...]
    value: float | None
    details: tuple[Detail, ...] = ()


@dataclass(frozen=True, kw_only=True)
class TermValue:
    """A term and what it comes to.

    Parameters
    ----------
    text : str
        As in the expression, without the weight: ``narrow(leg*)``.
    objective : str
        Id of the objective.
    weight : float
    calls : tuple of CallValue
    worst : float
        The greatest value that the objective can take, or the least where the weight is negative.
    """

    text: str
    objective: str
    weight: float
    calls: tuple[CallValue, ...]
    worst: float

    @property
    def value(self) -> float:
        """Sum over the calls, without the weight."""
        total = 0.0
        for call in self.calls:
            total += 0.0 if call.value is None else call.value
        return total

    @property
    def weighted(self) -> float:
        """What the term adds to the cost."""
        return self.weight * self.value

    @property
    def at_worst(self) -> tuple[CallValue, ...]:
        """The calls whose value is as bad as the objective can say."""
        return tuple(
            call
            for call in self.calls
            if call.value is not None and math.isclose(call.value, self.worst, rel_tol=1e-9)
        )


@dataclass(frozen=True, kw_only=True)
class Evaluation:
    """The cost of one segmentation, by term and part.

    Parameters
    ----------
    cost : Cost
    terms : tuple of TermValue
    empty : tuple of str
        Labels without a part to speak of.
    broken_pins : int
        Number of pinned elements that bear another label than theirs.
    """

    cost: Cost
    terms: tuple[TermValue, ...]
    empty: tuple[str, ...] = ()
    broken_pins: int = 0

    @property
    def disagreements(self) -> dict[tuple[str, ...], Detail]:
        """For each part, or group of parts, that a term looks at the detail that costs most.

        By labels, in the order of the terms; without those of which no detail costs anything.
        """
        most: dict[tuple[str, ...], tuple[float, Detail]] = {}
        for term in self.terms:
            for call in term.calls:
                for detail in call.details:
                    cost = term.weight * detail.cost
                    if cost > most.get(call.labels, (0.0,))[0]:
                        most[call.labels] = cost, detail
        return {labels: detail for labels, (_, detail) in most.items()}


def evaluate_segmentation(
    terms: Sequence[BoundTerm],
    labels: Sequence[str],
    segmentation: Segmentation,
    *,
    broken_pins: int = 0,
    detailed: bool = False,
) -> Evaluation:
    """Evaluate every term.

    Parameters
    ----------
    terms : sequence of BoundTerm
    labels : sequence of str
        Name of each part.
    segmentation : Segmentation
    broken_pins : int
        To be counted with the empty parts.
    detailed : bool
        Whether objectives are to tell what their values come from.
    """
    empty = empty_parts(terms, segmentation)
    values: Values = [term_values(term, segmentation, empty, labels) for term in terms]

    def details(term: BoundTerm, call: tuple[int, ...]) -> tuple[Detail, ...]:
        return call_details(term, call, segmentation) if detailed else ()

    return evaluation_of(terms, labels, values, empty, broken_pins=broken_pins, details=details)


def evaluation_of(
    terms: Sequence[BoundTerm],
    labels: Sequence[str],
    values: Values,
    empty: Sequence[bool],
    *,
    broken_pins: int = 0,
    details: Callable[[BoundTerm, tuple[int, ...]], tuple[Detail, ...]] | None = None,
) -> Evaluation:
    """The evaluation that values of all calls make.

    Parameters
    ----------
    terms : sequence of BoundTerm
    labels : sequence of str
        Name of each part.
    values : list of list of float or None
        Per term and call.
    empty : sequence of bool
        Which parts are empty.
    broken_pins : int
        To be counted with the empty parts.
    details : callable, optional
        What the value of a call comes from.
    """
    reported = tuple(
        TermValue(
            text=term.term.call,
            objective=term.id,
            weight=term.weight,
            calls=tuple(
                CallValue(
                    labels=tuple(labels[k] for k in call),
                    value=value,
                    details=() if details is None or value is None else details(term, call),
                )
                for call, value in zip(term.calls, row, strict=True)
            ),
            worst=term.objective.traits.range[1 if term.weight > 0 else 0],
        )
        for term, row in zip(terms, values, strict=True)
    )
    return Evaluation(
        cost=Cost(sum(empty) + broken_pins, weighted_sum(terms, values)),
        terms=reported,
        empty=tuple(name for name, gone in zip(labels, empty, strict=True) if gone),
        broken_pins=broken_pins,
    )


def weighted_sum(terms: Sequence[BoundTerm], values: Values) -> float:
    """Sum of weight times value over all terms; what is None counts nothing."""
    total = 0.0
    for term, row in zip(terms, values, strict=True):
        inner = 0.0
        for value in row:
            if value is not None:
                inner += value
        total += term.weight * inner
    return total
