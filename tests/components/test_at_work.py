"""Which component is at work, as another process reads it."""

from __future__ import annotations

from multiprocessing import RawArray

import pytest

from moseg_core.components.at_work import SIZE, at_work, note_in, noted
from moseg_core.components.discovery.registry import Component
from moseg_core.components.discovery.specs import SeederSpec


@pytest.fixture
def memory():
    made = RawArray("c", SIZE)
    note_in(made)
    yield made
    note_in(None)


def test_the_innermost_call_is_noted_and_then_the_one_around_it(memory):
    with at_work("seeder"):
        with at_work("objective"):
            assert noted(memory) == "objective"
        assert noted(memory) == "seeder"
    assert noted(memory) == ""


def test_a_call_that_fails_is_over_too(memory):
    with pytest.raises(KeyError), at_work("seeder"), at_work("objective"):
        raise KeyError
    assert noted(memory) == ""


def test_long_names_and_other_alphabets_fit(memory):
    with at_work("ä" * SIZE):
        assert noted(memory).startswith("ä" * (SIZE // 2 - 1))


def test_guards_note_the_component(memory):
    component = Component("strange", "moseg-strange 2.0", SeederSpec(name="odd", target="a:b"))
    with component.guard():
        assert noted(memory) == "seeder 'strange:odd' of moseg-strange 2.0"


def test_elsewhere_nothing_is_noted():
    made = RawArray("c", SIZE)
    with at_work("seeder"):
        assert noted(made) == ""
