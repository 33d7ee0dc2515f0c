"""What the checks say of a component that the tests name by its spec."""

from __future__ import annotations

from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import FieldSpec
from moseg_core.testing import Subject, cases_of, run_cases

HOME = "tests.testing.broken"

HEIGHT = FieldSpec(name="height", target="tests.testing.odd:height")
SKEWED = FieldSpec(name="skewed", target="tests.testing.odd:skewed", requires=("surface",))
THIRDS = FieldSpec(name="thirds", target="tests.testing.odd:thirds")

STAND_IN = Bundle(
    *("given", "moseg-given", "1.0", HOME),
    tuple(Component("given", "moseg-given 1.0", spec) for spec in (HEIGHT, SKEWED, THIRDS)),
)
"""A bundle of fields that the tests' objectives read."""

INSTALLED = Registry([*registry().bundles, STAND_IN])


def subject(spec):
    return Subject(component=Component("own", "own 1.0", spec), registry=INSTALLED)


def outcomes(spec, module=HOME):
    bundle = Bundle("own", "own", "1.0", module, (subject(spec).component,))
    return run_cases(cases_of("own", source=Registry([*INSTALLED.bundles, bundle])))


def failures(spec, module=HOME):
    """Message and fix of each check that fails, by id."""
    return {
        outcome.check: f"{outcome.message}; {outcome.fix}"
        for outcome in outcomes(spec, module)
        if outcome.status == "failed"
    }


def assert_fails_only(id, spec, module=HOME):
    failed = failures(spec, module)
    assert set(failed) == {id}, failed
    for word in ("got ", "expected ", "; "):
        assert word in failed[id]
