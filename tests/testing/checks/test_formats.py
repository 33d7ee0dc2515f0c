"""Checks of readers and writers, each against one that breaks just that."""

from __future__ import annotations

from dataclasses import replace

import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.testing import cases_of, run_cases
from tests.testing.broken.formats import BROKEN, HOME, SOUND, _writer
from tests.testing.outcomes import assert_fails_only, failures, outcomes

WITH_A_WRITER = "reader-reads-what-is-written"


def together(*specs):
    """What fails of components of one bundle."""
    components = tuple(Component("own", "own 1.0", spec) for spec in specs)
    source = Registry([Bundle("own", "own", "1.0", "tests.testing.broken", components)])
    found = run_cases(cases_of("own", source=source))
    return {
        f"{outcome.component} {outcome.check}" for outcome in found if outcome.status == "failed"
    }


@pytest.mark.parametrize("id", sorted(set(BROKEN) - {WITH_A_WRITER}))
def test_each_fails_its_own_check_only(id):
    assert_fails_only(id, BROKEN[id])


def test_a_reader_that_does_not_read_what_its_bundle_writes():
    reader = BROKEN[WITH_A_WRITER]
    assert failures(reader) == {}  # alone there is nothing to compare with
    writer = replace(SOUND["writer"], name="points")
    assert together(reader, writer) == {f"own:broken {WITH_A_WRITER}"}


def test_sound_ones_pass():
    assert together(SOUND["reader"], replace(SOUND["writer"], name="points")) == set()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("write_text", "returned a str, not bytes; encode the text"),
        ("write_beyond", "not relative or not safe"),
        ("write_nothing", "refusals of all, the last for UsageError: not today"),
        ("write_crashing", "broken/formats.py"),
    ],
)
def test_what_is_said_of_writers(name, said):
    assert said in failures(_writer(name))["writer-returns-bytes"]


def test_a_reader_without_an_example_is_told_how_to_give_one():
    (skipped,) = (
        found.message
        for found in outcomes(replace(SOUND["reader"], example=""))
        if found.check == "reader-survives-cut-files"
    )
    assert "example='package.module:name'" in skipped


def test_an_example_that_is_a_text_is_no_file():
    spec = replace(SOUND["reader"], example=f"{HOME}:text_example")
    assert "got a str, expected bytes" in failures(spec)["reader-reads-its-example"]
