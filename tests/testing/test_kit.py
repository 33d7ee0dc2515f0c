"""The kit as a whole: every check has a component that fails it, and moseg's own pass."""

from __future__ import annotations

import importlib
from pathlib import Path

from moseg_core.testing import CHECKS, cases_of, parametrize_contract


def test_every_check_has_a_broken_component():
    cases_of("core")  # imports the checks
    files = Path(__file__).with_name("broken").glob("*.py")
    modules = [importlib.import_module(f"tests.testing.broken.{path.stem}") for path in files]
    broken = [id for module in modules for id in getattr(module, "BROKEN", {})]
    assert sorted(broken) == sorted(CHECKS)


def test_every_module_of_checks_tries_its_broken_components():
    here = Path(__file__).parent
    broken = {path.stem for path in (here / "broken").glob("*.py")} - {"heavy"}
    assert {path.stem for path in (here / "checks").glob("*.py")} == {f"test_{n}" for n in broken}


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


@parametrize_contract("core")
def test_the_core(check):
    check()


@parametrize_contract("symmetry")
def test_symmetry(check):
    check()


@parametrize_contract("mds")
def test_mds(check):
    check()


@parametrize_contract("learn")
def test_learn(check):
    check()


@parametrize_contract("shapes")
def test_the_learned_recipes(check):
    check()
