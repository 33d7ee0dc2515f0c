"""Each check of runs fails for the measure that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import MeasureSpec
from tests.testing.broken.repeats import BROKEN
from tests.testing.outcomes import assert_fails_only, failures


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


def test_a_thread_that_ends_has_not_answered():
    target = "tests.testing.broken.repeats:ends_its_thread"
    assert_fails_only("usable-from-two-threads", MeasureSpec(name="broken", target=target))


@pytest.mark.parametrize("target", ["tests.testing.broken.heavy:spread"])
def test_what_is_sound_passes(target):
    assert failures(MeasureSpec(name="own", target=target)) == {}


def test_a_measure_that_says_what_it_requires_is_not_asked_of_other_shapes():
    target = BROKEN["runs-on-the-zoo"].target
    assert failures(MeasureSpec(name="own", target=target, requires=("surface",))) == {}
