"""Each check of constraints fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import ConstraintSpec
from tests.testing.broken.constraints import BROKEN
from tests.testing.outcomes import assert_fails_only, failures


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


@pytest.mark.parametrize(
    "target",
    [
        "tests.testing.broken.constraints:Level",
        "tests.testing.broken.constraints:Refusing",
        "tests.testing.broken.constraints:opposite",
        "tests.testing.odd:opposite",
    ],
)
def test_what_is_sound_passes(target):
    assert failures(ConstraintSpec(name="own", target=target)) == {}


def test_a_value_may_be_refused_and_must_not_end_in_a_crash():
    target = "tests.testing.broken.constraints:Dividing"
    assert set(failures(ConstraintSpec(name="own", target=target))) == {"parameters-in-range"}
