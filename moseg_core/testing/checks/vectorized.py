"""What an objective's vectorised form promises: for each call what the objective itself would say.

A search asks the vectorised form alone, about the parts of a whole batch of candidates; the authors
of objectives try and document the plain one. So both must agree, on all that the core may ask of
the zoo, which has a shape of super-elements. And since batches are put together as it suits the
search, a value must not depend, to the last bit, on which other calls it is computed with.

A lower bound that is asked in the same way may be anything that values are not below.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.labellings import Labellings
from moseg_core.components.objectives import Traits
from moseg_core.components.part_array import PartArray
from moseg_core.components.protocols import Objective
from moseg_core.components.requirements import lack
from moseg_core.language.terms import format_call
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.checks.objectives import allowed_parameters
from moseg_core.testing.fixtures.comparison import Raised, attempt, difference, expect_same
from moseg_core.testing.fixtures.field_values import required_elsewhere
from moseg_core.testing.fixtures.objective_values import SLICED, calls_on, segmented
from moseg_core.testing.fixtures.shapes import ZOO, slicings, specimen
from moseg_core.testing.fixtures.trial import required
from moseg_core.types import Int32Array

Call = tuple[int, tuple[int, ...]]
"""A labelling of several, and the numbers of the parts."""


@check("objective-vectorized-equals-single", kinds=["objective"])
def _vectorized_equals_single(subject: Subject) -> None:
    """A search goes by the vectorised form, and by whichever calls come together in a batch."""
    if subject.load().traits.vectorized is None:
        raise Skip("it has no vectorised form")
    _on_all_shapes(subject, _compare)


@check("objective-not-below-its-bound", kinds=["objective"])
def _not_below_its_bound(subject: Subject) -> None:
    """A search drops a candidate whose lower bound is too high, and never asks for its value."""
    if subject.load().traits.at_least is None:
        raise Skip("it has no lower bound")
    _on_all_shapes(subject, _compare_bounds)


def _on_all_shapes(
    subject: Subject,
    compare: Callable[[Subject, Shape, list[Int32Array], Mapping[str, Any]], None],
) -> None:
    """Compare forms on the zoo, with labellings of as many parts each."""
    needed = required_elsewhere(subject)
    for name in ZOO:
        shape = specimen(name)
        if any(lack(shape, requirement) for requirement in needed):
            continue
        # All that a call may give is tried on one shape of elements and one of super-elements.
        asked = allowed_parameters(subject) if name in ("lump", "sample") else [required(subject)]
        for rows in _by_number_of_parts(shape):
            for given in asked:
                compare(subject, shape, rows, given)


def _by_number_of_parts(shape: Shape) -> list[list[Int32Array]]:
    """Labellings with as many parts each, all slices twice: the second time numbered otherwise."""
    found: defaultdict[int, list[Int32Array]] = defaultdict(list)
    for title, labels in slicings(shape).items():
        count = int(labels.max()) + 1
        if title in SLICED or shape.fine is None:  # no search comes by scattered super-elements
            found[count] += [labels, ((labels + 1) % count).astype(np.int32)]
    return list(found.values())


def _compare(
    subject: Subject, shape: Shape, rows: list[Int32Array], given: Mapping[str, Any]
) -> None:
    """Complain where the vectorised form, asked about all calls or some, says something else."""
    form = subject.load().traits.vectorized
    said = format_call("", parameters=given.items()) or "no parameters"
    for values in _singles(subject, shape, rows, given):
        calls = list(values)
        together = _asked(subject, form, shape, rows, calls, given)
        titles = [_title(shape, *call) for call in calls]
        expect_same(
            dict(zip(titles, values.values(), strict=True)),
            dict(zip(titles, together, strict=True)),
            did=f"it and its vectorised form were asked about the same parts, given {said}",
            fix="compute the same by arrays; the first axis counts calls, the second the parts of"
            " each, and parameters that are not given have the same defaults",
        )
        alone = [_asked(subject, form, shape, rows, [call], given)[0] for call in calls]
        turned = _asked(subject, form, shape, rows, calls[::-2], given)
        expected = dict(zip(titles, together, strict=True))
        for answers, how in (
            (dict(zip(titles, alone, strict=True)), "one call at a time"),
            (
                expected | dict(zip(titles[::-2], turned, strict=True)),
                "every other call, backwards",
            ),
        ):
            if found := difference(expected, answers):
                raise ContractFailure(
                    did=f"its vectorised form was asked about all calls, and about {how}",
                    got=found,
                    expected="the same, to the last bit",
                    fix="let a value depend on its own call alone: no mean, maximum or cumulated"
                    " sum along the first axis",
                )


def _compare_bounds(
    subject: Subject, shape: Shape, rows: list[Int32Array], given: Mapping[str, Any]
) -> None:
    """Complain where a value is below the lower bound."""
    form = subject.load().traits.at_least
    for values in _singles(subject, shape, rows, given):
        calls = list(values)
        bounds = _asked(subject, form, shape, rows, calls, given)
        for call, bound in zip(calls, bounds, strict=True):
            if not bound <= values[call]:
                raise ContractFailure(
                    did=f"its lower bound was asked about {_title(shape, *call)}",
                    got=f"{bound!r}",
                    expected=f"at most its value, {values[call]!r}",
                    fix="return something that is less than the value whatever rounding does",
                )


def _singles(
    subject: Subject, shape: Shape, rows: list[Int32Array], given: Mapping[str, Any]
) -> list[dict[Call, Any]]:
    """The values of all calls, for each number of parts that a call has."""
    target: Objective = subject.load()
    singles: dict[int, dict[Call, Any]] = defaultdict(dict)  # by how many parts a call has
    for b, labels in enumerate(rows):
        segmentation = segmented(subject, shape, labels)
        for parts in calls_on(target, segmentation).values():
            several = parts if isinstance(parts, tuple) else segmentation.parts
            members = [parts] if target.traits.arity == "unary" else several
            numbers = tuple(segmentation.parts.index(part) for part in members)
            value = attempt(target, parts, **given)
            if not isinstance(value, Raised):  # other checks say so
                singles[len(numbers)][b, numbers] = value
    return list(singles.values())


def _asked(
    subject: Subject,
    form: Callable[..., Any],
    shape: Shape,
    rows: list[Int32Array],
    calls: Sequence[Call],
    given: Mapping[str, Any],
) -> list[Any]:
    """What a vectorised form says of certain calls, of labellings that were not looked at yet.

    Raises
    ------
    ContractFailure
        It raised, or returned something else than an array of as many numbers.
    """
    traits = subject.load().traits
    count = int(rows[0].max()) + 1
    members = np.array([numbers for _, numbers in calls])
    array = PartArray(
        _labellings=Labellings.of(shape, np.stack(rows), count, Lookup(subject.registry)),
        _rows=np.array([b for b, _ in calls]),
        _parts=members[:, 0] if traits.arity == "unary" else members,
    )
    returned = attempt(form, array, **given)
    if isinstance(returned, Raised) or np.shape(returned) != (len(calls),):
        raise ContractFailure(
            did=f"its {_name(traits, form)} was asked about {len(calls)} calls on the {shape.name}",
            got=str(returned) if isinstance(returned, Raised) else f"{returned!r:.80}",
            expected=f"an array of {len(calls)} values, one for each",
            fix="return a value for each call, and write to no array of the parts",
        )
    return list(returned)


def _name(traits: Traits, form: object) -> str:
    return "vectorised form" if form is traits.vectorized else "lower bound"


def _title(shape: Shape, row: int, numbers: tuple[int, ...]) -> str:
    return f"{shape.name}, labelling {row}, parts {', '.join(map(str, numbers))}"
