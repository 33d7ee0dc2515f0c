"""What a check is made of."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import MeasureSpec
from moseg_core.testing import CHECKS, ContractFailure, check
from tests.testing.outcomes import subject

SPREAD = MeasureSpec(name="spread", target="tests.testing.broken.heavy:spread")


@pytest.fixture
def made_up(monkeypatch):
    monkeypatch.delitem(CHECKS, "made-up", raising=False)
    yield "made-up"
    CHECKS.pop("made-up", None)


def test_the_docstring_says_why(made_up):
    @check(made_up, kinds=["measure"])
    def complain(subject):
        """Nobody would notice,
        for a long time.
        """

    assert CHECKS[made_up].why == "nobody would notice, for a long time"
    assert CHECKS[made_up].run is complain
    assert CHECKS[made_up].kinds == ("measure",)


def test_a_reason_that_is_given_comes_before_the_docstring(made_up):
    @check(made_up, kinds=["measure"], why="it is made up")
    def complain(subject):
        """Another reason."""

    assert CHECKS[made_up].why == "it is made up"


def test_a_failure_says_all_four_things():
    failure = ContractFailure(did="it was run", got="1", expected="2", fix="add 1")
    assert str(failure) == "it was run: got 1, expected 2; add 1"
    assert isinstance(failure, AssertionError)


def test_values_are_kept_once():
    about = subject(SPREAD)
    assert about.keep("a", lambda: 1) == about.keep("a", lambda: 2) == 1


def test_a_subject_loads_its_target():
    assert subject(SPREAD).load().__name__ == "spread"
