"""Checks of constraints: from free numbers to centres and back (Sec. 8).

What a constraint leaves free is all that the search sees, so it must find in there what seeders
placed: `reduce` leads from any centres to the free numbers of feasible ones near to them,
`expand` from the numbers to the centres. That the two undo each other is what these checks are
about. Constraints are tried on a lump that is its own mirror image in the plane ``x`` through its
middle, of as few labels as they take.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from moseg_core.components.protocols import Constraint
from moseg_core.testing.check import ContractFailure, Subject, check
from moseg_core.testing.fixtures import problems
from moseg_core.testing.fixtures.comparison import as_numbers, expect_equal
from moseg_core.testing.fixtures.shapes import twin
from moseg_core.testing.fixtures.trial import Trial, declared
from moseg_core.types import FloatArray

_CLOSE = 1e-7
_COUNT = 6


def _made(subject: Subject) -> Iterator[tuple[str, Constraint]]:
    """The constraint on some numbers of labels; the plane is given to it, and to be found."""
    planar = any(parameter.name == "plane" for parameter in declared(subject))
    variants = ({"plane": "x"}, {}) if planar else ({},)
    shape = subject.keep("twin", twin)  # planes that are found in it are remembered
    return islice(problems.constraints_on(Trial(subject=subject), shape, *variants), 3)


def _bounds(made: Constraint) -> tuple[FloatArray, FloatArray]:
    return as_numbers(made.lower), as_numbers(made.upper)


def _free(made: Constraint) -> FloatArray:
    """(6, k) float: free numbers within the bounds, none of them far away."""
    lower, upper = _bounds(made)
    numbers = problems.within(lower, upper, np.full(len(lower), 0.5), 3 * _COUNT)
    near: FloatArray = numbers[np.arange(3 * _COUNT) % 3 != 2][:_COUNT]
    return near


def _expanded(made: Constraint, free: FloatArray, centers: FloatArray) -> FloatArray:
    return as_numbers(made.expand(free, centers.copy()))


def _reduced(made: Constraint, centers: FloatArray) -> tuple[FloatArray, FloatArray]:
    free, rows = made.reduce(centers.copy())
    return as_numbers(free), as_numbers(rows)


@check("constraint-dimensions", kinds=["constraint"])
def _dimensions(subject: Subject) -> None:
    """The search has as many coordinates as a constraint says; all that it returns must fit."""
    for what, made in _made(subject):
        determines, reads = tuple(made.determines), tuple(made.reads)
        legal = all(label in range(problems.N_CENTERS) for label in (*determines, *reads))
        if not determines or not legal or set(determines) & set(reads):
            raise ContractFailure(
                did=f"'determines' and 'reads' were looked up for {what}",
                got=f"{determines} and {reads}",
                expected="labels that it was given, at least one determined, none of those read",
                fix="use the numbers in the argument 'labels' as they are",
            )
        lower, upper = _bounds(made)
        if lower.ndim != 1 or lower.shape != upper.shape or not (lower <= upper).all():
            raise ContractFailure(
                did=f"'lower' and 'upper' were looked up for {what}",
                got=f"{lower.tolist()} and {upper.tolist()}",
                expected="one number each per free number, lower never above upper",
                fix="use -inf and inf where a number is unbounded, and empty arrays for none",
            )
        for centers in problems.rows_of_centers(2):
            free, rows = _reduced(made, centers)
            whole = _expanded(made, _free(made)[0], centers)
            if (free.shape, rows.shape, whole.shape) != (lower.shape, *[centers.shape] * 2):
                raise ContractFailure(
                    did=f"reduce() and expand() were called for {what}",
                    got=f"{free.shape} free numbers and centres of shape {rows.shape}, then"
                    f" centres of shape {whole.shape}",
                    expected=f"{lower.shape} free numbers, as 'lower' says, and all centres,"
                    f" {centers.shape}",
                    fix="return the rows of all labels, those of others unchanged",
                )


@check("constraint-in-bounds", kinds=["constraint"])
def _in_bounds(subject: Subject) -> None:
    """The search begins at the reduced numbers and moves within the bounds; both must do."""
    for what, made in _made(subject):
        lower, upper = _bounds(made)
        for centers in problems.rows_of_centers(_COUNT):
            free, _ = _reduced(made, centers)
            if free.shape == lower.shape and not ((free >= lower) & (free <= upper)).all():
                raise ContractFailure(
                    did=f"centres in the unit box, of weights near 1, were reduced for {what}",
                    got=f"{free.tolist()}",
                    expected=f"numbers from {lower.tolist()} to {upper.tolist()}",
                    fix="clip them, or widen the bounds",
                )
        for free in _free(made):
            rows = _expanded(made, free, next(problems.rows_of_centers(1)))[list(made.determines)]
            # A weight of 0 or less costs as much as can be; no number at all cannot be ranked.
            if not np.isfinite(rows).all():
                raise ContractFailure(
                    did=f"{free.tolist()}, within the bounds, was expanded for {what}",
                    got=f"the rows {rows.tolist()}",
                    expected="finite positions and weights",
                    fix="bound the numbers where the formula has no value",
                )


@check("constraint-reduce-expand", kinds=["constraint"])
def _reduce_expand(subject: Subject) -> None:
    """A search that goes on from its own result must begin where it ended."""
    for what, made in _made(subject):
        for free, centers in zip(_free(made), problems.rows_of_centers(_COUNT), strict=True):
            back, _ = _reduced(made, _expanded(made, free, centers))
            expect_equal(
                back,
                free,
                tolerance=_CLOSE,
                did=f"{free.round(6).tolist()} was expanded for {what}, and reduced again",
                got=f"{back.round(6).tolist()}",
                expected="the same numbers",
                fix="let reduce() undo expand(); bound angles so that they mean one thing",
            )


@check("constraint-feasible", kinds=["constraint"])
def _feasible(subject: Subject) -> None:
    """The centres that reduce() returns are read by other constraints; they must be feasible."""
    for what, made in _made(subject):
        for centers in problems.rows_of_centers(_COUNT):
            free, rows = _reduced(made, centers)
            expect_equal(
                _expanded(made, free, rows),
                rows,
                tolerance=_CLOSE,
                did=f"any centres were reduced for {what}, and what came back expanded",
                got="rows that differ by up to {} from those of reduce()",
                expected="the same: reduce() returns the feasible centres that its numbers stand"
                " for",
                fix="end reduce() with return free, self.expand(free, rows)",
            )


@check("constraint-unchanged", kinds=["constraint"])
def _unchanged(subject: Subject) -> None:
    """Centres that obey already need no correction; moving them spoils a good start."""
    for what, made in _made(subject):
        for free, centers in zip(_free(made), problems.rows_of_centers(_COUNT), strict=True):
            whole = _expanded(made, free, centers)
            expect_equal(
                _reduced(made, whole)[1],
                whole,
                tolerance=_CLOSE,
                did=f"feasible centres were reduced for {what}",
                got="centres moved by up to {}",
                expected="the same centres",
                fix="return the nearest feasible centres: for feasible ones, themselves",
            )


@check("constraint-touches-only-its-own", kinds=["constraint"])
def _touches(subject: Subject) -> None:
    """Constraints are put together by what they determine and read; nothing else may change."""
    for what, made in _made(subject):
        determines, reads = list(made.determines), list(made.reads)
        unread = [k for k in range(problems.N_CENTERS) if k not in (*determines, *reads)]
        fixed = [k for k in range(problems.N_CENTERS) if k not in determines]
        free = _free(made)[0]
        first, other = problems.rows_of_centers(2)
        whole, rows = _expanded(made, free, first), _reduced(made, first)[1]
        for title, found, kept, own in (
            ("expand()", whole, fixed, "determined"),
            ("reduce()", rows, unread, "determined or read"),
        ):
            expect_equal(
                found[kept],
                first[kept],
                did=f"{title} was called for {what}",
                got=f"other rows changed than those {own}",
                expected=f"the rows of {kept} as they were",
                fix="copy the rows that are given, and fill in those of its labels",
            )
        mixed = first.copy()
        mixed[[*determines, *unread]] = other[[*determines, *unread]]
        expect_equal(
            _expanded(made, free, mixed)[determines],
            whole[determines],
            did=f"expand() was called for {what}, and again with rows changed that it does not"
            " read",
            got="other centres",
            expected=f"centres that depend on its numbers and the rows of {reads} only",
            fix="name every label whose row counts in 'reads'",
        )
