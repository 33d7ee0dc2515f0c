"""Each check of fields fails for the one that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import FieldSpec
from moseg_core.testing.fixtures.shapes import ZOO
from tests.testing.broken.fields import BROKEN
from tests.testing.outcomes import HEIGHT, SKEWED, assert_fails_only, failures, outcomes

REMOTE = FieldSpec(
    name="remote",
    target="tests.testing.odd:remote",
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
)


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


@pytest.mark.parametrize("spec", [HEIGHT, SKEWED, REMOTE], ids=lambda spec: spec.name)
def test_what_is_sound_passes(spec):
    found = outcomes(spec)
    assert [outcome for outcome in found if outcome.status == "failed"] == []
    skipped = {outcome.check for outcome in found if outcome.status == "skipped"}
    assert ("field-rigid" in skipped) == (spec is not REMOTE)
    assert sum(outcome.status == "passed" for outcome in found) > 12


def test_parameters_are_checked():
    passed = {outcome.check for outcome in outcomes(REMOTE) if outcome.status == "passed"}
    assert passed > {"parameters-round-trip", "parameters-in-range", "parameter-out-of-range"}


def test_what_a_spec_requires_is_what_the_shapes_have():
    target = "tests.testing.broken.fields:steep"
    spec = FieldSpec(name="own", target=target, requires=("surface",))
    assert failures(spec) == {}


@pytest.mark.parametrize("name", ZOO)
def test_a_field_is_tried_on_every_shape_that_it_does_not_refuse(name):
    spec = FieldSpec(name="own", target=f"{__name__}:of_{'all' if name else 'none'}_but")
    trouble[:] = [name]
    failed = failures(spec)
    assert set(failed) >= {"field-returns"}
    assert "zoo" in failed["field-returns"]


trouble: list[str] = []


def of_all_but(shape):
    """Fails on the shape that the test names."""
    if shape.name in trouble:
        raise ZeroDivisionError
    return shape.points[:, 2]
