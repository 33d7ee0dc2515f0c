"""A parameterization whose every answer is checked before anybody relies on it (Sec. 4).

Labels are indices into arrays of parts, and the kernels that use them do not look: a label of a
part that there is not would be written wherever it points to. A parameterization is a stranger's
code, and is asked from everywhere: by the evaluator, by seeders and labelers, by constraints. So
it stands behind one adapter, made where the component is. What fails or breaks the contract there
is a :class:`~moseg_core.errors.PluginError` that names the parameterization, whoever had asked; an
argument of the wrong form is a ``ValueError``, which is the asker's.

Checking labels is one pass over them, less than a thousandth of what a poll takes.
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from moseg_core.components.chosen import PreparedComponent
from moseg_core.components.discovery.specs import ParameterizationSpec
from moseg_core.components.faults import guarded
from moseg_core.components.parameters import PROVIDED, takes
from moseg_core.components.protocols import Centers, Parameterization
from moseg_core.components.requirements import demand
from moseg_core.errors import REPORT, PluginError
from moseg_core.problem.problem import Problem
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, IntArray, frozen


class CheckedParameterization:
    """A parameterization, with everything checked that it returns.

    It answers like the one inside: attributes that no protocol asks for are that one's.

    Parameters
    ----------
    inner : Parameterization
    shape : Shape
        The one that it was made for.
    who : str
        The component and where it comes from, for messages.
    name, source : str
        What it is called in a profile, and the distribution that it comes from.

    Raises
    ------
    PluginError
        It has no bounds, or such as cannot be searched in.

    Examples
    --------
    >>> class Third:
    ...     n_parts, lower, upper, scale = 2, np.zeros(1), np.ones(1), np.ones(1)
    ...     def labels(self, vectors):
    ...         return np.full((len(vectors), 1), 2)
    >>> square = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> CheckedParameterization(Third(), square, who="'acme:third'").labels(np.zeros((1, 1)))
    Traceback (most recent call last):
        ...
    moseg_core.errors.PluginError: 'acme:third' gave labels from 2 to 2, and must give 0 to 1; ...
    """

    def __init__(
        self,
        inner: Any,
        shape: Shape,
        *,
        who: str,
        name: str = "parameterization",
        source: str = "",
    ) -> None:
        self._inner, self._shape, self._who = inner, shape, who
        self._name, self._source = name, source
        self._n_parts = self._whole_number()
        bounds = [self._numbers(name) for name in ("lower", "upper", "scale")]
        self._lower, self._upper, self._scale = bounds
        shapes = {bound.shape for bound in bounds}
        if len(shapes) != 1 or self._lower.ndim != 1 or not self._lower.size:
            raise self._broken(
                "must have one number per coordinate in each of lower, upper and scale, not arrays"
                f" of shape {', '.join(str(bound.shape) for bound in bounds)}"
            )
        if not (self._lower <= self._upper).all():
            raise self._broken("has a lower bound that is not below the upper one")
        if not (np.isfinite(self._scale) & (self._scale > 0)).all():
            raise self._broken("must have positive, finite numbers as scale")
        self._per_part = self._counts()

    def __getattr__(self, name: str) -> Any:
        """What the parameterization says of itself beyond the protocol."""
        if name.startswith("_"):  # also while a copy is being made, when nothing is inside yet
            raise AttributeError(name)
        return getattr(self._inner, name)

    @property
    def n_parts(self) -> int:
        """Number of parts, n."""
        return self._n_parts

    @property
    def centers_per_part(self) -> IntArray:
        """(n,) int: how many centres each part has; one each where it does not say."""
        return self._per_part

    @property
    def lower(self) -> FloatArray:
        """(m,) float: least feasible value of each coordinate."""
        return self._lower

    @property
    def upper(self) -> FloatArray:
        """(m,) float: greatest feasible value of each coordinate."""
        return self._upper

    @property
    def scale(self) -> FloatArray:
        """(m,) float: the natural size of a step of 1 along each coordinate."""
        return self._scale

    def labels(self, vectors: FloatArray) -> Int32Array:
        """(B, F) int32: for each of (B, m) vectors the part of every element, 0 to n - 1."""
        if np.ndim(vectors) != 2 or np.shape(vectors)[1] != len(self._lower):
            raise ValueError(
                f"labels() takes vectors of shape (B, {len(self._lower)}), not {np.shape(vectors)}"
            )
        labels = self._array("labels", vectors)
        expected = (len(vectors), self._shape.n_elements)
        if labels.shape != expected or not np.issubdtype(labels.dtype, np.integer):
            raise self._broken(
                f"must give whole numbers of shape {expected} as labels, not {labels.dtype} of"
                f" shape {labels.shape}"
            )
        if labels.size and not self._in_range(labels):
            raise self._broken(
                f"gave labels from {labels.min()} to {labels.max()}, and must give 0 to"
                f" {self._n_parts - 1}"
            )
        return np.ascontiguousarray(labels, np.int32)

    def encode(self, centers: Centers) -> FloatArray:
        """(m,) float: the vector of given centres, its own or one for each part."""
        one_each = np.ones_like(self._per_part)
        if not (_fit(centers, self._per_part) or _fit(centers, one_each)):
            own = (
                ""
                if (self._per_part == 1).all()
                else f" or {self._per_part.tolist()} for each part,"
            )
            parts = (
                "" if centers.parts is None else f" and parts {np.asarray(centers.parts).tolist()}"
            )
            raise ValueError(
                f"encode() takes {self._n_parts} centres{own} with a weight each, not positions of"
                f" shape {np.shape(centers.positions)}, weights of shape"
                f" {np.shape(centers.weights)}{parts}"
            )
        return self._vector("encode", centers, finite=_finite(centers.positions, centers.weights))

    def decode(self, vector: FloatArray) -> Centers:
        """The centres that an (m,) vector describes."""
        self._check_given("decode", vector)
        found = self._call("decode", vector)
        try:
            parts = getattr(found, "parts", None)
            centers = Centers(
                positions=np.asarray(found.positions, dtype=np.float64),
                weights=np.asarray(found.weights, dtype=np.float64),
                parts=None if parts is None else np.asarray(parts),
            )
            fits = _fit(centers, self._per_part)
            fits = fits and (_finite(centers.positions, centers.weights) or not _finite(vector))
        except (AttributeError, TypeError, ValueError):
            fits = False
        if not fits:
            own = (
                "" if (self._per_part == 1).all() else f", {self._per_part.tolist()} for each part"
            )
            raise self._broken(
                f"must decode a vector to {self._per_part.sum()} finite centres{own}"
            )
        return centers

    def distances(self, vector: FloatArray, points: FloatArray) -> FloatArray:
        """(P, n) float: how far (P, 3) points are from each part, where it knows."""
        self._check_given("distances", vector)
        try:
            found: FloatArray = np.asarray(self._array("distances", vector, points), np.float64)
        except (TypeError, ValueError):
            found = np.empty(0)
        if found.shape != (len(points), self._n_parts) or not _finite(found):
            raise self._broken(
                f"must give finite distances of {len(points)} points from {self._n_parts} parts"
            )
        return found

    def coordinates(self, part: int) -> IntArray:
        """Indices of the coordinates that belong to one part."""
        if not 0 <= part < self._n_parts:
            raise ValueError(f"coordinates() takes a part from 0 to {self._n_parts - 1}")
        found = self._array("coordinates", part)
        fits = found.ndim == 1 and found.size > 0 and np.issubdtype(found.dtype, np.integer)
        if not (fits and found.min() >= 0 and found.max() < len(self._lower)):
            raise self._broken(
                f"must give indices from 0 to {len(self._lower) - 1} as the coordinates of a part,"
                f" not {found.tolist()!r:.80}"
            )
        return found.astype(np.int64)

    def permute(self, vector: FloatArray, order: IntArray) -> FloatArray:
        """(m,) float: the vector whose part ``j`` is part ``order[j]`` of the given one."""
        self._check_given("permute", vector)
        if np.shape(order) != (self._n_parts,):
            raise ValueError(f"permute() takes an order of {self._n_parts} parts")
        return self._vector("permute", vector, order, finite=_finite(vector))

    def _in_range(self, labels: np.ndarray) -> bool:
        """Whether all labels are of parts that there are."""
        if labels.dtype == np.int32:  # a negative number is a large one without its sign
            return bool(labels.view(np.uint32).max() < self._n_parts)
        return bool(labels.min() >= 0 and labels.max() < self._n_parts)

    def _vector(self, name: str, *given: Any, finite: bool) -> FloatArray:
        """(m,) float: what a method returns; finite numbers where what it got was finite."""
        found = self._array(name, *given)
        try:
            vector: FloatArray = np.asarray(found, dtype=np.float64)
        except (TypeError, ValueError):
            vector = np.empty(0)
        if vector.shape != self._lower.shape or (finite and not _finite(vector)):
            raise self._broken(f"must {name} to {len(self._lower)} finite numbers")
        return vector

    def _check_given(self, name: str, vector: FloatArray) -> None:
        """Refuse a vector of another length, which is the asker's mistake."""
        if np.shape(vector) != self._lower.shape:
            raise ValueError(
                f"{name}() takes a vector of {len(self._lower)} numbers, not {np.shape(vector)}"
            )

    def _array(self, name: str, *given: Any) -> np.ndarray:
        """What a method returns, as an array."""
        found = self._call(name, *given)
        try:
            return np.asarray(found)
        except ValueError:  # rows of different lengths
            raise self._broken(f"must return an array from {name}()") from None

    def _call(self, name: str, *given: Any) -> Any:
        with guarded(self._who, f"failed in {name}()", name=self._name, source=self._source):
            return getattr(self._inner, name)(*given)

    def _attribute(self, name: str) -> Any:
        with guarded(self._who, f"cannot say its {name}", name=self._name, source=self._source):
            return getattr(self._inner, name)

    def _whole_number(self) -> int:
        found = self._attribute("n_parts")
        if isinstance(found, bool) or not isinstance(found, (int, np.integer)) or found < 1:
            raise self._broken(f"must have a whole number of parts, not {found!r:.40}")
        return int(found)

    def _counts(self) -> IntArray:
        """(n,) int: how many centres each part has."""
        if not hasattr(self._inner, "centers_per_part"):
            return frozen(np.ones(self._n_parts, np.int64))
        found = np.asarray(self._attribute("centers_per_part"))
        whole = found.shape == (self._n_parts,) and np.issubdtype(found.dtype, np.integer)
        if not (whole and (found >= 1).all()):
            raise self._broken(
                f"must have a whole number of centres for each of {self._n_parts} parts as"
                f" centers_per_part, not {found.tolist()!r:.80}"
            )
        return frozen(found.astype(np.int64))

    def _numbers(self, name: str) -> FloatArray:
        """(m,) float: a bound, read once."""
        try:
            numbers: FloatArray = np.array(self._attribute(name), dtype=np.float64)
        except (TypeError, ValueError):
            raise self._broken(f"must have numbers as {name}") from None
        return frozen(numbers)

    def _broken(self, how: str) -> PluginError:
        return PluginError(f"{self._who} {how}; {REPORT}")


def checked(parameterization: Parameterization, shape: Shape) -> CheckedParameterization:
    """A parameterization behind the adapter; one of the calling program is named by its class."""
    if isinstance(parameterization, CheckedParameterization):
        return parameterization
    name, source = f"parameterization {type(parameterization).__name__}", "the calling program"
    return CheckedParameterization(
        parameterization, shape, who=f"{name} of {source}", name=name, source=source
    )


def make_partition(
    ready: PreparedComponent, shape: Shape, problem: Problem
) -> CheckedParameterization:
    """The parameterization of a shape that was chosen, behind the adapter.

    Parameters
    ----------
    ready : PreparedComponent
    shape : Shape
    problem : Problem
        Says what the parts are called and how large they are expected to be, to a parameterization
        that takes an argument ``labels`` or ``expected_shares``.

    Raises
    ------
    ShapeError
        The shape lacks what it requires.
    PluginError
        It cannot be made, has other parts than asked for, or impossible bounds.
    """
    spec = cast(ParameterizationSpec, ready.component.spec)
    demand(
        shape.input,
        spec.requires,
        f"parameterization '{ready.component.id}'",
        instead="choose another parameterization",
    )
    n_parts = len(problem.labels)
    told = {
        name: getattr(problem, name)
        for name in PROVIDED["parameterization"]
        if takes(ready.factory, name)
    }
    made = CheckedParameterization(
        ready.make(shape, n_parts, **told),
        shape,
        who=ready.who,
        name=f"parameterization {ready.component.id}",
        source=ready.component.distribution,
    )
    if made.n_parts != n_parts:
        raise PluginError(
            f"{ready.who} was asked for {n_parts} parts, and makes {made.n_parts}; {REPORT}"
        )
    return made


def _fit(centers: Centers, per_part: IntArray) -> bool:
    """Whether there are so many centres for each part, with a weight each."""
    count = int(per_part.sum())
    if np.shape(centers.positions) != (count, 3) or np.shape(centers.weights) != (count,):
        return False
    if centers.parts is None:
        return bool((per_part == 1).all())
    return np.array_equal(centers.parts, np.repeat(np.arange(len(per_part)), per_part))


def _finite(*arrays: FloatArray) -> bool:
    return all(bool(np.isfinite(array).all()) for array in arrays)
