"""Each check of labelers fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.registry import registry
from moseg_core.components.discovery.specs import LabelerSpec
from tests.testing.broken.labelers import BROKEN
from tests.testing.outcomes import assert_fails_only, failures, outcomes


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


def test_three_labels_are_tried():
    target = "tests.testing.broken.labelers"
    assert_fails_only(
        "labeler-permutation", LabelerSpec(name="broken", target=f"{target}:OneOfThreeTwice")
    )
    failed = failures(LabelerSpec(name="broken", target=f"{target}:NotThree"))
    assert {"labeler-permutation", "runs-on-the-zoo"} <= set(failed)


def test_claims_of_the_core_are_held_to_all_permutations():
    own = registry().find("labeler", "hungarian").spec
    found = {o.check: o.status for o in outcomes(own)}
    assert found["labeler-optimal"] == "passed"
    assert found["labeler-equivariant"] == "passed"
