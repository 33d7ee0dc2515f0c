"""What a run is asked for, checked and made ready before its work begins.

Everything that can be wrong with a request is found here: components and their parameters first,
then labels that are named, the start, and whether the shape has what the objectives need. The shape
is embedded (Sec. 9), and an evaluator made for its own elements; the search is made of it by
:mod:`moseg_core.search.segment`, what comes after the search by
:mod:`moseg_core.search.last_steps`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy.typing as npt

from moseg_core.components.chosen import PreparedComponent, prepare
from moseg_core.components.discovery.specs import Kind
from moseg_core.components.protocols import Centers
from moseg_core.errors import UsageError, unknown
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import (
    CHOSEN_KINDS,
    Method,
    SearchOptions,
    SettledOptions,
    check_method,
)
from moseg_core.search.alignment import Alignment
from moseg_core.search.checked_partition import make_partition
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.result import Result
from moseg_core.search.start_centers import check_counts, start_centers
from moseg_core.shape.pins import read_pins
from moseg_core.shape.shape import Shape


@dataclass(frozen=True, eq=False, kw_only=True)
class Request:
    """A run that can begin.

    Parameters
    ----------
    settled : SettledOptions
    ready : mapping of kind to PreparedComponent
    whole : ProblemEvaluator
        On the shape's own elements.
    start : Centers or None
        In the problem's order.
    frozen : sequence of int
        Labels whose centres stay where they start.
    warnings : sequence of str
        What the user should know of the start.
    """

    settled: SettledOptions
    ready: Mapping[Kind, PreparedComponent]
    whole: ProblemEvaluator
    start: Centers | None
    frozen: Sequence[int]
    warnings: Sequence[str]

    @classmethod
    def of(
        cls,
        shape: Shape,
        problem: Problem,
        options: SearchOptions,
        *,
        defaults: Method | None = None,
        start: Centers | Result | Alignment | None = None,
        freeze: Sequence[str] = (),
        pins: Mapping[str, npt.ArrayLike] | None = None,
    ) -> Request:
        """Check what :func:`moseg_core.segment` is given, and make it ready.

        Raises
        ------
        UsageError, ShapeError, PluginError
            As for :func:`moseg_core.segment`.
        """
        if isinstance(problem, Hierarchy):
            raise UsageError("segment takes one Problem; give a Hierarchy to segment_hierarchy")
        if not isinstance(problem, Problem):
            raise UsageError(
                f"segment takes a Problem, not {problem!r:.60}; give a recipe to segment_variants"
            )
        if defaults is not None:
            check_method(defaults, "defaults")
        settled = options.settled(defaults)
        ready = prepare_components(problem, settled)
        settled.check_resolution(len(problem.labels))
        frozen = check_frozen(problem, freeze)
        centers = start_centers(start, problem)
        pinned = read_pins(pins or {}, problem.labels, shape.n_elements)
        embedded = problem.embed(shape)
        partition = make_partition(ready["parameterization"], embedded, problem)
        whole = ProblemEvaluator(embedded, problem, partition, pins=pinned)
        if centers is not None:
            check_counts(centers, partition.centers_per_part, problem.labels)
        return cls(
            settled=settled,
            ready=ready,
            whole=whole,
            start=centers,
            frozen=frozen,
            warnings=start.warnings if isinstance(start, Alignment) else (),
        )

    @property
    def exchanges(self) -> bool:
        """Whether labels are exchanged where that costs less (:mod:`moseg_core.search.exchange`).

        The paper has no exchanges.
        """
        return self.settled.settings != "paper"


def check_frozen(problem: Problem, freeze: Sequence[str]) -> list[int]:
    """Indices of the labels to freeze.

    Raises
    ------
    UsageError
        An unknown label, or a text instead of a list.
    """
    if isinstance(freeze, str):
        raise UsageError(f"freeze must be a list of labels, not the text '{freeze}'")
    for name in freeze:
        if name not in problem.labels:
            raise UsageError(f"freeze: {unknown('label', name, problem.labels)}")
    return [problem.labels.index(name) for name in freeze]


def prepare_components(problem: Problem, options: SettledOptions) -> dict[Kind, PreparedComponent]:
    """Find, load and check the components of a run, tuned to the settings.

    There is a refiner among them only where one was asked for.

    Parameters
    ----------
    problem : Problem
        Says where to look.
    options : SettledOptions

    Raises
    ------
    UsageError, PluginError
        See :func:`moseg_core.components.chosen.prepare`.
    """
    chosen = {kind: getattr(options, kind) for kind in CHOSEN_KINDS}
    found = {
        kind: prepare(choice, kind, problem.registry)
        for kind, choice in chosen.items()
        if choice is not None
    }
    if options.settings != "default":
        return found
    return {kind: component.tuned("default") for kind, component in found.items()}
