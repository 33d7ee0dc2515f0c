"""What objectives promise: a number in their range, from their own parts, every time the same.

The search builds on each of these. It leaves out expensive terms by the least value that their
range admits, remembers values by which elements the parts have, and refuses shapes by what
objectives say they require. What an objective may moreover promise to leave alone is checked in
:mod:`moseg_core.testing.checks.invariances`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.detail import Detail
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.faults import FAULTS, describe
from moseg_core.components.memo import Memo
from moseg_core.components.part import Part
from moseg_core.components.protocols import Batch, Objective
from moseg_core.components.real_number import described, real_number
from moseg_core.errors import MosegError, UsageError
from moseg_core.language.terms import format_call
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.checks.declarations import within
from moseg_core.testing.fixtures.comparison import (
    Answers,
    Raised,
    attempt,
    expect_no_error,
    expect_same,
)
from moseg_core.testing.fixtures.field_values import compute_declared, computed_fields, fields_of
from moseg_core.testing.fixtures.objective_values import (
    SLICED,
    calls_on,
    most_of,
    segmented,
    value_of,
    values_on,
)
from moseg_core.testing.fixtures.problems import evaluator_on, vectors
from moseg_core.testing.fixtures.recording import watched
from moseg_core.testing.fixtures.shapes import ZOO, lump, mapped, slicings, specimen
from moseg_core.testing.fixtures.trial import Trial, declared, labels_of, required
from moseg_core.types import FloatArray


def _zoo_values(subject: Subject) -> Answers:
    """Values for everything in the zoo that the core may ask about."""

    def compute() -> Answers:
        found: Answers = {}
        for name in ZOO:
            # No search comes by scattered parts of the sample, and they take long.
            titles = SLICED if name == "sample" else (*SLICED, "scattered")
            values = values_on(Trial(subject=subject), specimen(name), among=titles)
            found |= {f"{name}, {title}": value for title, value in values.items()}
        return found

    values: Answers = subject.keep("zoo", compute)
    return values


@check("objective-returns", kinds=["objective"])
def _returns(subject: Subject) -> None:
    """An error ends the search, however good the rest of the expression is."""
    expect_no_error(
        _zoo_values(subject),
        did="it was asked about parts of the zoo",
        fix="handle the case; where it cannot be handled, say in requires=(...) what a shape must"
        " have",
    )


@check("objective-in-range", kinds=["objective"])
def _in_range(subject: Subject) -> None:
    """The search leaves out expensive terms by the least value that the range admits."""
    low, high = subject.load().traits.range
    ends = [abs(end) for end in (low, high) if math.isfinite(end)]
    slack = 1e-9 * max([1.0, *ends])  # what the core takes for rounding
    for title, value in _zoo_values(subject).items():
        if isinstance(value, Raised):
            continue
        number = real_number(value)
        if number is None:
            raise ContractFailure(
                did=f"it was asked about {title}",
                got=described(value),
                expected="a real number: an int or a float, Python's or numpy's",
                fix="return float(...); count what is true as 1.0",
            )
        if not (math.isfinite(number) and low - slack <= number <= high + slack):
            raise ContractFailure(
                did=f"it was asked about {title}",
                got=repr(value),
                expected=f"a finite number from {low:g} to {high:g}, as it declares",
                fix="handle parts that are flat, thin or a single face; or declare the range that"
                " the values have",
            )


@check("objective-sees-its-parts", kinds=["objective"])
def _sees_its_parts(subject: Subject) -> None:
    """Values are remembered by the elements of the parts, and wrong where more was looked at."""
    traits = subject.load().traits
    if traits.arity == "global":
        raise Skip("it sees the whole segmentation")
    if traits.least > 2:
        raise Skip(f"it takes {traits.least} parts")
    shape = lump()
    # Two parts of which objectives may be asked, in a corner of the lump, whatever the rest.
    thirds = slicings(shape)["thirds"]
    rest = np.flatnonzero(thirds == 2)
    scrambled = thirds.copy()
    scrambled[rest] = 2 + np.arange(len(rest)) % 4
    elsewhere = (scrambled + 1) % 6  # the parts have other numbers, the rest other labels
    values = []
    for labels, first in ((thirds, 0), (elsewhere, 1)):
        parts = segmented(subject, shape, labels).parts
        unary = traits.arity == "unary"
        chosen = parts[first] if unary else parts[first : first + traits.least]
        values.append({"value": value_of(subject, chosen)})
    expect_same(
        *values,
        did="the lump's other elements got other labels, and the part another number",
        fix="use nothing but the part's own elements and part.shape; what is about the whole"
        " segmentation takes a Segmentation",
    )


@check("objective-requires-what-it-reads", kinds=["objective"])
def _requires_what_it_reads(subject: Subject) -> None:
    """A shape that lacks something is refused before the search only if that was declared."""
    requires = subject.load().traits.requires
    reads = _reads(subject, "lump")
    missing = sorted((reads & {"volume", "adjacency"}) - requires)
    if "surface" not in requires and reads & {"triangles", "to_mesh"}:
        # A cloud has no triangles; who looks at its points instead can do without.
        found = _reads(subject, "cloud")
        instead = found & {"points", "areas", "vertices"}
        if "to_mesh" in found or ("triangles" in found and not instead):
            missing.append("surface")
    if missing:
        names = ", ".join(f'"{name}"' for name in sorted({*requires, *missing}))
        raise ContractFailure(
            did="it was asked about parts that note what is read of them",
            got=f"readings of the {' and the '.join(missing)}",
            expected=f"only what it requires: {', '.join(sorted(requires)) or 'nothing'}",
            fix=f"declare requires=({names},), or do without",
        )


def _reads(subject: Subject, name: str) -> set[str]:
    """What the objective reads of the parts of a specimen, whatever it requires."""
    target: Objective = subject.load()
    found: set[str] = set()
    shape = specimen(name)
    compute_declared(subject, shape)  # what a field reads is the field's business
    for labels in slicings(shape).values():
        seen, reads = watched(segmented(subject, shape, labels))
        asked: tuple[object, ...] = (seen,)
        if target.traits.arity == "unary":
            asked = seen.parts
        elif target.traits.arity != "global":
            enough = len(seen.parts) >= target.traits.least
            asked = (seen.parts[: most_of(target, len(seen.parts))],) if enough else ()
        for given in asked:
            value_of(subject, given)
        found |= reads
    return found


@check("objective-fields-exist", kinds=["objective"])
def _fields_exist(subject: Subject) -> None:
    """A declared field is computed before the search, which ends there where nobody has it."""
    traits, given = subject.load().traits, required(subject)
    names = attempt(traits.fields, given) if callable(traits.fields) else traits.fields
    sound = isinstance(names, (tuple, list)) and all(isinstance(name, str) for name in names)
    lookup = Lookup(subject.registry)
    for name in names if sound else ():
        found = attempt(lookup.field, name)
        if isinstance(found, Raised):
            raise ContractFailure(
                did=f"the field '{name}', which it declares, was looked for",
                got=str(found),
                expected="a field that is installed with the bundle",
                fix="write bundle:name of the field, and let the package depend on the one that"
                " brings it",
            )
    if not sound:
        raise ContractFailure(
            did=f"it was asked for its fields with the parameters {given}",
            got=f"{names!r:.80}" if not isinstance(names, Raised) else str(names),
            expected="the ids of fields in a tuple",
            fix="declare fields=('bundle:name',), or a function from the parameters that a call"
            " gives, which may be none, to such a tuple",
        )


@check("objective-declares-its-fields", kinds=["objective"])
def _declares_its_fields(subject: Subject) -> None:
    """A field that is not declared is computed in the search, by every process for itself."""
    for name in ("lump", "neighbored_cloud"):
        shape = specimen(name)
        compute_declared(subject, shape)
        declared = set(fields_of(subject)) | computed_fields(shape)
        for labels in slicings(shape).values():
            for given in calls_on(subject.load(), segmented(subject, shape, labels)).values():
                value_of(subject, given)
        if more := sorted(computed_fields(shape) - declared):
            names = "".join(f'"{name}", ' for name in sorted({*fields_of(subject), *more}))
            raise ContractFailure(
                did=f"it was asked about parts of the {shape.name}, and the fields of the shape"
                " were looked at",
                got=f"{more[0]}, computed meanwhile",
                expected=f"only what it declares: {', '.join(fields_of(subject)) or 'nothing'}",
                fix=f"declare fields=({names.rstrip()})",
            )


@check("objective-keeps-shapes-apart", kinds=["objective"])
def _keeps_shapes_apart(subject: Subject) -> None:
    """A cache of one's own that confuses two shapes gives the second the values of the first."""
    second = mapped(lump(), np.diag([1.7, 0.8, 1.2]), name="lump")
    unseen = replace(second, name="a shape never seen before")
    _, after, fresh = (
        values_on(Trial(subject=subject), shape, among=SLICED) for shape in (lump(), second, unseen)
    )
    expect_same(
        fresh,
        after,
        did="it was asked about a shape, under a new name and under that of another shape",
        fix="keep no values of your own; what is worth keeping is a measure, which the core"
        " remembers: part.measure('bundle:name')",
    )


@check("objective-expects-a-share", kinds=["objective"])
def _expects_a_share(subject: Subject) -> None:
    """Searches place their seeds by the share of the area that a part is expected to have."""
    traits = subject.load().traits
    if traits.share is None:
        raise Skip("it says nothing of shares")
    for given in allowed_parameters(subject):
        try:
            traits.expected_share(given)
        except UsageError:
            continue  # its parameters do not go together, and it says so
        except FAULTS as error:
            said = format_call("", parameters=given.items()) or "no parameters"
            raise ContractFailure(
                did=f"the share that it expects was asked for, given {said}",
                got=describe(error),
                expected="a number above 0 and at most 1, or None",
                fix="return None where the parameters, those that a call gives and no defaults, do"
                " not tell",
            ) from error


@check("objective-is-the-mean-it-says", kinds=["objective"])
def _is_the_mean_it_says(subject: Subject) -> None:
    """Refiners move boundaries by the field of which a value is said to be the mean."""
    target: Objective = subject.load()
    if target.traits.mean_of is None:
        raise Skip("it does not say that it is the mean of a field")
    parts = calls_on(target, segmented(subject, lump(), slicings(lump())[SLICED[0]]))
    for given in allowed_parameters(subject):
        try:
            averaged = target.traits.averaged_field(given)
        except UsageError:
            continue  # its parameters do not go together, and it says so
        except FAULTS as error:
            said = format_call("", parameters=given.items()) or "no parameters"
            raise ContractFailure(
                did=f"it was asked which field it is the mean of, given {said}",
                got=describe(error),
                expected="a field's id and a mapping of its parameters, or None",
                fix="return None where the value is no mean for these parameters, those that a call"
                " gives and no defaults",
            ) from error
        if averaged is None:
            continue
        values: Answers = {title: attempt(target, part, **given) for title, part in parts.items()}
        values = {title: value for title, value in values.items() if not isinstance(value, Raised)}
        means = {title: attempt(_mean, parts[title], *averaged) for title in values}
        call = format_call(averaged[0], parameters=averaged[1].items())
        expect_same(
            *(means, values),
            did=f"parts of the lump were compared by the mean of {call} and by its value, which it"
            " says is the same",
            fix="let mean_of name that field whose mean over the part, weighted by area, is the"
            " value; or leave it out",
        )


def _mean(part: Part, name: str, parameters: Mapping[str, Any]) -> float:
    return part.field(name, **parameters).mean


@check("objective-tells-details", kinds=["objective"])
def _tells_details(subject: Subject) -> None:
    """What a value comes from is told of every result, so a failure there would cost the result."""
    target: Objective = subject.load()
    details = target.traits.details
    if details is None:
        raise Skip("it does not tell what its value comes from")

    def told_by(parts: Any, **given: Any) -> Any:
        return tuple(details(parts, **given))

    segmentation = segmented(subject, lump(), slicings(lump())[SLICED[0]])
    for given in (call for call in allowed_parameters(subject) if call):
        for title, parts in calls_on(target, segmentation).items():
            if isinstance(attempt(target, parts, **given), Raised):
                continue  # nobody asks for details where there is no value
            told = attempt(told_by, parts, **given)
            if isinstance(told, Raised) or not all(isinstance(each, Detail) for each in told):
                said = format_call("", parameters=given.items())
                raise ContractFailure(
                    did=f"it was asked what its value for {title} comes from, given {said}",
                    got=repr(told),
                    expected="a sequence of moseg_core.Detail",
                    fix="call it as the objective is called, with parameters as the user gives them"
                    " and defaults for the rest",
                )


def allowed_parameters(subject: Subject) -> list[dict[str, Any]]:
    """What a call may give: what it must, each other parameter alone, all of them together."""
    fixed = required(subject)
    values = {parameter.name: within(parameter) for parameter in declared(subject)}
    alone = [{name: value} for name, tried in values.items() for value in tried]
    together: list[dict[str, Any]] = [
        {name: tried[end] for name, tried in values.items() if tried} for end in (0, -1)
    ]
    return [fixed, *({**fixed, **given} for given in (*alone, *together))]


# -- Evaluated as the core does ---------------------------------------------------------------


def _evaluator(subject: Subject, *, memo: Memo | None = None) -> ProblemEvaluator:
    """A problem of three labels whose only term is the objective, on the lump.

    Raises
    ------
    Skip
        The objective takes more parts, or the core refuses it; other checks say how.
    """
    target: Objective = subject.load()
    if target.traits.least > 3:
        raise Skip(f"it takes {target.traits.least} parts")
    count = {"unary": 3, "global": 0}.get(target.traits.arity, most_of(target, 3))
    try:
        return evaluator_on(
            lump(),
            3,
            format_call("tested", labels_of(count), required(subject).items()),
            objectives={"tested": target},
            source=subject.registry,
            memo=Memo() if memo is None else memo,
        )
    except MosegError as error:
        raise Skip(f"it cannot be evaluated: {error}") from error


def _one_by_one(evaluator: ProblemEvaluator, candidates: FloatArray) -> list[Cost]:
    """Costs of vectors, evaluated one after the other.

    Raises
    ------
    Skip
        The objective fails on one of them; other checks say how.
    """
    try:
        return [evaluator.evaluate(vector).cost for vector in candidates]
    except MosegError as error:
        raise Skip(f"it cannot be evaluated: {error}") from error


@check("objective-memo-equals-fresh", kinds=["objective"])
def _memo_equals_fresh(subject: Subject) -> None:
    """A value that was remembered must be the one that would be computed."""
    with_memo, without = _evaluator(subject), _evaluator(subject, memo=Memo(size=0))
    candidates = np.tile(vectors(with_memo, 3), (2, 1))
    fresh, remembered = _one_by_one(without, candidates), _one_by_one(with_memo, candidates)
    _expect_same_costs(fresh, remembered, "twice, with values remembered and without")


@check("objective-batch-equals-loop", kinds=["objective"])
def _batch_equals_loop(subject: Subject) -> None:
    """Optimizers ask for many candidates at a time, and must get what they get one by one."""
    evaluator = _evaluator(subject)
    candidates = vectors(evaluator, 8)
    alone = [_one_by_one(_evaluator(subject), vector[None])[0] for vector in candidates]
    together = evaluator.costs(Batch(vectors=np.concatenate([candidates, candidates[:3]])))
    _expect_same_costs([*alone, *alone[:3]], together, "one by one, and as a batch")
    hurried = evaluator.costs(Batch(vectors=candidates, best_only=True))
    _expect_same_costs(
        [min(alone)], [min(hurried)], "one by one, and as a batch of which the best counts"
    )


def _expect_same_costs(first: list[Cost], second: list[Cost], how: str) -> None:
    expect_same(
        *({f"candidate {k}": tuple(cost) for k, cost in enumerate(run)} for run in (first, second)),
        did=f"segmentations of the lump were evaluated {how}",
        fix="let the value depend on the parts and the parameters alone: count no calls, keep"
        " nothing from one to the next",
    )
