"""Each check of parameters fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import ObjectiveSpec
from tests.testing.broken.declarations import BROKEN
from tests.testing.outcomes import assert_fails_only, failures


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


@pytest.mark.parametrize("target", ["tests.testing.odd:near"])
def test_what_is_sound_passes(target):
    assert failures(ObjectiveSpec(name="own", target=target)) == {}
