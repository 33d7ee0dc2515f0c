"""Each check fails for the component that is broken that way, and for no other."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import ConstraintSpec, ObjectiveSpec
from moseg_core.testing import CHECKS, cases_of, parametrize_contract, run_cases

HOME = "tests.testing.broken"
MINE = ("general", "declarations", "repeats", "objectives", "invariances")
SPECS = {
    id: spec
    for name in MINE
    for id, spec in importlib.import_module(f"{HOME}.{name}").BROKEN.items()
}
BUNDLES = importlib.import_module(f"{HOME}.general").BUNDLES


def outcomes(spec, module=HOME):
    component = Component("broken", "moseg-broken 1.0", spec)
    bundle = Bundle("broken", "moseg-broken", "1.0", module, (component,))
    return run_cases(cases_of("broken", source=Registry([*registry().bundles, bundle])))


@pytest.mark.parametrize("id", SPECS)
def test_it_fails_this_check_and_no_other(id):
    found = outcomes(SPECS[id], BUNDLES.get(id, HOME))
    failed = {
        outcome.check: f"{outcome.message}; {outcome.fix}"
        for outcome in found
        if outcome.status == "failed"
    }
    assert set(failed) == {id}, failed
    for word in ("got ", "expected ", "; "):
        assert word in failed[id]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("counts_triangles", {"objective-requires-what-it-reads"}),
        ("counts_pieces", {"objective-requires-what-it-reads"}),
        ("counts_triangles_or_points", set()),
    ],
)
def test_what_an_objective_may_read(name, expected):
    spec = ObjectiveSpec(name="broken", target=f"{HOME}.objectives:{name}")
    assert {found.check for found in outcomes(spec) if found.status == "failed"} == expected


@pytest.mark.parametrize(
    ("spec", "name"),
    [
        (ConstraintSpec, "opposite"),
        (ObjectiveSpec, "share"),
        (ObjectiveSpec, "near"),
        (ObjectiveSpec, "four"),
    ],
)
def test_unusual_components_pass(spec, name):
    found = outcomes(spec(name="odd", target=f"tests.testing.odd:{name}"))
    assert [outcome for outcome in found if outcome.status == "failed"] == []
    assert sum(outcome.status == "passed" for outcome in found) > 10


def test_every_check_has_a_broken_component():
    cases_of("core")  # imports the checks
    files = Path(__file__).with_name("broken").glob("*.py")
    modules = [importlib.import_module(f"{HOME}.{path.stem}") for path in files]
    broken = [id for module in modules for id in getattr(module, "BROKEN", {})]
    assert sorted(broken) == sorted(CHECKS)


def test_checks_say_why():
    for id, check in CHECKS.items():
        assert id == check.id
        assert id.replace("-", "").islower()
        assert check.since == 1
        assert len(check.why.split()) > 5
        assert not check.why.endswith(".")


@parametrize_contract("basic")
def test_basic(check):
    check()
