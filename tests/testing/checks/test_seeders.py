"""Each check of seeders fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import SeederSpec
from tests.testing.broken.seeders import BROKEN
from tests.testing.outcomes import assert_fails_only, failures


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


def test_three_labels_are_tried():
    target = "tests.testing.broken.seeders"
    assert_fails_only(
        "seeder-count", SeederSpec(name="broken", target=f"{target}:OneTooFewOfThree")
    )
    failed = failures(SeederSpec(name="broken", target=f"{target}:NotThree"))
    assert {"seeder-count", "runs-on-the-zoo"} <= set(failed)


@pytest.mark.parametrize("target", ["tests.testing.broken.seeders:Drawn"])
def test_what_is_sound_passes(target):
    assert failures(SeederSpec(name="own", target=target)) == {}
