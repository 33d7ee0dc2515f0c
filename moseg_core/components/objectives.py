"""Objectives as plain functions: the decorator that a formula needs to become one (Sec. 3, 10).

What the first argument is annotated with says what the objective is about::

    @objective(range=(0, 1), invariant_to=("rigid", "scale"))
    def narrow(part: Part) -> float: ...                       # unary: one part

    @objective(range=(0, 1))
    def perpendicular(first: Part, second: Part) -> float: ... # n-ary: exactly two parts

    @objective(range=(0, math.inf))
    def similar(parts: Sequence[Part]) -> float: ...           # n-ary: any number of parts

    @objective(range=(0, math.inf), requires=("volume",))
    def convex_parts(segmentation: Segmentation) -> float: ... # global: the whole

Keyword-only arguments are parameters (:mod:`moseg_core.components.parameters`). 0 is best for all
of moseg's own objectives; an aggregate minimises whatever it is given.
"""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import Any, Literal, get_args, get_origin, get_type_hints

from moseg_core.components.detail import Detail
from moseg_core.components.discovery.specs import Invariance, Requirement
from moseg_core.components.parameters import Parameter, declared_parameters
from moseg_core.components.part import Part
from moseg_core.components.part_array import Vectorized
from moseg_core.components.segmentation import Segmentation

Arity = Literal["unary", "nary", "global"]
CostClass = Literal["cheap", "moderate", "expensive"]

FieldNames = Callable[[Mapping[str, Any]], Sequence[str]]
"""From the parameters of a call to the ids of the fields that it reads."""

ShareOf = Callable[[Mapping[str, Any]], float | None]
"""From the parameters of a call to the share of the area of a part that it is content with."""

MeanOf = Callable[[Mapping[str, Any]], tuple[str, Mapping[str, Any]] | None]
"""From the parameters of a call to the id of a field, and its parameters, whose mean it is."""

DetailsOf = Callable[..., Sequence[Detail]]
"""Called like the objective, it tells what the value comes from."""

COST_ORDER: dict[CostClass, int] = {"cheap": 0, "moderate": 1, "expensive": 2}


@dataclass(frozen=True, kw_only=True)
class Traits:
    """What an objective declares of itself; the core relies on it.

    Parameters
    ----------
    arity : {"unary", "nary", "global"}
        What a call receives: a part, several parts, or the segmentation.
    range : (float, float)
        Least and greatest value. The search leaves out an expensive term of a candidate that
        cannot win even if the term took its least value, so the range must hold.
    requires : frozenset of {"volume", "adjacency", "surface"}
        What the shape must have; a problem is refused before the search where it lacks it. A
        "surface" is made of triangles, unlike a point cloud or the cells of a solid.
    invariant_to : frozenset of str
        What leaves the value unchanged: "rigid" motions, uniform "scale", "reflection", the
        "order" of the elements, their "tessellation" within a tolerance, and of several parts
        the order in which they are given or numbered, "labels".
    cost : {"cheap", "moderate", "expensive"}
        From the sums (microseconds), from the vertices, or from the whole surface.
    least, most : int
        How many parts an n-ary objective takes.
    fields : tuple of str, or callable
        Ids of the fields that the objective reads, or a function from the parameters that a call
        gives to those; they are computed before the search. The function may raise a
        :class:`~moseg_core.UsageError` of parameters that do not fit.
    measures : tuple of str
        Ids of the measures that the objective takes; what these require of a shape it requires
        too.
    share : callable or None
        From the parameters that a call gives, without defaults, to the share of the whole area,
        above 0 and at most 1, that each of its parts has where the value is low; None where they
        do not tell. Seeders place parts by it (:attr:`moseg_core.Problem.expected_shares`).
    mean_of : callable or None
        Of a unary objective whose value is the mean of a field over the part, weighted by area:
        from the parameters that a call gives to the field's id and its parameters; None where the
        value is no such mean. What the value is at each place is then known too, and refiners
        move boundaries by it.
    details : callable or None
        Called like the objective, with what it is called with; returns the
        :class:`moseg_core.Detail` of each quantity that the value comes from.
    vectorized : callable or None
        The objective of many calls at once: called with a :class:`moseg_core.PartArray` and the
        parameters, it returns their values.
    at_least : callable or None
        Where the values of many calls are bounded from below for less than they cost: called like
        a vectorised form, it returns a number for each that its value is not below.
    """

    arity: Arity
    range: tuple[float, float] = (-math.inf, math.inf)
    requires: frozenset[Requirement] = frozenset()
    invariant_to: frozenset[Invariance] = frozenset()
    cost: CostClass = "cheap"
    least: int = 1
    most: int | None = None
    fields: tuple[str, ...] | FieldNames = ()
    measures: tuple[str, ...] = ()
    share: ShareOf | None = None
    mean_of: MeanOf | None = None
    details: DetailsOf | None = None
    vectorized: Vectorized | None = None
    at_least: Vectorized | None = None

    def expected_share(self, parameters: Mapping[str, Any]) -> float | None:
        """The share of the whole area that a part of low value has; None where nothing is said.

        Parameters
        ----------
        parameters : mapping of str to value
            Those that a call gives.

        Raises
        ------
        ValueError
            What the objective answers is neither None nor a number above 0 and at most 1; or
            whatever else its function raises.

        Examples
        --------
        >>> traits = Traits(arity="unary", share=lambda given: given.get("most"))
        >>> traits.expected_share({"most": 0.2})
        0.2
        """
        found = None if self.share is None else self.share(parameters)
        if found is None:
            return None
        if isinstance(found, bool) or not isinstance(found, Real) or not 0 < found <= 1:
            raise ValueError(
                f"a share is a number above 0 and at most 1, or None, not {found!r:.60}"
            )
        return float(found)

    def averaged_field(self, parameters: Mapping[str, Any]) -> tuple[str, Mapping[str, Any]] | None:
        """The field whose mean over a part is the value; None where there is none.

        Parameters
        ----------
        parameters : mapping of str to value
            Those that a call gives.

        Returns
        -------
        (str, mapping) or None
            The field's id, and its own parameters.

        Raises
        ------
        ValueError
            What the objective answers is none of these; or whatever else its function raises.

        Examples
        --------
        >>> traits = Traits(arity="unary", mean_of=lambda given: ("basic:thickness", {}))
        >>> traits.averaged_field({})
        ('basic:thickness', {})
        """
        found = None if self.mean_of is None else self.mean_of(parameters)
        if found is None:
            return None
        kinds = (str, Mapping)
        if (
            not isinstance(found, tuple)
            or len(found) != 2
            or not all(map(isinstance, found, kinds))
        ):
            raise ValueError(
                "what a value is the mean of is a tuple of a field's id and a mapping of its"
                f" parameters, or None, not {found!r:.60}"
            )
        return found

    @property
    def takes(self) -> str:
        """How many labels the objective takes, in words."""
        if self.arity == "global":
            return "no labels"
        if self.arity == "unary":
            return "one label, or several to be summed"
        if self.least == self.most:
            return f"exactly {self.least} labels"
        few = "one label" if self.least == 1 else f"{self.least} labels"
        return f"{few} or more" + (f", at most {self.most}" if self.most else "")


class FunctionObjective:
    """An objective made from a function by :func:`objective`; carries its name and docstring.

    Parameters
    ----------
    function : callable
    traits : Traits
    spread : bool
        Whether the parts of an n-ary objective are passed as arguments of their own.
    """

    def __init__(
        self, function: Callable[..., float], traits: Traits, *, spread: bool = False
    ) -> None:
        functools.update_wrapper(self, function)
        self.traits = traits
        self._function = function
        self._spread = spread

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The keyword-only arguments of the function."""
        return declared_parameters(self._function)

    def __call__(self, subject: Any, /, **parameters: Any) -> float:
        """Value for a part, a sequence of parts or a segmentation, as the arity says."""
        if self._spread:
            return self._function(*subject, **parameters)
        return self._function(subject, **parameters)

    def __reduce__(self) -> str:
        # The decorated name in its module is this object, so it pickles by reference.
        return self._function.__qualname__


def objective(
    *,
    range: tuple[float, float] = (-math.inf, math.inf),
    requires: Iterable[Requirement] = (),
    invariant_to: Iterable[Invariance] = (),
    cost: CostClass = "cheap",
    least: int | None = None,
    fields: Sequence[str] | FieldNames = (),
    measures: Sequence[str] = (),
    share: ShareOf | None = None,
    mean_of: MeanOf | None = None,
    details: DetailsOf | None = None,
    vectorized: Vectorized | None = None,
    at_least: Vectorized | None = None,
) -> Callable[[Callable[..., float]], FunctionObjective]:
    """Turn a function of parts into an objective.

    Parameters
    ----------
    range, requires, invariant_to, cost
        See :class:`Traits`.
    least : int, optional
        Least number of parts of an objective over a sequence of parts; 2 by default.
    fields : sequence of str or callable
        Ids of the fields that the objective reads (``"basic:thickness"``), or a function from the
        parameters that a call gives to those. Fields are computed once per shape; those that are
        declared before the search, so that a shape on which that fails is refused at once, and
        processes share them.
    measures : sequence of str
        Ids of the measures that the objective takes and that require something of the shape
        (``"vessels:bore"``): a shape that lacks it is then refused before the search.
    share : callable, optional
        Where the objective knows which share of the whole area its parts should have: a function
        from the parameters that a call gives to that share, above 0 and at most 1, or to None.
        Searches place their seeds by it.
    mean_of : callable, optional
        Where the value on a part is the mean of a field over it, weighted by area: a function from
        the parameters that a call gives to the field's id and a mapping of its parameters, or to
        None. Refiners move boundaries by what the field says of each place.
    details : callable, optional
        Where the value comes from several quantities: a function that is called like the objective
        and returns a :class:`moseg_core.Detail` for each. Users see the costliest of each part.
    vectorized : callable, optional
        The same formula for many calls at once, by arrays: a function of a
        :class:`moseg_core.PartArray` and the same parameters, which returns a value for each call.
        A search then asks for the parts of a whole batch of candidates in one call, which may be
        tens of times as fast. Values may differ from the function's own by rounding, and must not
        depend on which other calls they are computed with.
    at_least : callable, optional
        Where a value takes long and something that it is not below does not: a function of the
        same form that returns that for each call. A search then does without the value of a
        candidate that is too costly even so. Give it where there is no vectorised form, which is
        asked in its stead.

    Returns
    -------
    callable
        A decorator.

    Raises
    ------
    TypeError
        The first argument's annotation is none of Part, Sequence[Part] and Segmentation.
    ValueError
        A range whose ends are in the wrong order; an unknown requirement, invariance or cost; a
        share, mean, details, vectorized form or lower bound that are no function; measures that
        are no texts; the mean of a field for several parts.

    Examples
    --------
    >>> @objective(range=(0, 1), invariant_to=("rigid", "scale"))
    ... def narrow(part: Part) -> float:
    ...     s1, s2, s3 = part.scales
    ...     return (s2 + s3) / (2 * s1)
    >>> narrow.traits.arity, narrow.traits.takes
    ('unary', 'one label, or several to be summed')
    """
    if not range[0] < range[1]:
        raise ValueError(f"an objective's range goes from low to high, not {range}")
    for what, given, allowed in (
        ("requires", requires, get_args(Requirement)),
        ("invariant_to", invariant_to, get_args(Invariance)),
        ("cost", (cost,), get_args(CostClass)),
    ):
        if isinstance(given, str) or not set(given) <= set(allowed):
            raise ValueError(f"an objective's {what} is of {', '.join(allowed)}; not {given!r}")
    if isinstance(measures, str) or not all(isinstance(name, str) for name in measures):
        raise ValueError(f"an objective's measures are ids in a tuple, not {measures!r}")
    if share is not None and not callable(share):
        raise ValueError(f"an objective's share is a function of its parameters, not {share!r}")

    if mean_of is not None and not callable(mean_of):
        raise ValueError(f"the field of a mean is told by a function, not {mean_of!r}")

    if details is not None and not callable(details):
        raise ValueError(f"an objective's details are told by a function, not {details!r}")

    if vectorized is not None and not callable(vectorized):
        raise ValueError(f"an objective's vectorized form is a function, not {vectorized!r}")

    if at_least is not None and not callable(at_least):
        raise ValueError(f"an objective's lower bound is a function, not {at_least!r}")

    def decorate(function: Callable[..., float]) -> FunctionObjective:
        arity, count = _read_signature(function)
        if mean_of is not None and arity != "unary":
            raise ValueError("the value of an objective of several parts is no mean over one")
        spread = arity == "nary" and count is not None
        traits = Traits(
            arity=arity,
            range=(float(range[0]), float(range[1])),
            requires=frozenset(requires),
            invariant_to=frozenset(invariant_to),
            cost=cost,
            least=count if count is not None else (2 if least is None else least),
            most=count,
            fields=fields if callable(fields) else tuple(fields),
            measures=tuple(measures),
            share=share,
            mean_of=mean_of,
            details=_spreading(details) if spread and details is not None else details,
            vectorized=vectorized,
            at_least=at_least,
        )
        made = FunctionObjective(function, traits, spread=spread)
        _ = made.parameters  # so that a parameter of an odd type shows here, not on first use
        return made

    return decorate


def _spreading(details: DetailsOf) -> DetailsOf:
    """The same for parts in one sequence, of a function that takes them as arguments."""
    return lambda parts, **parameters: details(*parts, **parameters)


def _read_signature(function: Callable[..., float]) -> tuple[Arity, int | None]:
    """(arity, fixed number of parts or None) from the annotations of the positional arguments."""
    name = getattr(function, "__name__", repr(function))
    try:
        hints = get_type_hints(function)
        signature = inspect.signature(function)
    except (NameError, ValueError) as error:
        raise TypeError(f"the signature of '{name}' cannot be read: {error}") from error
    positional = [
        parameter
        for parameter in signature.parameters.values()
        if parameter.kind is not inspect.Parameter.KEYWORD_ONLY
    ]
    kinds = [
        None if parameter.kind is inspect.Parameter.VAR_POSITIONAL else hints.get(parameter.name)
        for parameter in positional
    ]
    if kinds == [Segmentation]:
        return "global", None
    if kinds == [Part]:
        return "unary", 1
    if len(kinds) > 1 and all(kind is Part for kind in kinds):
        return "nary", len(kinds)
    if len(kinds) == 1 and get_args(kinds[0])[:1] == (Part,):
        origin = get_origin(kinds[0])
        if isinstance(origin, type) and issubclass(origin, Sequence):
            return "nary", None
    raise TypeError(
        f"objective '{name}' must take a Part, several arguments annotated Part, a"
        f" Sequence[Part] or a Segmentation; parameters come after '*'"
    )
