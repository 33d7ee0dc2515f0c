"""Parameters that must be given: the component brings an example, or a number is guessed."""

from __future__ import annotations

from typing import Annotated, ClassVar

import pytest

from moseg_core.components.discovery.specs import SeederSpec
from moseg_core.components.parameters import Interval
from moseg_core.components.protocols import Seeding
from moseg_core.testing.check import Skip
from moseg_core.testing.fixtures.problems import evaluator_on
from moseg_core.testing.fixtures.shapes import lump
from moseg_core.testing.fixtures.trial import values_for
from tests.testing.outcomes import outcomes, subject

HERE = "tests.testing.test_examples"


class Listed:
    """Centres at elements that are listed by number."""

    def __init__(self, *, places: str):
        self.places = [int(place) for place in places.split()]

    def __call__(self, evaluator, *, rng, report):
        return Seeding(centers=evaluator.shape.points[self.places])


class ListedByExample(Listed):
    """The same, with an example."""

    @staticmethod
    def example(evaluator):
        return {"places": " ".join(str(k) for k in range(len(evaluator.problem.labels)))}


class From:
    """Centres at elements from a number on."""

    def __init__(self, *, first: int):
        self.first = first

    def __call__(self, evaluator, *, rng, report):
        n = len(evaluator.problem.labels)
        return Seeding(centers=evaluator.shape.points[self.first - 1 : self.first - 1 + n])


def spec(name):
    return SeederSpec(name="own", target=f"{HERE}:{name}")


def test_a_text_that_nobody_can_guess_is_complained_of_once():
    found = outcomes(spec("Listed"))
    failed = [outcome for outcome in found if outcome.status == "failed"]
    assert [outcome.check for outcome in failed] == ["default-construction"]
    assert "'places'" in failed[0].message
    assert "example()" in failed[0].fix
    assert "seeder-count" in {o.check for o in found if o.status == "skipped"}
    with pytest.raises(Skip, match="places"):
        values_for(subject(spec("Listed")), evaluator_on(lump(), 2))


@pytest.mark.parametrize("name", ["ListedByExample", "From"])
def test_with_an_example_or_a_number_everything_is_checked(name):
    found = outcomes(spec(name))
    assert [outcome for outcome in found if outcome.status == "failed"] == []
    assert "seeder-count" in {o.check for o in found if o.status == "passed"}


class Patient(From):
    """Centres at the first elements, after a number of rounds that change nothing."""

    rounds: ClassVar[list[int]] = []

    def __init__(self, *, rounds: Annotated[int, Interval(0)] = 500):
        super().__init__(first=1)
        self.rounds.append(rounds)

    @staticmethod
    def example(evaluator):
        return {"rounds": 3}


def test_an_example_lowers_what_takes_long_except_where_defaults_are_looked_at():
    one = subject(spec("Patient"))
    tried = one.load().rounds  # the tests' own module is not the one that the spec names
    tried.clear()
    found = outcomes(spec("Patient"))
    assert [outcome for outcome in found if outcome.status == "failed"] == []
    assert set(tried) == {0, 3, 500}
    assert tried.count(500) == 12  # two runs on six problems
    assert values_for(one, None) == {"rounds": 3}
    assert values_for(one, None, in_full=True) == {}


def test_the_example_sees_what_the_component_will_meet():
    assert values_for(subject(spec("ListedByExample")), evaluator_on(lump(), 3)) == {
        "places": "0 1 2"
    }
    assert values_for(subject(spec("From")), evaluator_on(lump(), 3)) == {"first": 1}
