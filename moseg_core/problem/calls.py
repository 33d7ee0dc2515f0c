"""The calls of a term: what the objective is given, and what of its answers is a value (Sec. 3).

A call is about one part, several, or the segmentation, and is left out where a part that it would
be given is empty. What an objective answers must be a real number in the range that it declares;
if not, or if it raises, the error names the objective, its distribution, the term and the labels.

Values are remembered per objective and part (:mod:`moseg_core.components.memo`). Of an objective
that has a vectorised form only that is used, for one call as for a thousand, so that a value does
not depend on how it was asked for. Its values are not remembered: to look one up takes as long as
to compute it. :mod:`moseg_core.problem.aggregate` adds values up.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from typing import cast

import numpy as np

from moseg_core.components.at_work import at_work
from moseg_core.components.detail import Detail
from moseg_core.components.faults import describe, is_fault, place, safe_repr
from moseg_core.components.labellings import Labellings
from moseg_core.components.memo import Memo
from moseg_core.components.part_array import PartArray
from moseg_core.components.profile import timed
from moseg_core.components.real_number import described, real_number
from moseg_core.components.requirements import LackError
from moseg_core.components.segmentation import Segmentation
from moseg_core.components.side_effects import without_side_effects
from moseg_core.errors import REPORT, PluginError, UsageError
from moseg_core.problem.binding import BoundTerm
from moseg_core.problem.call_limit import CallTimeoutError, limited, told_late
from moseg_core.problem.slow_calls import under_watch
from moseg_core.types import BoolArray, FloatArray, IntArray


def empty_parts(terms: Sequence[BoundTerm], segmentation: Segmentation) -> list[bool]:
    """Which parts are empty, or have no extent in one of the spaces that terms look at them in."""
    empty: list[bool] = all_empty_parts(terms, segmentation.labelling)[0].tolist()
    return empty


def all_empty_parts(terms: Sequence[BoundTerm], labellings: Labellings) -> BoolArray:
    """(B, n) bool: the same of several labellings."""
    empty = np.zeros(labellings.areas.shape, np.bool_)
    for space in {labellings.level.space, *[term.space for term in terms]}:
        view = labellings.view(space)
        empty |= view.summary.empty(view.level.input)
    return empty


def leaves_out(term: BoundTerm, call: tuple[int, ...], empty: Sequence[bool]) -> bool:
    """Whether a call would receive an empty part, and is therefore left out of the sum."""
    if True not in empty:  # as nearly always
        return False
    concerned = range(len(empty)) if term.arity == "global" else call
    return any(empty[k] for k in concerned)


def call_value(
    term: BoundTerm,
    call: tuple[int, ...],
    segmentation: Segmentation,
    empty: Sequence[bool],
    labels: Sequence[str],
) -> float | None:
    """The value of one call, remembered; None where one of its parts is empty.

    Raises
    ------
    PluginError
        The objective raised, or returned something that is not a number in its range. The
        message names the objective, its distribution, the term and the labels.
    """
    if leaves_out(term, call, empty):
        return None
    if term.vectorized is not None:
        members = np.array([call if term.arity != "global" else range(segmentation.n_parts)])
        return float(vectorized_values(term, segmentation.labelling, np.zeros(1, int), members)[0])
    segmentation = segmentation.view(term.space)
    key = _key(term, call, segmentation)
    value: float = segmentation.memo.get(key, _computed, term, call, segmentation, labels)
    return value


def term_values(
    term: BoundTerm, segmentation: Segmentation, empty: Sequence[bool], labels: Sequence[str]
) -> list[float | None]:
    """The values of all calls of a term; see :func:`call_value`."""
    if term.vectorized is None:
        return [call_value(term, call, segmentation, empty, labels) for call in term.calls]
    order = np.arange(segmentation.n_parts)[None]
    return all_term_values(
        term, segmentation.labelling, np.zeros(1, int), order, np.array([empty])
    )[0]


def all_term_values(
    term: BoundTerm,
    labellings: Labellings,
    rows: IntArray,
    orders: IntArray,
    empty: BoolArray,
    *,
    bounded_by: Memo | None = None,
) -> list[list[float | None]]:
    """The values of all calls of a vectorised term on several candidates.

    Parameters
    ----------
    term : BoundTerm
    labellings : Labellings
    rows : (C,) int
        The labelling that each candidate is of.
    orders : (C, n) int
        Which of its parts bears each label.
    empty : (C, n) bool
        Which labels have an empty part.
    bounded_by : Memo, optional
        Given where lower bounds are asked for instead, of a term that has those: what is remembered
        of parts makes them better.

    Raises
    ------
    PluginError
        As for :func:`call_value`.
    """
    n = orders.shape[1]
    calls = np.array([range(n)] if term.arity == "global" else term.calls)
    count, sound = len(calls), ~empty[:, calls].any(axis=2)
    repeated, members = np.repeat(rows, count), orders[:, calls].reshape(-1, calls.shape[1])
    if sound.all():
        values = vectorized_values(term, labellings, repeated, members, bounded_by=bounded_by)
        # Lists as they are: a copy, for the sake of a type, would take a twentieth of a search.
        return cast("list[list[float | None]]", values.reshape(-1, count).tolist())
    kept = np.flatnonzero(sound)
    some = vectorized_values(
        term, labellings, repeated[kept], members[kept], bounded_by=bounded_by
    ).tolist()
    flat: list[float | None] = [None] * sound.size
    for k, value in zip(kept.tolist(), some, strict=True):
        flat[k] = value
    return [flat[k : k + count] for k in range(0, len(flat), count)]


def vectorized_values(
    term: BoundTerm,
    labellings: Labellings,
    rows: IntArray,
    members: IntArray,
    *,
    bounded_by: Memo | None = None,
) -> FloatArray:
    """(k,) float: the values of calls of a vectorised term, of parts none of which is empty.

    Where there are no calls, the objective is not asked.

    Parameters
    ----------
    term : BoundTerm
    labellings : Labellings
    rows : (k,) int
        The labelling that each call is about.
    members : (k, m) int
        The parts that each is given.
    bounded_by : Memo, optional
        Given where lower bounds are asked for instead, of a term that has those: what is remembered
        of parts makes them better.

    Raises
    ------
    PluginError
        The objective raised, or returned something else than k numbers in its range.
    """
    if not len(rows):
        return np.empty(0)
    if term.arity == "unary" and len(labellings) > 1:  # parts that occur several times, once
        n = labellings.n_parts
        first_rows, first_parts = labellings.first(rows, members[:, 0])
        distinct, which = np.unique(first_rows * n + first_parts, return_inverse=True)
        return _answered(term, labellings, distinct // n, distinct[:, None] % n, bounded_by)[which]
    return _answered(term, labellings, rows, members, bounded_by)


def _answered(
    term: BoundTerm,
    labellings: Labellings,
    rows: IntArray,
    members: IntArray,
    bounded_by: Memo | None,
) -> FloatArray:
    """(k,) float: what the vectorised form answers, once it is known to be k numbers in range."""
    parts = members[:, 0] if term.arity == "unary" else members
    array = PartArray(
        _labellings=labellings.view(term.space), _rows=rows, _parts=parts, _memo=bounded_by
    )
    what = "vectorized form" if bounded_by is None else "lower bound"
    who = f"the {what} of objective '{term.id}' of {term.distribution}"
    where = f"'{term.term.call}'"
    doing = f"{who} in {where}"
    form = term.vectorized if bounded_by is None else term.at_least
    assert form is not None  # callers have looked
    try:
        profiled = timed("term", term.written, term.distribution, calls=len(rows))
        watched = under_watch(doing)
        with at_work(doing), watched, profiled, without_side_effects(who), limited(doing):
            returned = form(array, **term.parameters)
    except UsageError as error:
        raise UsageError(f"in {where}: {error}") from error
    except LackError as error:
        raise LackError(f"in {where}: {error}") from error
    except PluginError as error:
        raise PluginError(f"in {where}: {error}") from error
    except CallTimeoutError as error:
        raise PluginError(f"{who} {told_late(error, where, place(error))}") from error
    except BaseException as error:
        if not is_fault(error):
            raise
        raise PluginError(f"{who} failed in {where}: {describe(error)}; {REPORT}") from error
    try:
        given = np.asarray(returned)
    except ValueError:  # rows of different lengths
        given = np.empty(0)
    if given.shape != rows.shape or given.dtype.kind not in "fiu":
        raise PluginError(
            f"{who} returned {described(returned)} in {where}; it must return an array of"
            f" {len(rows)} real numbers, one for each call; {REPORT}"
        )
    values: FloatArray = given.astype(np.float64)
    low, high = term.objective.traits.range
    if bounded_by is not None:  # to be below the range is to know nothing
        values = np.maximum(values, low)
    if not (np.isfinite(values) & (values >= low) & (values <= high)).all():
        values = np.array([_in_range(value, term, where) for value in values.tolist()])
    return values


def known_value(term: BoundTerm, call: tuple[int, ...], segmentation: Segmentation) -> float | None:
    """The value of one call of parts that are not empty, None where it is not remembered."""
    segmentation = segmentation.view(term.space)
    value: float | None = segmentation.memo.known(_key(term, call, segmentation))
    return value


def _key(term: BoundTerm, call: tuple[int, ...], segmentation: Segmentation) -> Hashable:
    """Under which the value of a call is remembered."""
    known = segmentation.memberships
    if term.arity == "unary":
        return (term.memo_key, known[call[0]], segmentation.level.key)
    members = known if term.arity == "global" else tuple([known[k] for k in call])
    return (term.memo_key, members, segmentation.level.key)


def _computed(
    term: BoundTerm, call: tuple[int, ...], segmentation: Segmentation, labels: Sequence[str]
) -> float:
    """The value of a call; parts are made only here, where it is not remembered."""
    subject = _subject(term, call, segmentation)
    who = f"objective '{term.id}' of {term.distribution}"
    where = _where(term, call, labels)
    doing = f"{who} in {where}"
    try:
        profiled = timed("term", term.written, term.distribution)
        watched = under_watch(doing)
        with at_work(doing), watched, profiled, without_side_effects(who), limited(doing):
            returned = term.objective(subject, **term.parameters)
    except UsageError as error:  # it says what is wrong with its parameters
        raise UsageError(f"in {where}: {error}") from error
    except LackError as error:  # what a measure or field requires that was not declared
        raise LackError(f"in {where}: {error}") from error
    except PluginError as error:  # it names another component, such as a measure
        raise PluginError(f"in {where}: {error}") from error
    except CallTimeoutError as error:
        raise PluginError(f"{who} {told_late(error, where, place(error))}") from error
    except BaseException as error:
        if not is_fault(error):
            raise
        raise PluginError(f"{who} failed in {where}: {describe(error)}; {REPORT}") from error
    value = real_number(returned)
    if value is None:
        raise PluginError(
            f"{who} returned {described(returned)} in {where}; a value must be a real number, such"
            f" as float(...) makes; {REPORT}"
        )
    return _in_range(value, term, where)


def _subject(term: BoundTerm, call: tuple[int, ...], segmentation: Segmentation) -> object:
    """What the objective of a term receives: a part, several, or the segmentation."""
    if term.arity == "unary":
        return segmentation.part(call[0])
    if term.arity == "nary":
        return tuple([segmentation.part(k) for k in call])
    return segmentation


def call_details(
    term: BoundTerm, call: tuple[int, ...], segmentation: Segmentation
) -> tuple[Detail, ...]:
    """What the value of one call comes from; nothing where the objective does not tell.

    Raises
    ------
    PluginError
        The objective fails to tell.
    """
    told = term.objective.traits.details
    if told is None:
        return ()
    subject = _subject(term, call, segmentation.view(term.space))
    who = f"objective '{term.id}' of {term.distribution}"
    try:
        found = tuple(told(subject, **term.parameters))
    except BaseException as error:
        if not is_fault(error):
            raise
        raise PluginError(
            f"{who} failed to say what its value comes from: {describe(error)}; {REPORT}"
        ) from error
    if not all(isinstance(detail, Detail) for detail in found):
        raise PluginError(
            f"{who} must give its details as Detail, not {safe_repr(found, most=60)}; {REPORT}"
        )
    return found


def _where(term: BoundTerm, call: tuple[int, ...], labels: Sequence[str]) -> str:
    """A call in words, for messages."""
    named = ", ".join(labels[k] for k in call)
    return f"'{term.term.call}'" + (f" for {named}" if call else "")


def _in_range(value: float, term: BoundTerm, where: str) -> float:
    """The value; clipped to the declared range where what is beyond is rounding, or an error."""
    low, high = term.objective.traits.range
    if low <= value <= high and math.isfinite(value):
        return value
    if not math.isfinite(value):
        raise PluginError(
            f"objective '{term.id}' of {term.distribution} returned {value} in {where}; values"
            f" must be finite; {REPORT}"
        )
    slack = 1e-9 * max([1.0, *(abs(end) for end in (low, high) if math.isfinite(end))])
    if low - slack <= value <= high + slack:
        return min(max(value, low), high)
    raise PluginError(
        f"objective '{term.id}' of {term.distribution} returned {value} in {where}; it declares"
        f" values from {low:g} to {high:g}; {REPORT}"
    )
