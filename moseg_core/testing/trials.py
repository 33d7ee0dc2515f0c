"""One run of a component: what it is given, and what came of it.

A :class:`Trial` makes the component, from its default parameters or others, hands it its inputs
and keeps track of them. What the component raises is a result like any other, :class:`Raised`, so
that one that fails on a single shape can be compared on the rest. :func:`difference` says in words
how two results differ.
"""

from __future__ import annotations

import hashlib
import inspect
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from moseg_core.errors import MosegError
from moseg_core.parameters import Parameter, declared_parameters
from moseg_core.plugins import describe
from moseg_core.rules import FunctionConstraint
from moseg_core.shape import Shape
from moseg_core.specs import Kind
from moseg_core.testing.check import Skip, Subject
from moseg_core.testing.zoo import specimen
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
"""The kinds that :func:`moseg_core.testing.drivers.drive` can run."""


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


def attempt(function: Callable[[], Any]) -> Any:
    """What a function returns, or :class:`Raised`."""
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
        return bool(plain(first) == plain(second))
    return a.shape == b.shape and bool(
        np.all((a == b) | (np.isnan(a) & np.isnan(b)) | _near(a, b, tolerance))
    )


def _near(a: FloatArray, b: FloatArray, tolerance: float) -> Any:
    with np.errstate(invalid="ignore"):
        size = np.maximum(1.0, np.maximum(np.abs(a), np.abs(b)))
        return np.isfinite(size) & (np.abs(a - b) <= tolerance * size)


def _short(value: Any) -> str:
    text = " ".join(str(value).split())
    return text if len(text) <= 80 else f"{text[:77]}..."


def digest(array: Any) -> str:
    """A hash of an array's contents."""
    return hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()


def plain(value: Any) -> Any:
    """The value, with objects of which only the type can be compared replaced by :class:`Foreign`.

    What is kept to be compared later then keeps nothing else alive, and can be sent to another
    process.
    """
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return tuple(plain(item) for item in value)
    if value is None or isinstance(value, (bool, int, float, str, bytes, Raised, Foreign)):
        return value
    if isinstance(value, (np.ndarray, np.generic)) and value.dtype != object:
        return np.array(value)
    return Foreign(type(value).__name__)
