"""Each check of learners fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core import LearnerSpec
from tests.testing.broken.learners import BROKEN
from tests.testing.outcomes import assert_fails_only, outcomes


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


def test_a_sound_one_passes_and_is_run():
    spec = LearnerSpec(name="mine", target="tests.testing.broken.learners:sound")
    found = {outcome.check: outcome.status for outcome in outcomes(spec)}
    assert {found[id] for id in BROKEN} == {"passed"}
    assert "failed" not in found.values()
    assert found["same-in-every-process"] == found["inputs-untouched"] == "passed"
