"""Each check of optimizers fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import OptimizerSpec
from tests.testing.broken.optimizers import BROKEN
from tests.testing.outcomes import assert_fails_only, failures


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


def test_starts_are_of_fewer_numbers_than_a_center_too():
    target = "tests.testing.broken.optimizers:WholeCentersOnly"
    assert_fails_only("runs-on-the-zoo", OptimizerSpec(name="broken", target=target))


@pytest.mark.parametrize(
    "target", ["tests.testing.broken.optimizers:Search", "tests.testing.sound:Spread"]
)
def test_what_is_sound_passes(target):
    assert failures(OptimizerSpec(name="own", target=target)) == {}
