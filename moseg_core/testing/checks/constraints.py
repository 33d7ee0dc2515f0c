"""Checks of constraints: from free numbers to centres and back (Sec. 8).

What a constraint leaves free is all that the search sees, so it must find in there what seeders
placed: `reduce` leads from any centres to the free numbers of feasible ones near to them,
`expand` from the numbers to the centres. That the two undo each other is what these checks are
about. Constraints are tried on a pebble that is its own mirror image in the plane ``x`` through
its middle, of as few labels as they take.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from moseg_core.components.protocols import Constraint
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Subject, check
from moseg_core.testing.checks.parameterizations import within
from moseg_core.testing.fixtures.problems import (
    as_numbers,
    even_pebble,
    refused,
    unlike,
)
from moseg_core.testing.fixtures.trial import declared, values_for
from moseg_core.types import FloatArray

_LABELS = 6
_CLOSE = 1e-7


def _made(subject: Subject) -> list[tuple[str, Constraint]]:
    """The constraint on as few labels as it takes, the last first, and on one more if it can be.

    One that takes a plane is given the plane ``x``, and once has to find it by itself.
    """
    shape, reason = even_pebble(), ""
    found: list[tuple[str, Constraint]] = []
    planar = any(parameter.name == "plane" for parameter in declared(subject))
    for count in range(1, _LABELS):
        labels = tuple(range(count, 0, -1))
        given = values_for(subject, shape, labels)
        tried = [given]
        if planar and "plane" not in given:
            tried = [{**given, "plane": "x"}, *([] if found else [given])]
        for values in tried:
            made, no = refused(partial(_usable, subject.load(), shape, labels, values))
            if made is not None:
                found.append((_called(labels, values), made))
            reason = reason or no
        if len(found) > 2:
            break
    if not found:
        raise ContractFailure(
            did=f"it was to be made for 1 to {_LABELS - 1} labels of a symmetric shape",
            got=f"a refusal each time, at first: {reason}",
            expected="a constraint on some number of labels",
            fix="write example(shape, labels), which returns parameters that make sense there",
        )
    return found


def _usable(
    factory: Callable[..., Any], shape: Shape, labels: tuple[int, ...], values: Mapping[str, Any]
) -> Constraint:
    """The constraint; one made from a function refuses a number of labels when it is used."""
    made: Constraint = factory(shape, labels, **values)
    made.reduce(next(_centers()))
    return made


def _called(labels: tuple[int, ...], values: Mapping[str, Any]) -> str:
    more = "".join(f", {name}={value}" for name, value in values.items())
    return f"labels {', '.join(map(str, labels))} of {_LABELS}{more}"


def _centers(count: int = 6) -> Iterator[FloatArray]:
    """Rows as a seeder places them: in the unit box, of weights near 1."""
    rng = np.random.default_rng(5)
    for _ in range(count):
        yield np.column_stack(
            [rng.uniform(-0.4, 0.4, (_LABELS, 3)), rng.uniform(0.7, 1.4, _LABELS)]
        )


def _numbers(made: Constraint, count: int = 6) -> FloatArray:
    """(count, k) float: free numbers within the bounds, none of them far away."""
    lower, upper = as_numbers(made.lower), as_numbers(made.upper)
    numbers = within(lower, upper, np.full(len(lower), 0.5), 3 * count)
    near: FloatArray = numbers[np.arange(3 * count) % 3 != 2][:count]
    return near


def _expanded(made: Constraint, free: FloatArray, centers: FloatArray) -> FloatArray:
    return as_numbers(made.expand(free, centers))


def _rows(array: FloatArray, labels: tuple[int, ...]) -> FloatArray:
    rows: FloatArray = array[list(labels)]
    return rows


@check(
    "constraint-dimensions",
    kinds=["constraint"],
    why="the search has as many coordinates as a constraint says; all that it returns must fit",
)
def _dimensions(subject: Subject) -> None:
    for what, made in _made(subject):
        determines, reads = tuple(made.determines), tuple(made.reads)
        legal = all(label in range(_LABELS) for label in (*determines, *reads))
        if not determines or not legal or set(determines) & set(reads):
            raise ContractFailure(
                did=f"'determines' and 'reads' were looked up for {what}",
                got=f"{determines} and {reads}",
                expected="labels that it was given, at least one determined, none of those read",
                fix="use the numbers in the argument 'labels' as they are",
            )
        lower, upper = as_numbers(made.lower), as_numbers(made.upper)
        if lower.ndim != 1 or lower.shape != upper.shape or not (lower <= upper).all():
            raise ContractFailure(
                did=f"'lower' and 'upper' were looked up for {what}",
                got=f"{lower.tolist()} and {upper.tolist()}",
                expected="one number each per free number, lower never above upper",
                fix="use -inf and inf where a number is unbounded, and empty arrays for none",
            )
        for centers in _centers(2):
            free, rows = made.reduce(centers.copy())
            whole = _expanded(made, _numbers(made, 1)[0], centers.copy())
            shapes = as_numbers(free).shape, as_numbers(rows).shape, whole.shape
            if shapes != (lower.shape, centers.shape, centers.shape):
                raise ContractFailure(
                    did=f"reduce() and expand() were called for {what}",
                    got=f"{shapes[0]} free numbers and centres of shape {shapes[1]}, then centres"
                    f" of shape {shapes[2]}",
                    expected=f"{lower.shape} free numbers, as 'lower' says, and all centres,"
                    f" {centers.shape}",
                    fix="return the rows of all labels, those of others unchanged",
                )


@check(
    "constraint-in-bounds",
    kinds=["constraint"],
    why="the search begins at the reduced numbers and moves within the bounds; both must do",
)
def _in_bounds(subject: Subject) -> None:
    for what, made in _made(subject):
        lower, upper = as_numbers(made.lower), as_numbers(made.upper)
        for centers in _centers():
            free = as_numbers(made.reduce(centers.copy())[0])
            if free.shape == lower.shape and not ((free >= lower) & (free <= upper)).all():
                raise ContractFailure(
                    did=f"centres in the unit box, of weights near 1, were reduced for {what}",
                    got=f"{free.tolist()}",
                    expected=f"numbers from {lower.tolist()} to {upper.tolist()}",
                    fix="clip them, or widen the bounds",
                )
        for free in _numbers(made):
            rows = _rows(_expanded(made, free, next(_centers())), tuple(made.determines))
            # A weight of 0 or less costs as much as can be; no number at all cannot be ranked.
            if not np.isfinite(rows).all():
                raise ContractFailure(
                    did=f"{free.tolist()}, within the bounds, was expanded for {what}",
                    got=f"the rows {rows.tolist()}",
                    expected="finite positions and weights",
                    fix="bound the numbers where the formula has no value",
                )


@check(
    "constraint-reduce-expand",
    kinds=["constraint"],
    why="a search that goes on from its own result must begin where it ended",
)
def _reduce_expand(subject: Subject) -> None:
    for what, made in _made(subject):
        for free, centers in zip(_numbers(made), _centers(), strict=True):
            back = made.reduce(_expanded(made, free, centers))[0]
            difference = unlike(back, free, tolerance=_CLOSE)
            if difference is not None:
                raise ContractFailure(
                    did=f"{free.round(6).tolist()} was expanded for {what}, and reduced again",
                    got=f"{as_numbers(back).round(6).tolist()}",
                    expected="the same numbers",
                    fix="let reduce() undo expand(); bound angles so that they mean one thing",
                )


@check(
    "constraint-feasible",
    kinds=["constraint"],
    why="the centres that reduce() returns are read by other constraints; they must be feasible",
)
def _feasible(subject: Subject) -> None:
    for what, made in _made(subject):
        for centers in _centers():
            free, rows = made.reduce(centers.copy())
            whole = _expanded(made, free, as_numbers(rows).copy())
            difference = unlike(whole, rows, tolerance=_CLOSE)
            if difference is not None:
                raise ContractFailure(
                    did=f"any centres were reduced for {what}, and what came back expanded",
                    got=f"rows that differ by up to {difference:.3g} from those of reduce()",
                    expected="the same: reduce() returns the feasible centres that its numbers"
                    " stand for",
                    fix="end reduce() with return free, self.expand(free, rows)",
                )


@check(
    "constraint-unchanged",
    kinds=["constraint"],
    why="centres that obey already need no correction; moving them spoils a good start",
)
def _unchanged(subject: Subject) -> None:
    for what, made in _made(subject):
        for free, centers in zip(_numbers(made), _centers(), strict=True):
            whole = _expanded(made, free, centers)
            rows = made.reduce(whole.copy())[1]
            difference = unlike(rows, whole, tolerance=_CLOSE)
            if difference is not None:
                raise ContractFailure(
                    did=f"feasible centres were reduced for {what}",
                    got=f"centres moved by up to {difference:.3g}",
                    expected="the same centres",
                    fix="return the nearest feasible centres: for feasible ones, themselves",
                )


@check(
    "constraint-touches-only-its-own",
    kinds=["constraint"],
    why="constraints are put together by what they determine and read; nothing else may change",
)
def _touches(subject: Subject) -> None:
    for what, made in _made(subject):
        determines, reads = tuple(made.determines), tuple(made.reads)
        unread = [k for k in range(_LABELS) if k not in (*determines, *reads)]
        fixed = [k for k in range(_LABELS) if k not in determines]
        free = _numbers(made, 1)[0]
        first, other = _centers(2)
        whole, rows = _expanded(made, free, first.copy()), as_numbers(made.reduce(first.copy())[1])
        for title, got, kept in (("expand()", whole, fixed), ("reduce()", rows, unread)):
            if unlike(got[kept], first[kept]) is not None:
                raise ContractFailure(
                    did=f"{title} was called for {what}",
                    got="other rows changed than those"
                    + (" determined" if title == "expand()" else " determined or read"),
                    expected=f"the rows of {kept} as they were",
                    fix="copy the rows that are given, and fill in those of its labels",
                )
        mixed = first.copy()
        mixed[[*determines, *unread]] = other[[*determines, *unread]]
        again = _expanded(made, free, mixed)
        if unlike(_rows(again, determines), _rows(whole, determines)) is not None:
            raise ContractFailure(
                did=f"expand() was called for {what}, and again with rows changed that it does"
                " not read",
                got="other centres",
                expected=f"centres that depend on its numbers and the rows of {list(reads)} only",
                fix="name every label whose row counts in 'reads'",
            )
