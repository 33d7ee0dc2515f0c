"""Each check of parameters fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.components.parameters import Interval, Parameter
from moseg_core.language import Target
from moseg_core.testing.checks.declarations import within
from tests.testing.broken.declarations import BROKEN
from tests.testing.outcomes import assert_fails_only, failures


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


@pytest.mark.parametrize("target", ["tests.testing.odd:near", "tests.testing.odd:sized"])
def test_what_is_sound_passes(target):
    assert failures(ObjectiveSpec(name="own", target=target)) == {}


@pytest.mark.parametrize(
    ("fields", "values"),
    [
        ({"type": bool}, [False, True]),
        ({"type": str}, []),
        ({"type": float}, []),
        ({"type": float, "interval": Interval(0, 1)}, [0.0, 1.0]),
        ({"type": int, "interval": Interval(1, 9), "default": 3}, [1, 9]),
        ({"type": float, "interval": Interval(0, 99), "default": 3.0}, [0.0]),
        ({"type": Target}, [Target(1, 0.25)]),
        ({"type": Target, "interval": Interval(0, 1)}, [Target(1, 0.25), Target(0, 1)]),
        ({"type": Target, "interval": Interval(4, 999)}, [Target(4, 1)]),
    ],
)
def test_values_that_a_declaration_allows(fields, values):
    assert within(Parameter(name="p", **fields)) == values
