"""What becomes of checks: passed, failed, skipped, expected, warned."""

from __future__ import annotations

import sys
import traceback

import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import MeasureSpec
from moseg_core.errors import PluginError, UsageError
from moseg_core.testing import CHECKS, Case, Check, ContractFailure, cases_of, check
from moseg_core.testing.check import Skip
from moseg_core.testing.fixtures.comparison import attempt, expect_no_error
from tests.testing.outcomes import subject

MEASURE = MeasureSpec(name="spread", target="tests.testing.broken.heavy:spread")


def case(run, **options):
    made = Check(id="made-up", kinds=("measure",), since=2, why="It is made up.", run=run)
    return Case(check=made, subject=subject(MEASURE), contract=2, **options)


def complain(_):
    raise ContractFailure(did="it was run", got="1", expected="2", fix="add 1")


def skip(_):
    raise Skip("not of this kind")


def crash(_):
    raise ZeroDivisionError("by nothing")


def leave(_):
    sys.exit(3)


@pytest.mark.parametrize(
    ("run", "status", "message", "fix"),
    [
        (lambda _: None, "passed", "", ""),
        (complain, "failed", "it was run: got 1, expected 2", "add 1"),
        (skip, "skipped", "not of this kind", ""),
        (
            crash,
            "failed",
            "it raised ZeroDivisionError: by nothing (tests/testing/test_run.py:35:"
            ' "raise ZeroDivisionError("by nothing")")',
            "",
        ),
        (
            leave,
            "failed",
            'it raised SystemExit: 3 (tests/testing/test_run.py:39: "sys.exit(3)")',
            "",
        ),
    ],
)
def test_outcomes(run, status, message, fix):
    found = case(run).outcome()
    assert (found.status, found.message, found.fix) == (status, message, fix)
    assert (found.component, found.check) == ("own:spread", "made-up")


def test_a_failure_says_why_it_matters():
    with pytest.raises(AssertionError, match=r"own:spread made-up: it was run(.|\n)*made up\."):
        case(complain)()


def answers(_):
    expect_no_error({"part 0": attempt(crash, 0)}, did="it was asked", fix="mend it")


@pytest.mark.parametrize("run", [crash, answers])
def test_a_failure_shows_the_line_of_the_author_and_is_raised_from_the_error(run):
    with pytest.raises(
        AssertionError, match=r"test_run\.py:\d+: .raise ZeroDivisionError"
    ) as caught:
        case(run)()
    cause = caught.value.__cause__
    assert isinstance(cause, ZeroDivisionError)
    assert traceback.extract_tb(cause.__traceback__)[-1].name == "crash"


def test_expected_failures_are_strict():
    assert case(complain, expected="known").outcome().status == "expected"
    surprise = case(lambda _: None, expected="known").outcome()
    assert surprise.status == "failed"
    assert "take it off the list" in surprise.message


def test_checks_newer_than_the_bundle_warn():
    made = Check(id="made-up", kinds=("measure",), since=3, why="It is made up.", run=complain)
    old = Case(check=made, subject=subject(MEASURE), contract=2)
    assert old.outcome().status == "warned"
    with pytest.warns(FutureWarning, match="add 1"):
        old()


def test_warnings_of_components_are_no_failures():
    import warnings

    assert case(lambda _: warnings.warn("odd", stacklevel=1)).outcome().status == "passed"


def test_an_id_is_given_once():
    cases_of("core")
    with pytest.raises(ValueError, match="'silent'"):
        check("silent", kinds=["measure"], why="Nothing.")(complain)


def test_behind_a_gate_that_is_shut_nothing_is_tried():
    spec = MeasureSpec(name="lost", target="tests.testing.broken.heavy:not_there")
    bundle = Bundle("mine", "mine", "1.0", "m", (Component("mine", "mine 1.0", spec),))
    found = {c.check.id: c.outcome() for c in cases_of("mine", source=Registry([bundle]))}
    assert found["target-resolves"].status == "failed"
    rest = [outcome for id, outcome in found.items() if id != "target-resolves"]
    assert {outcome.status for outcome in rest} == {"skipped"}
    assert all("'target-resolves'" in outcome.message for outcome in rest)


def test_checks_come_in_one_order_whatever_was_imported_first():
    import subprocess
    import sys

    found = []
    for first in ("general", "optimizers", "declarations"):
        code = (
            f"import moseg_core.testing.checks.{first}; from moseg_core.testing import load_checks;"
            "print([check.id for check in load_checks()])"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        found.append(done.stdout)
    assert found[0].startswith("['target-resolves'")
    assert found[0] == found[1] == found[2]


def test_unknown_bundles_and_checks_are_refused():
    with pytest.raises(UsageError, match="'basic'"):
        cases_of("basix")
    with pytest.raises(UsageError, match="did you mean 'silent'"):
        cases_of("basic", expected_failures={"silence": "it talks"})
    aside = Bundle("mine", "mine", "1.0", "m", problem="it is broken")
    with pytest.raises(PluginError, match="it is broken"):
        cases_of("mine", source=Registry([aside]))


def test_failures_can_be_expected_of_one_component():
    some = cases_of("basic", expected_failures={"narrow silent": "it talks"})
    assert [c.id for c in some if c.expected] == ["basic:narrow silent"]
    assert all(c.check is CHECKS[c.check.id] for c in some)
