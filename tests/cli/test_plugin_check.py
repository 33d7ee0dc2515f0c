"""``moseg plugin check``."""

from __future__ import annotations

import json

import pytest

from moseg_core.cli import plugin_check
from moseg_core.testing import CHECKS, Check, Outcome
from moseg_core.testing.processes.watching_parent import BundleReport


@pytest.fixture
def outcomes(monkeypatch):
    """A report of five outcomes, under checks that are there for the test only."""
    for name in ("test-a", "test-b"):
        made = Check(id=name, kinds=("seeder",), since=1, why=f"Why {name}.", run=lambda _: None)
        monkeypatch.setitem(CHECKS, name, made)
    found = [
        Outcome(component="acme:one", check="test-a", status="passed"),
        Outcome(component="acme:one", check="test-b", status="failed", message="bad", fix="mend"),
        Outcome(component="acme:two", check="test-a", status="skipped", message="no volume"),
        Outcome(component="acme:two", check="test-b", status="passed"),
    ]

    def use(count: int) -> None:
        outcomes = tuple(found[:count])
        report = BundleReport(bundle="acme", distribution="moseg-acme 1.4", outcomes=outcomes)
        monkeypatch.setattr(plugin_check, "watch_checks", lambda bundle, **_: report)

    return use


def test_check_shows_failures_first_and_ends_with_1(moseg, outcomes):
    outcomes(4)
    run = moseg("plugin", "check", "acme")
    assert run.code == 1
    assert run.err == (
        "moseg: bundle 'acme' of moseg-acme 1.4 does not pass the contract checks: 1 check failed\n"
    )
    text = " ".join(run.out.split())
    assert text == (
        "failed check test-b on acme:one what bad why Why test-b. fix mend"
        " skipped acme:two test-a no volume"
        " passed acme:one 1 check acme:two 1 check"
        " acme (moseg-acme 1.4): 4 checks on 2 components: 2 passed, 1 failed, 1 skipped"
    )


def test_check_as_json(moseg, outcomes):
    outcomes(4)
    run = moseg("plugin", "check", "acme", "--json")
    assert run.code == 1
    told = json.loads(run.out)
    assert not told["passed"]
    assert told["counts"] == {"passed": 2, "failed": 1, "skipped": 1}
    assert told["outcomes"][1] == {
        "component": "acme:one",
        "check": "test-b",
        "status": "failed",
        "message": "bad",
        "why": "Why test-b.",
        "fix": "mend",
    }


def test_check_ends_with_0_where_all_is_well(moseg, outcomes):
    outcomes(1)
    run = moseg("plugin", "check", "acme")
    assert (run.code, run.err) == (0, "")
    assert "1 check on 1 component: 1 passed" in run.out


def test_check_of_something_that_is_not_there(moseg):
    run = moseg("plugin", "check", "bsic")
    assert run.code == 2
    assert "did you mean 'basic'" in run.err


def test_times_of_components(moseg, outcomes):
    outcomes(1)
    run = moseg("plugin", "check", "mds", "--time", "--json")
    times = json.loads(run.out)["times"]
    (embedding,) = [each for each in times if each["kind"] == "embedding"]
    assert embedding["zoo"] > 0
    shown = moseg("plugin", "check", "mds", "--time").out.splitlines()
    assert any(line.split()[:2] == ["embedding", embedding["component"]] for line in shown)
    assert "times" not in json.loads(moseg("plugin", "check", "mds", "--json").out)


def test_a_bundle_that_cannot_be_timed_is_named(moseg, outcomes):
    outcomes(1)
    run = moseg("plugin", "check", "acme", "--time")
    assert run.code == 1
    assert "'acme' could not be timed: " in run.err
    assert "Traceback" not in run.err
