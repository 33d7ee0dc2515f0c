"""Each check of parameterizations fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import ParameterizationSpec
from tests.testing.broken.parameterizations import BROKEN, SEVERAL_CENTERS
from tests.testing.outcomes import assert_fails_only, failures


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


@pytest.mark.parametrize("id", SEVERAL_CENTERS)
def test_those_of_several_centres_a_part_are_held_to_the_same(id):
    assert_fails_only(id, SEVERAL_CENTERS[id])


@pytest.mark.parametrize("target", ["tests.testing.sound:Unweighted", "tests.testing.sound:Bodies"])
def test_what_is_sound_passes(target):
    assert failures(ParameterizationSpec(name="own", target=target)) == {}
