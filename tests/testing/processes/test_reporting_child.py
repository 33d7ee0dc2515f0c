"""The child that runs the checks: what it writes to its pipe."""

from __future__ import annotations

import json
import os
from types import SimpleNamespace

import pytest

from moseg_core.testing import Outcome
from moseg_core.testing.processes import reporting_child
from moseg_core.testing.processes.reporting_child import main, run_and_report


class MadeUp:
    """A case that only says which it is."""

    def __init__(self, name, component="own:one", check="first"):
        self.name = name
        self.subject = SimpleNamespace(component=SimpleNamespace(id=component))
        self.check = SimpleNamespace(id=check)

    def outcome(self):
        return Outcome(
            component="own:one", check="first", status="failed", message=self.name, fix="mend it"
        )


@pytest.fixture
def events(monkeypatch):
    """Run the child's main function and return what it wrote."""
    monkeypatch.setattr(reporting_child.faulthandler, "enable", lambda: None)
    monkeypatch.setattr(reporting_child.faulthandler, "register", lambda *args, **named: None)

    def run(*arguments):
        read, write = os.pipe()
        main([*arguments, "--pipe", str(write)])
        with os.fdopen(read) as pipe:
            return [json.loads(line) for line in pipe]

    return run


def test_each_case_is_reported_before_and_after():
    written = []
    cases = [MadeUp("zero"), MadeUp("one"), MadeUp("two")]
    run_and_report(cases, lambda **fields: written.append(fields), leave_out={1})
    assert [(fields["event"], fields["case"]) for fields in written] == [
        ("start", 0),
        ("outcome", 0),
        ("start", 2),
        ("outcome", 2),
    ]
    last = {"event": "outcome", "case": 2, "status": "failed", "message": "two", "fix": "mend it"}
    assert written[-1] == last


def test_the_cases_come_first_and_what_is_left_out_is_not_run(events, monkeypatch):
    monkeypatch.setattr(reporting_child, "cases_of", lambda bundle: [MadeUp("zero"), MadeUp("one")])
    found = events("core", "--leave-out", "0")
    assert found[0]["event"] == "cases"
    assert found[0]["cases"] == [["own:one", "first"]] * 2
    assert found[0]["distribution"].startswith("moseg-core ")
    assert [fields["case"] for fields in found[1:]] == [1, 1]


def test_a_refusal_comes_with_its_exit_code(events):
    found = events("basix")
    assert [fields["event"] for fields in found] == ["refused"]
    assert "'basic'" in found[0]["message"]
    assert found[0]["code"] == 2
