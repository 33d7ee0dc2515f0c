"""How long components take, on a clock of the test's own."""

from __future__ import annotations

import itertools
import json

import pytest

from moseg_core.components.discovery.specs import FieldSpec, MeasureSpec, ObjectiveSpec
from moseg_core.testing import timing
from moseg_core.testing.timing import time_bundle

HOME = "tests.testing.odd"


@pytest.fixture(autouse=True)
def one_sample(monkeypatch):
    monkeypatch.setattr(timing, "SAMPLES", ("hammer",))


def ticking(seconds: float):
    """A clock on which every call takes so long."""
    return (seconds * k for k in itertools.count()).__next__


def timed(spec, seconds=2e-3):
    (found,) = time_bundle(spec, clock=ticking(seconds))
    return found


def test_objectives_are_asked_of_the_zoo_and_of_the_samples():
    found = timed(ObjectiveSpec(name="near", target=f"{HOME}:near"))
    assert (found.kind, found.declared) == ("objective", "cheap")
    assert found.zoo == pytest.approx(2000)
    assert found.samples == pytest.approx(2000)
    assert found.calls > 10
    assert found.note == "rather moderate: above 1000 us"
    assert timed(ObjectiveSpec(name="near", target=f"{HOME}:near"), 1e-5).note == ""
    slow = timed(ObjectiveSpec(name="near", target=f"{HOME}:near"), 1.0)
    assert slow.note == "rather expensive: above 1000 us"


def test_fields_measures_and_others_declare_no_cost():
    for spec in (
        FieldSpec(name="thirds", target=f"{HOME}:thirds"),
        MeasureSpec(name="spread", target="tests.testing.broken.heavy:spread"),
    ):
        found = timed(spec)
        assert (found.declared, found.note) == ("", "")
        assert found.samples == pytest.approx(2000)


def test_other_kinds_are_run_as_the_kit_runs_them():
    (found,) = [t for t in time_bundle("core", clock=ticking(1.0)) if t.component == "core:greedy"]
    assert found.samples is None
    assert found.zoo == pytest.approx(1e6 / found.calls)


def test_what_raises_is_noted():
    found = timed(ObjectiveSpec(name="lost", target=f"{HOME}:not_there"))
    assert "PluginError" in found.note
    assert found.calls == 0


def test_the_process_prints_json(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["timing", "mds"])
    timing.main()
    found = json.loads(capsys.readouterr().out)
    assert "embedding" in {each["kind"] for each in found}
