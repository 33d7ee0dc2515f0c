"""Components at work: each kind is made and run as the core would, on a few small shapes.

The checks that concern all kinds, such as "pickles and gives the same", do not care what a
component does, only that it does the same again. :func:`drive` answers them: it runs a component
once (:mod:`moseg_core.testing.trials`) and returns all that came of it, by where it came from.

The world in which seeders, labelers and optimizers run is a problem of three labels
(:func:`evaluator_on`), toy functions (:data:`TOYS`), and for constraints as many labels as they
take (:func:`constraint_on`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.choice import Choice, Ready, prepare
from moseg_core.cost import Cost
from moseg_core.errors import UsageError
from moseg_core.evaluation import Evaluator
from moseg_core.memo import Memo
from moseg_core.objectives import objective
from moseg_core.part import Part
from moseg_core.plugins import measure_resolver
from moseg_core.problem import Problem, lack
from moseg_core.protocols import Centers, Constraint, Objective, Optimizer, Progress
from moseg_core.segmentation import Segmentation
from moseg_core.shape import Shape
from moseg_core.specs import Kind
from moseg_core.testing.check import Skip, Subject
from moseg_core.testing.trials import (
    Raised,
    Result,
    Trial,
    attempt,
    declared,
    has_example,
    plain,
    required_values,
)
from moseg_core.testing.zoo import Labelling, labellings
from moseg_core.types import FloatArray

LABELS = ("a", "b", "c")
"""Labels of the problem that seeders and labelers are given."""

SHAPES = ("tetrahedron", "disc", "cloud", "voxels", "lump")
"""The specimens on which objectives and measures are driven."""


def drive(subject: Subject, **options: Any) -> Result:
    """Run a component on a few small shapes.

    Parameters
    ----------
    subject : Subject
        Of a kind in :data:`~moseg_core.testing.trials.DRIVEN`.
    **options
        Those of :class:`~moseg_core.testing.trials.Trial`.

    Returns
    -------
    dict of str to value
        Comparable by :func:`~moseg_core.testing.trials.difference`.

    Raises
    ------
    Skip
        Its kind cannot be driven, or it has a required parameter for which nobody can guess a
        value.
    """
    return run(Trial(subject=subject, **options))


def run(trial: Trial) -> Result:
    """Run a trial; see :func:`drive`."""
    kind = trial.subject.component.kind
    if kind not in DRIVERS:
        raise Skip(f"a {kind} is not run by the kit")
    if not has_example(trial.subject):
        required_values(declared(trial.subject))
    result: Result = plain(DRIVERS[kind](trial))
    return result


# -- Objectives and measures ------------------------------------------------------------------


def segmented(
    subject: Subject, shape: Shape, labelling: Labelling, *, memo: Memo | None = None
) -> Segmentation:
    """The parts of a labelling, with the measures that are installed; nothing remembered."""
    return Segmentation.from_labels(
        shape,
        labelling.labels,
        labelling.n_parts,
        memo=Memo(size=0) if memo is None else memo,
        measures=measure_resolver(subject.registry),
    )


def calls_on(target: Objective, segmentation: Segmentation) -> dict[str, Any]:
    """What the core may pass to an objective of a segmentation: by title, parts or the whole.

    Never anything empty or without extent, and nothing of a shape that lacks what is required.
    """
    traits = target.traits
    if any(lack(segmentation.shape, requirement) for requirement in traits.requires):
        return {}
    parts = segmentation.parts
    empty = segmentation.summary.empty(segmentation.level)
    good = [k for k in range(len(parts)) if not empty[k]]
    if traits.arity == "unary":
        return {f"part {k}": parts[k] for k in good}
    if traits.arity == "global":
        return {"all parts": segmentation} if len(good) == len(parts) else {}
    most = len(good) if traits.most is None else traits.most
    found: dict[str, Any] = {}
    for count in range(traits.least, min(most, len(good)) + 1):
        for first in range(len(good) - count + 1):
            chosen = good[first : first + count]
            found[f"parts {', '.join(map(str, chosen))}"] = tuple(parts[k] for k in chosen)
    return found


def value_of(target: Objective, given: Any, parameters: Mapping[str, Any]) -> Any:
    """The value of an objective, or :class:`~moseg_core.testing.trials.Raised`."""
    return attempt(lambda: target(given, **parameters))


def values_on(
    target: Objective, segmentation: Segmentation, title: str, parameters: Mapping[str, Any]
) -> Result:
    """The values of an objective for all that it may be asked of a segmentation."""
    return {
        f"{title}, {name}": value_of(target, given, parameters)
        for name, given in calls_on(target, segmentation).items()
    }


def _drive_objective(trial: Trial) -> Result:
    target = trial.make()
    parameters = {**required_values(declared(trial.subject)), **trial.parameters}
    found: Result = {}
    for shape in trial.shapes(*SHAPES):
        for labelling in labellings(shape):
            segmentation = segmented(trial.subject, shape, labelling)
            title = f"{shape.name}, {labelling.title}"
            summary = segmentation.summary
            arrays = {"level_labels": segmentation.level_labels, "moments": summary.moments}
            trial.watch(f"the segmentation '{title}'", arrays)
            found |= values_on(target, segmentation, title, parameters)
    return found


def _drive_measure(trial: Trial) -> Result:
    target = trial.make()
    parameters = {**required_values(declared(trial.subject)), **trial.parameters}
    found: Result = {}
    for shape in trial.shapes(*SHAPES):
        for labelling in labellings(shape):
            segmentation = segmented(trial.subject, shape, labelling)
            empty = segmentation.summary.empty(shape)
            for k, part in enumerate(segmentation.parts):
                if not empty[k]:
                    title = f"{shape.name}, {labelling.title}, part {k}"
                    found[title] = attempt(lambda part=part: target(part, **parameters))  # type: ignore[misc]
    return found


# -- Partitions, seeders, labelers ------------------------------------------------------------


def centres_of(shape: Shape, n: int) -> FloatArray:
    """(n, 3) float, model units: places of elements far apart, as a start."""
    chosen = [0]
    points = shape.points
    nearest = ((points - points[0]) ** 2).sum(axis=1)
    while len(chosen) < n:
        chosen.append(int(nearest.argmax()))
        nearest = np.minimum(nearest, ((points - points[chosen[-1]]) ** 2).sum(axis=1))
    return points[chosen]


def vectors_of(partition: Any, shape: Shape, *, count: int = 4, seed: int = 0) -> FloatArray:
    """(count, m) float: vectors in bounds, the first with centres on elements far apart."""
    rng = np.random.default_rng(seed)
    n = partition.n_parts
    start = partition.encode(Centers(positions=centres_of(shape, n), weights=np.ones(n)))
    step = 0.1 * partition.scale * rng.normal(size=(count, len(start)))
    step[0] = 0.0
    inside: FloatArray = np.clip(start + step, partition.lower, partition.upper)
    return inside


def _drive_parameterization(trial: Trial) -> Result:
    found: Result = {}
    for shape in trial.shapes("tetrahedron", "cloud", "voxels", "lump"):
        partition = trial.make(shape, 3)
        vectors = trial.give("vectors", vectors_of(partition, shape))
        found[f"{shape.name}, labels"] = attempt(lambda: partition.labels(vectors))  # noqa: B023
        at = attempt(lambda: partition.decode(vectors[1]))  # noqa: B023
        found[f"{shape.name}, decode"] = at if isinstance(at, Raised) else at.positions
        found[f"{shape.name}, distances"] = attempt(
            lambda: partition.distances(vectors[0], shape.points)  # noqa: B023
        )
    return found


@objective(range=(0, 1))
def slender(part: Part) -> float:
    """Small for a long part."""
    s1, s2, s3 = part.scales
    return float((s2 + s3) / (2 * s1))


@objective(range=(0, 1))
def slab(part: Part) -> float:
    """Small for a flat part."""
    s1, _, s3 = part.scales
    return float(s3 / s1)


@objective(range=(0, 1))
def small(part: Part) -> float:
    """Small for a part of little area."""
    return min(1.0, part.area / part.shape.area)


@objective(range=(0, 1))
def across(first: Part, second: Part) -> float:
    """Small where the long axes of two parts are at a right angle."""
    return min(1.0, float(abs(first.axes[0] @ second.axes[0])))


OBJECTIVES = {"slender": slender, "slab": slab, "small": small, "across": across}
"""The objectives of the problem that seeders and labelers are given."""

EXPRESSION = "2*slender(a) + slab(b) + 1.5*small(c) + 0.3*across(a, b)"
"""That problem."""


def evaluator_on(subject: Subject, shape: Shape, *, n: int = 3) -> Evaluator:
    """What seeders and labelers are given: a problem of up to three labels on a shape.

    Parameters
    ----------
    subject : Subject
        Its registry is the problem's.
    shape : Shape
    n : int
        Number of labels, 1 to 3; with fewer than three the terms that name the others are left
        out.
    """
    terms = {1: "2*slender(a)", 2: "2*slender(a) + slab(b) + 0.3*across(a, b)", 3: EXPRESSION}
    problem = Problem(LABELS[:n], terms[n], objectives=OBJECTIVES, registry=subject.registry)
    return Evaluator(shape, problem, Voronoi(shape, n))


def go_on(progress: Progress) -> bool:
    """A report that never asks to stop."""
    return False


def _drive_seeder(trial: Trial) -> Result:
    found: Result = {}
    for shape in trial.shapes("tetrahedron", "cloud", "lump"):
        evaluator = evaluator_on(trial.subject, shape)
        seeder = trial.make(meets=(evaluator,))
        rng = np.random.default_rng(5)
        seeding = attempt(lambda: seeder(evaluator, rng=rng, report=go_on))  # noqa: B023
        raised = isinstance(seeding, Raised)
        found[shape.name] = seeding if raised else (seeding.centers, seeding.labelled)
    return found


def _drive_labeler(trial: Trial) -> Result:
    found: Result = {}
    for shape in trial.shapes("tetrahedron", "cloud", "lump"):
        evaluator = evaluator_on(trial.subject, shape)
        labeler = trial.make(meets=(evaluator,))
        for k, vector in enumerate(vectors_of(evaluator.parameterization, shape)):
            handed = trial.give("the vector", vector)
            order = attempt(lambda: labeler(evaluator, handed))  # noqa: B023
            found[f"{shape.name}, vector {k}"] = order
    return found


# -- Optimizers -------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False, kw_only=True)
class Toy:
    """A function to minimise, in bounds.

    Parameters
    ----------
    name : str
    start, lower, upper, scale : (m,) float
        What an optimizer is made from.
    value : callable
        (m,) float to float; least at 0.
    """

    name: str
    start: FloatArray
    lower: FloatArray
    upper: FloatArray
    scale: FloatArray
    value: Callable[[FloatArray], float]

    def costs(self, vectors: FloatArray) -> list[Cost]:
        """Costs of a batch."""
        return [Cost(0, float(self.value(vector))) for vector in vectors]


def _toy(name: str, start: Sequence[float], value: Callable[[FloatArray], float]) -> Toy:
    m = len(start)
    return Toy(
        name=name,
        start=np.array(start, np.float64),
        lower=np.full(m, -1.0),
        upper=np.full(m, 1.0),
        scale=np.ones(m),
        value=value,
    )


TOYS = (
    _toy("bowl", [0.9, -0.7, 0.8], lambda x: float(((x - [0.1, 0.2, -0.3]) ** 2).sum())),
    _toy("valley", [-0.8, 0.9], lambda x: float((1 - x[0]) ** 2 + 10 * (x[1] - x[0] ** 2) ** 2)),
    # Constant but for steps, as the cost is while no element changes its part.
    _toy("stairs", [0.95, 0.95, -0.95], lambda x: float(np.abs(np.round(8 * x)).sum())),
)
"""Three functions that any search should find its way down on."""


def optimizer_on(trial: Trial, toy: Toy, *, seed: int = 3) -> Optimizer:
    """The optimizer, at the start of a toy."""
    bounds = [
        trial.give(title, array)
        for title, array in (
            ("start", toy.start),
            ("lower", toy.lower),
            ("upper", toy.upper),
            ("scale", toy.scale),
        )
    ]
    made: Optimizer = trial.make(*bounds, meets=(bounds[0],), rng=np.random.default_rng(seed))
    return made


def search(optimizer: Optimizer, toy: Toy, *, most: int = 150) -> tuple[FloatArray, Cost]:
    """Ask and tell until it has finished, or `most` candidates have been told; the best."""
    told = 0
    while not optimizer.finished and told < most:
        vectors = optimizer.ask().vectors
        optimizer.tell(toy.costs(vectors))
        told += len(vectors)
    return optimizer.best


def _drive_optimizer(trial: Trial) -> Result:
    found: Result = {}
    for toy in reversed(TOYS) if trial.backwards else TOYS:
        optimizer = optimizer_on(trial, toy)
        best = attempt(lambda: search(optimizer, toy))  # noqa: B023
        found[toy.name] = best if isinstance(best, Raised) else (best[0], best[1].value)
    return found


# -- Constraints and embeddings ---------------------------------------------------------------

CENTRES = np.array(
    [
        [0.21, 0.13, -0.05, 1.1],
        [-0.17, 0.22, 0.08, 0.9],
        [0.05, -0.24, 0.11, 1.0],
        [-0.12, -0.09, -0.13, 1.2],
    ]
)
"""(4, 4) float: rows of centres in unit coordinates, as constraints see them."""


def constraint_on(trial: Trial, shape: Shape) -> tuple[Constraint, tuple[int, ...]]:
    """The constraint, on as many labels as it takes, and which.

    Raises
    ------
    Skip
        It takes no number of labels from one to four.
    """
    reason = ""
    for count in (2, 1, 3, 4):
        labels = tuple(range(count))
        try:
            made: Constraint = trial.make(shape, labels)
            with suppress(AttributeError):  # that is for its protocol's check to say
                made.reduce(CENTRES.copy())
        except UsageError as error:
            reason = reason or str(error)
            continue
        return made, labels
    raise Skip(f"it can be made on no number of labels from one to four: {reason}")


def _drive_constraint(trial: Trial) -> Result:
    found: Result = {}
    for shape in trial.shapes("twin"):
        made, _ = constraint_on(trial, shape)
        centres = trial.give("centers", CENTRES)
        reduced = attempt(lambda: made.reduce(centres))  # noqa: B023
        found[f"{shape.name}, reduce"] = reduced
        if isinstance(reduced, Raised):
            continue
        free = trial.give("free", reduced[0])
        found[f"{shape.name}, expand"] = attempt(lambda: made.expand(free, centres))  # noqa: B023
    return found


def _drive_embedding(trial: Trial) -> Result:
    found: Result = {}
    for shape in trial.shapes("sphere", "lump"):
        embedding = trial.make(meets=(shape,))
        bent = attempt(lambda: embedding(shape))  # noqa: B023
        found[shape.name] = bent if isinstance(bent, Raised) else bent.geometry.vertices
    return found


DRIVERS: dict[Kind, Callable[[Trial], Result]] = {
    "objective": _drive_objective,
    "measure": _drive_measure,
    "parameterization": _drive_parameterization,
    "seeder": _drive_seeder,
    "labeler": _drive_labeler,
    "optimizer": _drive_optimizer,
    "constraint": _drive_constraint,
    "embedding": _drive_embedding,
}
"""How each kind is run."""


def prepared(subject: Subject, parameters: Mapping[str, Any]) -> Ready:
    """The component with parameters, checked as the core checks them."""
    component = subject.component
    return prepare(Choice(component.id, dict(parameters)), component.kind, subject.registry)
