"""Components that are not found, cannot be made or do not answer fail the check that says so."""

from __future__ import annotations

import inspect
import sys
from pathlib import Path
from typing import get_args

import pytest

from moseg_core.components import protocols
from moseg_core.components.discovery.specs import (
    ConstraintSpec,
    Kind,
    ParameterizationSpec,
    RecipeSpec,
)
from moseg_core.errors import UsageError
from moseg_core.testing import CHECKS, load_checks
from moseg_core.testing.checks import general
from moseg_core.testing.fixtures.trial import FACTORIES
from tests.testing.broken.general import BROKEN, BUNDLES
from tests.testing.outcomes import HOME, assert_fails_only, failures


class OnNoLabels:
    """A constraint that can be made on no number of labels."""

    def __init__(self, shape, labels):
        raise UsageError("it takes 99 labels")


#: Recipes of any number of parts; words about several need two of them.
OPEN_RECIPE = 'labels = ["body", "leg*"]\nminimize = "compact(body) + basic:similar(leg*)"\n'
WRONG_OPEN_RECIPE = OPEN_RECIPE.replace("similar", "similr")


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id], BUNDLES.get(id, HOME))


def test_a_constraint_that_cannot_be_made_is_reported_once():
    failed = failures(ConstraintSpec(name="own", target=f"{__name__}:OnNoLabels"))
    assert set(failed) == {"default-construction"}
    assert "it takes 99 labels" in failed["default-construction"]


def test_what_makes_a_parameterization_clippable_is_held_to_its_protocol():
    target = "tests.testing.broken.general:DistancesOfNoPoints"
    spec = ParameterizationSpec(name="broken", target=target)
    assert_fails_only("protocol-answered", spec)
    assert "DistancesOfNoPoints.distances" in failures(spec)["protocol-answered"]


def test_an_open_recipe_is_tried_with_a_few_parts():
    assert failures(RecipeSpec(name="open", target=f"{__name__}:OPEN_RECIPE")) == {}
    failed = failures(RecipeSpec(name="open", target=f"{__name__}:WRONG_OPEN_RECIPE"))
    assert set(failed) == {"signature-fits"}
    assert "did you mean 'basic:similar'" in failed["signature-fits"]


def test_every_kind_that_is_made_has_the_protocol_of_its_name():
    for kind in FACTORIES:
        assert inspect.isclass(getattr(protocols, kind.capitalize()))


def test_the_gates_come_first_and_are_about_all_that_they_can_be():
    gates = [check for check in load_checks() if check.gate]
    general = [gate for gate in gates if len(gate.kinds) > 1]
    assert gates[: len(general)] == general == list(load_checks()[: len(general)])
    for gate in gates[len(general) :]:  # of one kind: before whatever else is checked of it alone
        alone = [check for check in load_checks() if check.kinds == gate.kinds]
        assert alone[0] is gate
    assert CHECKS["target-resolves"].kinds == get_args(Kind)


@pytest.mark.parametrize(
    ("module", "heavy"),
    [("moseg_core.builtin.plugin", []), ("tests.testing.broken.heavy", ["numpy"])],
)
def test_what_importing_a_bundle_imports(module, heavy):
    found, failure, _ = general._imports(module, (str(Path.cwd()), *sys.path))
    assert (found, failure) == (heavy, "")


def test_importing_a_bundle_that_fails():
    assert "not_there" in general._imports("not_there", tuple(sys.path))[1]
