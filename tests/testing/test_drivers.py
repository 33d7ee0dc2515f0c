from __future__ import annotations

import numpy as np
import pytest

from moseg_core.parameters import Interval, Parameter
from moseg_core.plugins import Component, registry
from moseg_core.specs import MeasureSpec
from moseg_core.testing.check import Skip, Subject
from moseg_core.testing.child import ChildError, drive_elsewhere
from moseg_core.testing.drivers import (
    LABELS,
    TOYS,
    calls_on,
    drive,
    evaluator_on,
    labellings,
    segmented,
)
from moseg_core.testing.trials import (
    DRIVEN,
    Foreign,
    Raised,
    Trial,
    difference,
    required_values,
    same,
)
from moseg_core.testing.zoo import specimen


def of(kind, name):
    return Subject(component=registry().find(kind, name), registry=registry())


def measure(target):
    spec = MeasureSpec(name="mine", target=target)
    return Subject(component=Component("mine", "mine 1.0", spec), registry=registry())


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (1.0, 1.5),
        ([1, 2], [1, 2, 3]),
        (np.zeros(3), np.ones(3)),
        ("a", "b"),
        (Raised("a"), Raised("b")),
        (Raised("a"), 1.0),
        ({"a": 1}, {"a": 2}),
        (np.nan, 1.0),
        (None, "a"),
    ],
)
def test_what_differs(first, second):
    assert same(first, first)
    assert same(second, second)
    assert not same(first, second)
    assert difference({"x": first}, {"x": second}).startswith("x: ")


def test_what_is_the_same():
    assert same(1, 1.0)
    assert same(np.nan, np.nan)
    assert same((1.0, [2.0]), [1.0, (2.0,)])
    assert same(1e6, 1e6 * (1 + 1e-12), tolerance=1e-9)
    assert same(object(), Foreign("object"))
    assert difference({"x": 1}, {}) == "x: only one of them has it"


def test_values_for_what_must_be_given():
    def value(**fields):
        return required_values([Parameter(name="p", required=True, **fields)])["p"]

    assert value(type=float) == 1.0
    assert value(type=float, interval=Interval(2.5, 9)) == 2.5
    assert value(type=int, interval=Interval(2.5, 9)) == 3
    assert value(type=bool) is True
    assert required_values([Parameter(name="p", type=float)]) == {}
    with pytest.raises(Skip, match="'p'"):
        value(type=str)


def test_objectives_are_asked_what_the_core_would_ask():
    cloud, lump = specimen("cloud"), specimen("lump")
    thirds = {
        shape.name: segmented(of("objective", "narrow"), shape, labellings(shape)[2])
        for shape in (cloud, lump)
    }
    asked = {
        name: {
            on: list(calls_on(registry().find("objective", name).load(), s))
            for on, s in thirds.items()
        }
        for name in ("narrow", "perpendicular", "similar", "convex_parts")
    }
    assert asked["narrow"]["cloud"] == ["part 0", "part 1", "part 2"]
    assert asked["perpendicular"]["lump"] == ["parts 0, 1", "parts 1, 2"]
    assert asked["similar"]["lump"] == ["parts 0, 1", "parts 1, 2", "parts 0, 1, 2"]
    assert asked["convex_parts"] == {"cloud": [], "lump": ["all parts"]}


def test_parts_without_extent_are_not_asked_about():
    flat = specimen("zero_area_face")
    halves = next(f for f in labellings(flat) if f.n_parts == 3)
    whole = segmented(of("objective", "narrow"), flat, halves)
    assert len(calls_on(registry().find("objective", "narrow").load(), whole)) == 2


def test_what_was_handed_over_is_remembered():
    trial = Trial(subject=of("objective", "narrow"), read_only=False)
    array = trial.give("numbers", [1.0, 2.0])
    shape = trial.shape("cube")
    assert trial.changed() == []
    array[0] = 5.0
    shape.points.flags.writeable = True
    shape.points[0] = 5.0
    assert trial.changed() == ["numbers", "points of the shape 'cube'"]
    fixed = Trial(subject=trial.subject, read_only=True).give("numbers", [1.0])
    with pytest.raises(ValueError, match="read-only"):
        fixed[0] = 2.0


def test_errors_are_results():
    found = drive(measure("tests.testing.broken.repeats:first_triangle"))
    raised = {title for title, value in found.items() if isinstance(value, Raised)}
    assert raised
    assert all(title.startswith("cloud") for title in raised)
    assert not any(value.excused for value in found.values() if isinstance(value, Raised))


def test_every_kind_is_driven_or_says_that_it_is_not():
    with pytest.raises(Skip, match="a reader"):
        drive(of("reader", "off"))
    assert set(DRIVEN) < {c.kind for c in registry().components()}


def test_the_problem_has_as_many_labels_as_asked():
    for n in (1, 2, 3):
        evaluator = evaluator_on(of("labeler", "hungarian"), specimen("lump"), n=n)
        assert evaluator.problem.labels == LABELS[:n]
        assert evaluator.parameterization.n_parts == n


def test_toys_are_least_at_nothing():
    at = {"bowl": [0.1, 0.2, -0.3], "valley": [1.0, 1.0], "stairs": [0.0, 0.0, 0.0]}
    for toy in TOYS:
        assert toy.value(np.array(at[toy.name])) == pytest.approx(0.0, abs=1e-12)
        assert toy.value(toy.start) > 0.1
        assert (toy.lower <= toy.start).all()
        assert (toy.start <= toy.upper).all()


def test_another_process_gives_the_same():
    subject = of("objective", "narrow")
    assert difference(drive(subject), drive_elsewhere(subject, hash_seed=1), tolerance=1e-9) == ""


def test_another_process_has_other_hashes():
    subject = measure("tests.testing.broken.repeats:by_hash")
    first, second = (drive_elsewhere(subject, hash_seed=seed) for seed in (1, 2))
    assert difference(first, second)


def test_a_child_that_dies_is_named_and_started_anew():
    with pytest.raises(ChildError, match="ended"):
        drive_elsewhere(measure("tests.testing.odd:end"), hash_seed=1)
    with pytest.raises(ChildError, match="not_there"):
        drive_elsewhere(measure("tests.testing.broken.heavy:not_there"), hash_seed=1)
