"""Each check of refiners fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import RefinerSpec
from tests.testing.broken.refiners import BROKEN
from tests.testing.outcomes import assert_fails_only, outcomes


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


TARGET = "tests.testing.broken.refiners"


def test_labels_as_they_are_pass():
    spec = RefinerSpec(name="mine", target=f"{TARGET}:AsTheyAre")
    found = {outcome.check: outcome.status for outcome in outcomes(spec)}
    assert {found[id] for id in BROKEN} == {"passed"}
    assert "failed" not in found.values()


def test_a_label_that_there_is_not_is_told():
    assert_fails_only("refiner-labels", RefinerSpec(name="mine", target=f"{TARGET}:OneTooMany"))
