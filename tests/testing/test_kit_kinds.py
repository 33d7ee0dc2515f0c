"""Each check of one kind fails for the component that is broken that way, and for no other."""

from __future__ import annotations

import importlib

import pytest

from moseg_core.plugins import Bundle, Component, Registry, registry
from moseg_core.specs import (
    ConstraintSpec,
    EmbeddingSpec,
    LabelerSpec,
    OptimizerSpec,
    ParameterizationSpec,
    SeederSpec,
)
from moseg_core.testing import CHECKS, cases_of, parametrize_contract

SPECS = {
    "parameterizations": ParameterizationSpec,
    "seeders": SeederSpec,
    "labelers": LabelerSpec,
    "optimizers": OptimizerSpec,
    "constraints": ConstraintSpec,
    "embeddings": EmbeddingSpec,
}
HOME = "tests.testing.broken"
SOUND = {"seeders": "Drawn", "constraints": "Level", "embeddings": "Stretched"}


def outcomes(kind, name):
    spec = SPECS[kind](name="broken", target=f"{HOME}.{kind}:{name}")
    component = Component("broken", "moseg-broken 1.0", spec)
    bundle = Bundle("broken", "moseg-broken", "1.0", HOME, (component,))
    source = Registry([*registry().bundles, bundle])
    return [case.outcome() for case in cases_of("broken", source=source)]


def broken(kind):
    return importlib.import_module(f"{HOME}.{kind}").BROKEN


@pytest.mark.parametrize(
    ("kind", "id", "name"), [(k, id, name) for k in SPECS for id, name in broken(k).items()]
)
def test_it_fails_this_check_and_no_other(kind, id, name):
    failed = {
        found.check: found.message for found in outcomes(kind, name) if found.status == "failed"
    }
    assert set(failed) == {id}, failed
    assert "got " in failed[id] or "it raised" in failed[id]


def test_every_check_of_these_kinds_has_a_broken_component():
    cases_of("core")  # imports the checks
    kinds = {spec.kind for spec in SPECS.values()}
    asked = {
        check.id for check in CHECKS.values() if len(check.kinds) == 1 and set(check.kinds) <= kinds
    }
    assert asked == {id for kind in SPECS for id in broken(kind)}


@pytest.mark.parametrize(("kind", "name"), SOUND.items())
def test_what_the_broken_ones_are_made_of_is_sound(kind, name):
    assert [found for found in outcomes(kind, name) if found.status == "failed"] == []


@parametrize_contract("core")
def test_the_core(check):
    check()


@parametrize_contract("symmetry")
def test_symmetry(check):
    check()


@parametrize_contract("mds")
def test_mds(check):
    check()
