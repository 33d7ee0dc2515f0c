"""How long components take: microseconds a call, beside the cost that they declare.

An objective declares a class of cost, and the search asks cheap ones first; one that declares too
little makes every search with it slower, and nobody sees why. No check fails on a clock: what is
measured here is a table to be looked at (``moseg plugin check --time``). Objectives, measures and
fields are asked on the shapes of the zoo and on the samples, whose parts are those of a search in
earnest, each time of a part or shape that knows nothing yet; what is computed once for a whole
shape, such as fields, is left out of the calls of objectives. The other kinds are run as the kit
drives them (:mod:`moseg_core.testing.fixtures.drivers`), on the zoo alone.

``python -m moseg_core.testing.timing BUNDLE`` prints the same as JSON.
"""

from __future__ import annotations

import json
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

from moseg_core.components.faults import FAULTS, describe
from moseg_core.components.requirements import lack
from moseg_core.io import load, read_labels
from moseg_core.samples import SAMPLES, sample_labels_path, sample_path
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import Skip, Subject
from moseg_core.testing.fixtures.drivers import DRIVERS, drive
from moseg_core.testing.fixtures.field_values import required_elsewhere
from moseg_core.testing.fixtures.objective_values import calls_on, segmented
from moseg_core.testing.fixtures.shapes import slicings, specimen
from moseg_core.testing.fixtures.trial import required
from moseg_core.testing.run import cases_of
from moseg_core.types import Int32Array

LIMITS = {"cheap": 1e3, "moderate": 1e4}
"""Microseconds a call on the samples up to which a cost is taken for cheap or moderate."""

_ZOO = ("tetrahedron", "disc", "cloud", "voxels", "lump", "sphere")
_GROUPS = ("zoo", "samples")


@dataclass(frozen=True, kw_only=True)
class Timing:
    """How long the calls of a component took.

    Parameters
    ----------
    component : str
        Its id.
    kind : str
    declared : str
        The cost that an objective declares; empty for others.
    zoo, samples : float or None
        Mean of a call, microseconds; None where it was not asked or refused.
    calls : int
        How many were timed.
    note : str
        Why nothing was, or what is odd.
    """

    component: str
    kind: str
    declared: str
    zoo: float | None
    samples: float | None
    calls: int
    note: str = ""


def time_bundle(bundle: Any, *, clock: Callable[[], float] = time.perf_counter) -> list[Timing]:
    """The times of all components of a bundle that the kit can run.

    Parameters
    ----------
    bundle : str, Spec or objective
        See :func:`moseg_core.testing.cases_of`.
    clock : callable
        The time in seconds.
    """
    subjects = {
        (case.subject.component.kind, case.subject.component.id): case.subject
        for case in cases_of(bundle)
    }
    return [
        _timed(subject, clock) for subject in subjects.values() if subject.component.kind in DRIVERS
    ]


def _timed(subject: Subject, clock: Callable[[], float]) -> Timing:
    """The times of one component; why there are none, where it raises."""
    kind = subject.component.kind
    seconds: dict[str, list[float]] = {group: [] for group in _GROUPS}
    note = ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the business of a check
        try:
            declared = getattr(getattr(subject.load(), "traits", None), "cost", "")
            for group, call in _calls(subject):
                began = clock()
                count = call()
                seconds[group] += [(clock() - began) / count] * count
        except Skip as reason:  # what it needs nobody can guess
            declared, note = "", str(reason)
        except FAULTS as error:
            declared, note = "", describe(error)
    mean = {g: 1e6 * sum(found) / len(found) if found else None for g, found in seconds.items()}
    return Timing(
        component=subject.component.id,
        kind=kind,
        declared=declared,
        zoo=mean["zoo"],
        samples=mean["samples"],
        calls=sum(map(len, seconds.values())),
        note=note or _doubt(declared, mean["samples"]),
    )


def _doubt(declared: str, microseconds: float | None) -> str:
    """That it takes longer than what declares such a cost does, where it does."""
    limit = LIMITS.get(declared)
    if limit is None or microseconds is None or microseconds <= limit:
        return ""
    more = "moderate" if microseconds <= LIMITS["moderate"] else "expensive"
    return f"rather {more}: above {limit:.0f} us"


def _calls(subject: Subject) -> Iterator[tuple[str, Callable[[], int]]]:
    """What is timed: where it is asked, and a function that asks and says how often."""
    kind = subject.component.kind
    if kind not in ("objective", "measure", "field"):
        yield "zoo", lambda: len(drive(subject))
        return
    target, parameters = subject.load(), required(subject)

    def once(given: Any) -> Callable[[], int]:
        def call() -> int:
            target(given, **parameters)
            return 1

        return call

    if kind == "field":
        target(specimen("lump"), **parameters)  # compiles what is compiled
    lacking = required_elsewhere(subject)
    for group, shape, labellings in _shapes():
        if any(lack(shape, requirement) for requirement in lacking):
            continue
        if kind == "field":
            yield group, once(shape)
            continue
        for labels in labellings:
            # What is known of the shape afterwards, such as fields, is computed once in a search.
            for given in calls_on(target, segmented(subject, shape, labels)).values():
                target(given, **parameters)
            for given in calls_on(target, segmented(subject, shape, labels)).values():
                yield group, once(given)


def _shapes() -> Iterator[tuple[str, Shape, list[Int32Array]]]:
    """The zoo in slices, and the samples in the parts that people see."""
    for name in _ZOO:
        shape = specimen(name)
        yield "zoo", shape, [slicings(shape)["halves"]]
    for name in SAMPLES:
        shape = load(sample_path(name))
        labels = read_labels(sample_labels_path(name), shape).labels
        yield "samples", shape, [labels.astype("int32")]


def main() -> None:
    """Print the times of a bundle as JSON."""
    print(json.dumps([asdict(timing) for timing in time_bundle(sys.argv[1])]))


if __name__ == "__main__":
    main()
