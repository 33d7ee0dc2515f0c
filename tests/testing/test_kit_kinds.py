"""Each check of one kind fails for the component that is broken that way, and for no other."""

from __future__ import annotations

import importlib

import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import (
    ConstraintSpec,
    EmbeddingSpec,
    OptimizerSpec,
    ParameterizationSpec,
    SeederSpec,
)
from moseg_core.testing import CHECKS, cases_of, parametrize_contract, run_cases

HOME = "tests.testing.broken"
MINE = ("parameterizations", "seeders", "labelers", "optimizers", "constraints", "embeddings")
MODULES = {name: importlib.import_module(f"{HOME}.{name}") for name in MINE}
SPECS = {id: spec for module in MODULES.values() for id, spec in module.BROKEN.items()}

#: What the broken ones are made of, and other components with nothing wrong.
SOUND = {
    f"{HOME}.seeders:Drawn": SeederSpec,
    f"{HOME}.optimizers:Search": OptimizerSpec,
    f"{HOME}.constraints:Level": ConstraintSpec,
    f"{HOME}.constraints:opposite": ConstraintSpec,
    f"{HOME}.embeddings:Stretched": EmbeddingSpec,
    "tests.testing.sound:Unweighted": ParameterizationSpec,
    "tests.testing.sound:Spread": OptimizerSpec,
}


def failures(spec):
    component = Component("broken", "moseg-broken 1.0", spec)
    bundle = Bundle("broken", "moseg-broken", "1.0", HOME, (component,))
    found = run_cases(cases_of("broken", source=Registry([*registry().bundles, bundle])))
    return {
        outcome.check: f"{outcome.message}; {outcome.fix}"
        for outcome in found
        if outcome.status == "failed"
    }


@pytest.mark.parametrize("id", SPECS)
def test_it_fails_this_check_and_no_other(id):
    failed = failures(SPECS[id])
    assert set(failed) == {id}, failed
    for word in ("got ", "expected ", "; "):
        assert word in failed[id]


def test_every_check_of_these_kinds_has_a_broken_component():
    cases_of("core")  # imports the checks
    kinds = {spec.kind for spec in SPECS.values()}
    own = [check.id for check in CHECKS.values() if len(check.kinds) == 1]
    assert {id for id in own if CHECKS[id].kinds[0] in kinds} == set(SPECS)


@pytest.mark.parametrize("target", SOUND)
def test_what_is_sound_passes(target):
    assert failures(SOUND[target](name="broken", target=target)) == {}


@parametrize_contract("core")
def test_the_core(check):
    check()


@parametrize_contract("symmetry")
def test_symmetry(check):
    check()


@parametrize_contract("mds")
def test_mds(check):
    check()
