"""What a component must do to take part: one small protocol per kind.

Only the shape of the calls is fixed here; a component is any object that answers them. The life
of a search, and who calls whom::

    seeder      evaluator, rng            -> centres, maybe weights       (Sec. 5)
    labeler     evaluator, vector         -> which centre gets which label (Sec. 6)
    optimizer   ask() -> vectors, tell(costs), until done                 (Sec. 7)
    evaluator   vectors -> labels (parameterization) -> parts -> costs (objectives)
    refiner     evaluator, labels         -> labels, their boundaries moved, once the search is over

Seeders, labelers, optimizers, parameterizations and refiners are constructed with their parameters
as keyword arguments, which :mod:`moseg_core.components.parameters` reads from their signature.
Optimizers can be pickled between ``tell`` and ``ask``; that is how a run is checkpointed.

A class may say more of itself, in attributes that no protocol asks for:

``example``
    For a component with a parameter that must be given: a static method that returns a dict of
    parameters to try it with. It is called with what the component is about to meet: ``(shape,
    n_parts)`` for a parameterization, ``(evaluator,)`` for seeders, labelers and refiners,
    ``(start,)`` for optimizers, ``(shape, labels)`` for constraints, ``(shape,)`` for embeddings.
    It may also lower what takes long to try, such as a number of rounds, as long as all that the
    component does still happens.
``presets``
    Parameters that take the place of the signature's defaults on an occasion, by its name, such as
    ``{"polish": {"pattern_size": 0.01}}``. ``"default"``: under the settings of that name, where
    the user gives no parameters (under ``paper`` they are the signature's). ``"coarse"``: the same
    of an optimizer on a coarse shape. ``"polish"``: of an optimizer that can improve a good start
    in a short time; it then does so with what it has found on a coarse shape, whatever parameters
    the user gives for the search. Without these the default optimizer does.
    ``"again"``: of a seeder, for the starts after the first, beside the parameters that the user
    gives: one that draws no random numbers begins elsewhere with these.
``connected``
    Of a parameterization, once made: true where each of its parts is in one piece, on a shape in
    one piece whose adjacency is known.
``centers_per_part``
    Of a parameterization, once made: (n,) int, how many centres each part has, where that is not
    one each.
``weighted_bisectors``
    Of a parameterization: true where a point belongs to the centre, of those that a vector is
    decoded to, with the least distance over weight. Where parts have a centre each, its boundaries
    are then clipped in closed form, without asking for ``distances``.
``check``
    Of a refiner, once made: a method that is called with the evaluator before the search, and
    raises one of moseg's errors where shape or problem lack what the refiner needs. A text that it
    returns is a warning of the refined result, such as what the refiner does without.
``optimal``
    Of a labeler: ``"unary"`` where no assignment has a lower sum of unary terms, ``"all"`` where
    none has a lower cost.

The contract kit (:mod:`moseg_core.testing`) uses the first and holds components to the others.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.objectives import Traits
from moseg_core.components.parameters import Parameter
from moseg_core.components.segmentation import Segmentation
from moseg_core.shape.pins import Pins
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, IntArray


@runtime_checkable
class Objective(Protocol):
    """A cost of one part, of several, or of the whole. See :func:`moseg_core.objective`."""

    @property
    def traits(self) -> Traits:
        """Arity, range, requirements, invariances and cost class."""
        ...

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Declared parameters, given in an expression as ``key=value``."""
        ...

    def __call__(self, subject: Any, /, **parameters: Any) -> float:
        """The value; `subject` is a Part, a sequence of parts or a Segmentation."""
        ...


@dataclass(frozen=True, eq=False, kw_only=True)
class Centers:
    """What a vector means: centres with their weights.

    Parameters
    ----------
    positions : (c, 3) float, model units
    weights : (c,) float
        Positive; only their ratios matter.
    parts : (c,) int, optional
        The part of each centre, rising from 0, none left out. By default there is one centre for
        each part, in order.

    Examples
    --------
    >>> import numpy as np
    >>> at, parts = np.array([[0.0, 0, 0], [1.0, 0, 0], [3.0, 0, 0]]), np.array([0, 0, 1])
    >>> both = Centers(positions=at, weights=np.ones(3), parts=parts)
    >>> both.per_part.tolist()
    [2, 1]
    >>> both.ordered(np.array([1, 0])).positions[:, 0].tolist()
    [3.0, 0.0, 1.0]
    """

    positions: FloatArray
    weights: FloatArray
    parts: IntArray | None = None

    @property
    def per_part(self) -> IntArray:
        """(n,) int: how many centres each part has."""
        if self.parts is None:
            return np.ones(len(self.weights), np.int64)
        return np.bincount(self.parts).astype(np.int64)

    @property
    def first(self) -> Centers:
        """The first centre of each part."""
        return self if self.parts is None else self.fitted(np.ones(len(self.per_part), np.int64))

    def ordered(self, order: IntArray) -> Centers:
        """Centres whose part ``j`` is part ``order[j]`` of these."""
        per_part = self.per_part
        places = centers_of_parts(per_part, per_part[order], order)
        return self._chosen(places, per_part[order])

    def fitted(self, per_part: IntArray) -> Centers:
        """Centres of which each part has so many.

        A part that has more keeps its first ones. One that has fewer gets others in the place of
        its first, of the same weight: so they change nothing about which points are nearest to it.

        Parameters
        ----------
        per_part : (n,) int
            1 or more.
        """
        own = self.per_part
        if np.array_equal(own, per_part):
            return self
        return self._chosen(centers_of_parts(own, per_part, np.arange(len(own))), per_part)

    def of(self, part: int) -> Centers:
        """The centres of one part, which is then the only one."""
        per_part = self.per_part
        count = per_part[part : part + 1]
        return self._chosen(int(per_part[:part].sum()) + np.arange(count[0]), count)

    @classmethod
    def joined(cls, several: Sequence[Centers]) -> Centers:
        """All parts of these, one after the other."""
        per_part = np.concatenate([centers.per_part for centers in several])
        whole = cls(
            positions=np.concatenate([centers.positions for centers in several]),
            weights=np.concatenate([centers.weights for centers in several]),
        )
        return whole._chosen(np.arange(len(whole.weights)), per_part)

    def _chosen(self, places: IntArray, per_part: IntArray) -> Centers:
        several = bool((per_part > 1).any())
        return Centers(
            positions=np.asarray(self.positions)[places],
            weights=np.asarray(self.weights)[places],
            parts=np.repeat(np.arange(len(per_part)), per_part) if several else None,
        )


def centers_of_parts(have: IntArray, want: IntArray, order: IntArray) -> IntArray:
    """Which centres to take, so that part ``j`` has ``want[j]`` of those of part ``order[j]``.

    Where that part has fewer, its first comes again, as in :meth:`Centers.fitted`.

    Parameters
    ----------
    have : (n,) int
        How many centres each part has; they stand one part after the other.
    want, order : (n,) int

    Examples
    --------
    >>> import numpy as np
    >>> centers_of_parts(np.array([2, 1]), np.array([2, 1]), np.array([1, 0])).tolist()
    [2, 2, 0]
    """
    starts = np.cumsum(have) - have
    within = np.arange(int(want.sum())) - np.repeat(np.cumsum(want) - want, want)
    part = np.repeat(order, want)
    places: IntArray = starts[part] + np.where(within < have[part], within, 0)
    return places


@runtime_checkable
class Parameterization(Protocol):
    """A family of segmentations, described by vectors of real numbers (Sec. 4).

    Constructed with ``(shape, n_parts)`` and parameters. One that takes a keyword-only argument
    ``labels`` is told the names of the parts in it, a tuple of str; in ``expected_shares`` the
    shares of the area that they are expected to have, (n,) float, NaN where nothing is known
    (:attr:`moseg_core.Problem.expected_shares`). These are no parameters of the user's. Vectors are
    in unit coordinates: a step of ``s`` along coordinate ``k`` is a step of ``s * scale[k]``.
    """

    @property
    def n_parts(self) -> int:
        """Number of parts, n."""
        ...

    @property
    def lower(self) -> FloatArray:
        """(m,) float: least feasible value of each coordinate; -inf where unbounded."""
        ...

    @property
    def upper(self) -> FloatArray:
        """(m,) float: greatest feasible value of each coordinate."""
        ...

    @property
    def scale(self) -> FloatArray:
        """(m,) float: the natural size of a step of 1 along each coordinate."""
        ...

    def labels(self, vectors: FloatArray) -> Int32Array:
        """(B, F) int32: for each of (B, m) vectors the part of every element."""
        ...

    def encode(self, centers: Centers) -> FloatArray:
        """(m,) float: the vector of given centres.

        They are such as :meth:`decode` returns, or one for each part. Where a part has several
        (``centers_per_part``), the vector of one each means the partition that these make: the
        others are in the place of the first, as :meth:`Centers.fitted` puts them.
        """
        ...

    def decode(self, vector: FloatArray) -> Centers:
        """The centres that a vector describes; inverse of :meth:`encode`."""
        ...

    def coordinates(self, part: int) -> IntArray:
        """Indices of the coordinates that belong to one part, for keeping it as it is.

        Of all its centres, where it has several.
        """
        ...

    def permute(self, vector: FloatArray, order: IntArray) -> FloatArray:
        """(m,) float: the vector whose part ``j`` is part ``order[j]`` of the given one.

        A vector of one centre each keeps its partition. So do others, as long as parts change
        places with those that have as many centres; else it is that of ``fitted`` centres.
        """
        ...


@runtime_checkable
class ClippableParameterization(Parameterization, Protocol):
    """A parameterization that also knows where its parts meet between elements.

    So boundaries can be clipped below the resolution of a mesh (Sec. 4); those of others are
    refused by name.
    """

    def distances(self, vector: FloatArray, points: FloatArray) -> FloatArray:
        """(P, n) float: how far each point (model units) is from each part; least wins.

        Of a part's several centres the nearest counts.
        """
        ...


class Evaluator(Protocol):
    """A problem on a shape, as components see it: vectors or labels in, parts and costs out.

    What stands above the components is typed loosely here; :class:`moseg_core.ProblemEvaluator` is
    the one that there is, and says more.
    """

    @property
    def shape(self) -> Shape:
        """The one that the partition is of: embedded or coarse, where it is."""
        ...

    @property
    def problem(self) -> Any:
        """The :class:`moseg_core.Problem`: its labels, terms, classes of labels that are alike."""
        ...

    @property
    def parameterization(self) -> Parameterization:
        """What vectors mean."""
        ...

    @property
    def constraints(self) -> Any:
        """What the problem asks of vectors: see :mod:`moseg_core.problem.constraints`."""
        ...

    @property
    def pins(self) -> Pins:
        """Elements that must bear a label."""
        ...

    @property
    def input(self) -> Evaluator:
        """On a coarse shape the same problem on the input's own elements; else itself."""
        ...

    def labels(self, vector: FloatArray) -> Int32Array:
        """(F,) int32: the labelling that an (m,) vector describes."""
        ...

    def segmentation(self, labels: Int32Array) -> Segmentation:
        """The parts of a labelling, with what is remembered of them."""
        ...

    def evaluate(self, vector: FloatArray) -> Any:
        """The :class:`moseg_core.Evaluation` of a vector: cost by term and part."""
        ...

    def evaluate_labels(self, labels: Int32Array) -> Any:
        """The :class:`moseg_core.Evaluation` of a labelling."""
        ...

    def costs(self, batch: Batch) -> list[Cost]:
        """Costs of a batch, exact where its promises do not allow otherwise."""
        ...

    def unary_costs(self, vector: FloatArray) -> Any:
        """The paper's cost matrix ``C`` (Sec. 6): see :mod:`moseg_core.search.assignment`."""
        ...

    def order_cost(self, segmentation: Segmentation, order: IntArray) -> Cost:
        """Cost of a segmentation when label ``j`` goes to its part ``order[j]``."""
        ...

    def labelled_costs(self, vectors: FloatArray) -> list[tuple[IntArray, Cost]]:
        """For each of (B, m) vectors the best labels by unary terms, and the whole cost."""
        ...


@dataclass(frozen=True, eq=False, kw_only=True)
class Seeding:
    """What a seeder returns.

    Parameters
    ----------
    centers : (n, 3) float, model units
    weights : (n,) float or None
        Of the centres: positive and finite; only their ratios matter. None: all are 1.
    history : tuple of dict
        One record per round, of numbers only, for the convergence curves.
    warning : str
        What the user should know; empty where all is well.
    labelled : bool
        Whether centre ``j`` belongs to label ``j`` already, so that no labeler is asked.
    """

    centers: FloatArray
    weights: FloatArray | None = None
    history: tuple[dict[str, float], ...] = ()
    warning: str = ""
    labelled: bool = False


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far a run has come.

    Parameters
    ----------
    stage : str
        "k-means", "pattern_search".
    done : int
        Rounds or evaluations so far.
    best : Cost or None
        The best cost so far, where one is known.
    fraction : float or None
        Estimated share of the stage that is done.
    place : str
        Which of several searches alike it is: "start 2 of 8"; filled in by the core.
    """

    stage: str
    done: int
    best: Cost | None = None
    fraction: float | None = None
    place: str = ""


Report = Callable[[Progress], bool]
"""Called now and then while a run goes on; True asks to stop with the best found so far."""


def placed(report: Report, place: str) -> Report:
    """The same report, with a place in front of those that it is given.

    Parameters
    ----------
    report : callable
    place : str
        Which of several searches alike it is.

    Examples
    --------
    >>> report = placed(lambda progress: print(progress.place), "label set 2 of 3")
    >>> report(Progress(stage="k-means", done=1, place="start 1 of 8"))
    label set 2 of 3, start 1 of 8
    """

    def report_with_place(progress: Progress) -> bool:
        whole = (
            f"{place}, {progress.place}" if place and progress.place else place or progress.place
        )
        return report(replace(progress, place=whole))

    return report_with_place


def never_stop(progress: Progress) -> bool:
    """The report of who does not listen: it never asks to stop."""
    return False


@runtime_checkable
class Seeder(Protocol):
    """An initial placement of the centres, of weight 1 unless it knows better (Sec. 5).

    A class of seeders that are a search in themselves, whose seeds are the best of many by the
    problem's cost, may say so by an attribute ``searches = True``: seeds for problems that compete
    are then compared before anything else is done.
    """

    def __call__(
        self, evaluator: Evaluator, *, rng: np.random.Generator, report: Report
    ) -> Seeding:
        """Place one centre per label of the evaluator's problem.

        Of several centres no two are in one place; all are on the shape or near it. Returns soon
        after `report` has answered True.
        """
        ...


@runtime_checkable
class Labeler(Protocol):
    """An assignment of labels to centres (Sec. 6)."""

    def __call__(self, evaluator: Evaluator, vector: FloatArray) -> IntArray:
        """(n,) int: entry ``j`` is the centre that label ``j`` goes to; a permutation.

        Decided by what the parts are like, whatever their numbers.
        """
        ...


@dataclass(frozen=True, eq=False, kw_only=True)
class Batch:
    """Candidates that an optimizer wants to know the costs of.

    Parameters
    ----------
    vectors : (B, m) float
        All feasible.
    cutoff : Cost or None
        A promise: costs that are not below the cutoff need not be exact. They may be answered
        by any lower bound that is not below the cutoff either.
    best_only : bool
        A promise: only the least cost of the batch matters, and of equal ones the first. It lets
        the evaluator leave out the expensive terms of candidates that cannot be the best.
    """

    vectors: FloatArray
    cutoff: Cost | None = None
    best_only: bool = False


@runtime_checkable
class Optimizer(Protocol):
    """A search over vectors, by ask and tell (Sec. 7).

    Constructed with ``(start, lower, upper, scale)``, then ``rng=`` and parameters. The first
    batch must contain `start`. One that takes a parameter ``max_evaluations`` asks for exactly so
    many candidates, unless ``finished`` is "converged" before.
    """

    @property
    def finished(self) -> str:
        """Why the search ended, "converged" or the limit that it met; empty while it goes on."""
        ...

    @property
    def best(self) -> tuple[FloatArray, Cost]:
        """The best vector told so far, and its cost; NaN is as bad as can be."""
        ...

    @property
    def history(self) -> tuple[dict[str, float], ...]:
        """One record per iteration, of numbers only."""
        ...

    @property
    def progress(self) -> float:
        """Estimated share of the search that is done, 0 to 1."""
        ...

    def ask(self) -> Batch:
        """The candidates to evaluate next; at least one unless finished."""
        ...

    def tell(self, costs: Sequence[Cost]) -> None:
        """The costs of the batch last asked for, in its order; an error where there is none."""
        ...


@runtime_checkable
class Refiner(Protocol):
    """Boundaries moved a little, once the search is over, to where people put them.

    Constructed with parameters.
    """

    def __call__(self, evaluator: Evaluator, labels: Int32Array, *, report: Report) -> Int32Array:
        """(F,) int32: the label of every element of the evaluator's shape, boundaries moved.

        No part becomes empty; a pinned element keeps its label, or gets the one that it is pinned
        to. Returns soon after `report` has answered True.

        Parameters
        ----------
        evaluator : Evaluator
            On the input's own elements.
        labels : (F,) int32
            What the search has found; not to be changed.
        report : callable
        """
        ...


@runtime_checkable
class Constraint(Protocol):
    """Centres that follow from others, or from fewer numbers than their own four (Sec. 8).

    Constructed with ``(shape, labels)`` and parameters: the shape in which the partition lives,
    and the indices of the labels that it was given, in the order written. A parameter called
    ``plane`` gets the problem's plane unless it is given.

    Centres are rows ``x, y, z, w`` of an ``(n, 4)`` array, one for each label of the problem:
    position in unit coordinates (``shape.frame.to_unit``; the box diagonal is 1) and weight. A
    constraint *determines* the rows of some labels, from the rows of those that it *reads* and
    from ``n_free`` numbers of its own, which the search sees in place of the rows. The core
    composes several (:mod:`moseg_core.problem.constraints`).

    A class whose attribute ``each`` is true is about single labels: given several in a recipe, it
    is made once for each of them, and their centres may be exchanged.
    """

    @property
    def determines(self) -> tuple[int, ...]:
        """Labels whose rows follow."""
        ...

    @property
    def reads(self) -> tuple[int, ...]:
        """Labels from whose rows they follow; none of those determined."""
        ...

    @property
    def lower(self) -> FloatArray:
        """(k,) float: least value of each number of its own, -inf where unbounded."""
        ...

    @property
    def upper(self) -> FloatArray:
        """(k,) float: greatest value of each number of its own."""
        ...

    def expand(self, free: FloatArray, centers: FloatArray) -> FloatArray:
        """(n, 4) float: the rows, those determined filled in.

        Parameters
        ----------
        free : (k,) float
            The numbers of its own; a step of 1 is a box diagonal, or a weight of 1.
        centers : (n, 4) float
            Right for the labels that are read; not to be changed.
        """
        ...

    def reduce(self, centers: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The (k,) free numbers, and the rows of the feasible centres nearest to those given.

        The rows of labels that are read may be moved too: half-way, where two have to agree.
        """
        ...


@runtime_checkable
class Embedding(Protocol):
    """A deformation of the shape in which the partition is found instead (Sec. 9).

    Constructed with parameters.
    """

    def __call__(self, shape: Shape) -> Shape:
        """The embedded shape, with the same elements in the same order.

        Made with :meth:`moseg_core.Shape.deformed`, so that it is a shape in full: with areas,
        moments and a volume of its own.

        Raises
        ------
        ShapeError
            The shape cannot be embedded; says why.
        """
        ...
