"""Components at work: each kind is made and run as the core would, on a few small shapes.

The checks that concern all kinds, such as "pickles and gives the same", do not care what a
component does, only that it does the same again. :func:`drive` answers them: it runs a component
and returns all that came of it, by where it came from. :func:`difference` says in words how two
such results differ.

A :class:`Trial` is one such run. It makes the component, from its default parameters or others,
hands it its inputs and keeps track of them. What the component raises is a result like any other,
:class:`Raised`, so that a component that fails on one shape can be compared on the rest; only the
check ``runs-on-the-zoo`` takes offence.

The world in which seeders, labelers and optimizers run is here too, for their own checks: a
problem of three labels (:func:`evaluator_on`), toy functions (:data:`TOYS`), a constraint on
labels that it takes (:func:`constraint_on`).
"""

from __future__ import annotations

import hashlib
import inspect
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.choice import Choice, Ready, prepare
from moseg_core.cost import Cost
from moseg_core.errors import UsageError
from moseg_core.evaluation import Evaluator
from moseg_core.memo import Memo
from moseg_core.objectives import objective
from moseg_core.parameters import Parameter, declared_parameters
from moseg_core.part import Part
from moseg_core.plugins import describe, measure_resolver
from moseg_core.problem import Problem, lack
from moseg_core.protocols import Constraint, Objective, Optimizer, Progress
from moseg_core.rules import FunctionConstraint
from moseg_core.segmentation import Segmentation
from moseg_core.shape import Shape
from moseg_core.specs import Kind
from moseg_core.testing.check import Skip, Subject
from moseg_core.testing.zoo import Labelling, labellings, specimen
from moseg_core.types import FloatArray

Result = dict[str, Any]
"""What came of a component, by where: "sphere, halves, part 1"."""

DRIVEN: tuple[Kind, ...] = (
    "objective",
    "measure",
    "parameterization",
    "seeder",
    "labeler",
    "optimizer",
    "constraint",
    "embedding",
)
"""The kinds that :func:`drive` can run."""

LABELS = ("a", "b", "c")
"""Labels of the problem that seeders and labelers are given."""

SHAPES = ("tetrahedron", "disc", "cloud", "voxels", "lump")
"""The specimens on which objectives and measures are driven."""


@dataclass(frozen=True)
class Raised:
    """An error in place of a result.

    Parameters
    ----------
    text : str
        Kind and message.
    excused : bool
        Whether it is one of moseg's own errors, by which a component refuses what it cannot do.
    """

    text: str
    excused: bool = False

    def __str__(self) -> str:
        return f"the error {self.text}"


@dataclass(frozen=True)
class Foreign:
    """In place of an object of which only the type can be compared.

    Parameters
    ----------
    type : str
        Its name.
    """

    type: str


def as_it_is(made: Any) -> Any:
    """The component itself."""
    return made


@dataclass(eq=False, kw_only=True)
class Trial:
    """One run of a component.

    Parameters
    ----------
    subject : Subject
    parameters : mapping of str to value
        Those of the user; what is required and missing is chosen by :func:`values_for`.
    through : callable
        What is made goes through this before it is used: pickled and back, for instance.
    read_only : bool
        Whether arrays are handed over read-only. Those of shapes always are.
    backwards : bool
        Whether shapes come in the opposite order.
    """

    subject: Subject
    parameters: Mapping[str, Any] = field(default_factory=dict)
    through: Callable[[Any], Any] = as_it_is
    read_only: bool = False
    backwards: bool = False
    _given: list[tuple[str, Any, str]] = field(default_factory=list)

    def make(self, *arguments: Any, meets: tuple[Any, ...] | None = None, **more: Any) -> Any:
        """The component, made from what its kind is given and the parameters.

        What it `meets` later, where that is not what it is made from, is for its ``example``.
        """
        target = self.subject.load()
        if self.subject.component.kind in ("objective", "measure"):
            return self.through(target)
        seen = arguments if meets is None else meets
        values = {**values_for(self.subject, *seen), **self.parameters}
        return self.through(target(*arguments, **more, **values))

    def give(self, title: str, array: Any) -> Any:
        """A copy of an array to hand over, remembered."""
        handed = np.array(array)
        handed.flags.writeable = not self.read_only
        self._given.append((title, handed, digest(handed)))
        return handed

    def watch(self, title: str, arrays: Mapping[str, Any]) -> None:
        """Remember arrays that the component can reach."""
        for name, array in arrays.items():
            self._given.append((f"{name} of {title}", array, digest(array)))

    def shape(self, name: str) -> Shape:
        """A specimen, its arrays remembered."""
        shape = specimen(name)
        geometry = shape.geometry
        arrays = {
            "points": shape.points,
            "areas": shape.areas,
            "first_moments": shape.first_moments,
            "second_moments": shape.second_moments,
            "geometry.vertices": geometry.vertices,
            "geometry.corners": geometry.corners,
            "geometry.triangles": geometry.triangles,
        }
        self.watch(f"the shape '{name}'", arrays)
        return shape

    def shapes(self, *names: str) -> Iterator[Shape]:
        """Specimens in the order of this trial."""
        for name in reversed(names) if self.backwards else names:
            yield self.shape(name)

    def changed(self) -> list[str]:
        """What was handed over and is not as it was, in words."""
        return [title for title, array, before in self._given if digest(array) != before]


def drive(subject: Subject, **options: Any) -> Result:
    """Run a component on a few small shapes.

    Parameters
    ----------
    subject : Subject
        Of a kind in :data:`DRIVEN`.
    **options
        Those of :class:`Trial`.

    Returns
    -------
    dict of str to value
        Comparable by :func:`difference`.

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
    return DRIVERS[kind](trial)


def attempt(function: Callable[[], Any]) -> Any:
    """What a function returns, or :class:`Raised`."""
    from moseg_core.errors import MosegError

    try:
        return function()
    except Exception as error:  # noqa: BLE001  # a stranger's component may raise anything
        return Raised(describe(error), excused=isinstance(error, MosegError))


def declared(subject: Subject) -> tuple[Parameter, ...]:
    """The parameters that a component declares."""
    target, kind = subject.load(), subject.component.kind
    if kind == "objective" or isinstance(target, FunctionConstraint):
        found: tuple[Parameter, ...] = tuple(target.parameters)
        return found
    if kind == "measure" and not inspect.isroutine(target):
        target = target.__call__  # an object with state of its own
    if kind in DRIVEN:
        return declared_parameters(target, reserved=("rng",) if kind == "optimizer" else ())
    return ()


def has_example(subject: Subject) -> bool:
    """Whether a component brings parameters to try it with; see :mod:`moseg_core.protocols`."""
    return callable(getattr(subject.load(), "example", None))


def values_for(subject: Subject, *meets: Any) -> dict[str, Any]:
    """Parameters to try a component with: of its own ``example``, or those that must be given.

    Parameters
    ----------
    subject : Subject
    *meets : objects
        What its ``example`` is called with: see :mod:`moseg_core.protocols`.

    Raises
    ------
    Skip
        See :func:`required_values`.
    """
    told = dict(subject.load().example(*meets)) if has_example(subject) else {}
    rest = [parameter for parameter in declared(subject) if parameter.name not in told]
    return {**required_values(rest), **told}


def required_values(parameters: Sequence[Parameter]) -> dict[str, Any]:
    """A value for each parameter that must be given.

    Raises
    ------
    Skip
        One of them is a text: nobody can guess what it should say.

    Examples
    --------
    >>> from moseg_core.parameters import Interval
    >>> required_values([Parameter(name="n", type=int, interval=Interval(2, 9), required=True)])
    {'n': 2}
    """
    values: dict[str, Any] = {}
    for parameter in parameters:
        if not parameter.required:
            continue
        low, high = parameter.interval.low, parameter.interval.high
        if parameter.type is str:
            raise Skip(f"nobody can guess a text for its required parameter '{parameter.name}'")
        ends = [end for end in (low, high) if math.isfinite(end)]
        value = 1.0 if 1.0 in parameter.interval or not ends else ends[0]
        if parameter.type is int:
            value = math.ceil(value)
        values[parameter.name] = parameter.type(value)
    return values


# -- What came of it --------------------------------------------------------------------------


def difference(first: Result, second: Result, *, tolerance: float = 0.0) -> str:
    """How two results differ, in words; empty where they do not.

    Parameters
    ----------
    first, second : Result
    tolerance : float
        Relative to the larger of 1 and the numbers themselves.

    Examples
    --------
    >>> difference({"cube": 1.0}, {"cube": 1.5})
    'cube: 1.0 and then 1.5'
    >>> difference({"cube": 1.0}, {"cube": 1.0 + 1e-12}, tolerance=1e-9)
    ''
    """
    for key in sorted(set(first) | set(second)):
        if key not in first or key not in second:
            return f"{key}: only one of them has it"
        if not same(first[key], second[key], tolerance=tolerance):
            return f"{key}: {_short(first[key])} and then {_short(second[key])}"
    return ""


def same(first: Any, second: Any, *, tolerance: float = 0.0) -> bool:
    """Whether two values are equal, numbers within a tolerance; NaN equals NaN."""
    if isinstance(first, Raised) or isinstance(second, Raised):
        return bool(first == second)
    if isinstance(first, (tuple, list)) and isinstance(second, (tuple, list)):
        return len(first) == len(second) and all(
            same(a, b, tolerance=tolerance) for a, b in zip(first, second, strict=True)
        )
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        return not difference(dict(first), dict(second), tolerance=tolerance)
    try:
        a, b = np.asarray(first, np.float64), np.asarray(second, np.float64)
    except (TypeError, ValueError):
        return bool(_comparable(first) == _comparable(second))
    return a.shape == b.shape and bool(
        np.all((a == b) | (np.isnan(a) & np.isnan(b)) | _near(a, b, tolerance))
    )


def _near(a: FloatArray, b: FloatArray, tolerance: float) -> Any:
    with np.errstate(invalid="ignore"):
        size = np.maximum(1.0, np.maximum(np.abs(a), np.abs(b)))
        return np.isfinite(size) & (np.abs(a - b) <= tolerance * size)


def _comparable(value: Any) -> Any:
    """The value where it is plain; of anything else its type is all that can be compared."""
    plain = isinstance(value, (str, bytes, type(None), Foreign))
    return value if plain else Foreign(type(value).__name__)


def _short(value: Any) -> str:
    text = " ".join(str(value).split())
    return text if len(text) <= 80 else f"{text[:77]}..."


def digest(array: Any) -> str:
    """A hash of an array's contents."""
    return hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()


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
    """The value of an objective, or :class:`Raised`."""
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
    from moseg_core.protocols import Centers

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
