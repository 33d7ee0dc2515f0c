"""Options that several commands share: each is explained, and shown where it can be given."""

from __future__ import annotations

import dataclasses

import pytest

from moseg_core.cli.flags import (
    CheckpointFlags,
    ProblemFlags,
    SearchedProblemFlags,
    SearchFlags,
    ShapeFlags,
    SteeringFlags,
)

GROUPS = (
    *(ProblemFlags, SearchedProblemFlags, ShapeFlags, SearchFlags, SteeringFlags),
    CheckpointFlags,
)


def options(group):
    return [f"--{field.name.replace('_', '-')}" for field in dataclasses.fields(group)]


@pytest.mark.parametrize("group", GROUPS)
def test_every_option_is_explained_where_it_is_declared(group):
    inherited = {field for base in group.__mro__[1:-1] for field in base.__dataclass_fields__}
    lines = group.__doc__.splitlines()
    for field in set(group.__dataclass_fields__) - inherited:
        place = lines.index(f"    {field}")
        assert lines[place + 1].startswith("        "), field


def test_segment_shows_them_all_in_its_help_and_explain_those_about_problems(moseg):
    segment, explain = moseg("segment", "--help").out, moseg("explain", "--help").out
    for group in GROUPS:
        assert [option for option in options(group) if option not in segment] == []
    for option in options(ProblemFlags) + options(ShapeFlags):
        assert option in explain
    for option in options(SearchFlags):
        assert option not in explain


def test_whether_anything_was_asked_for():
    assert not ProblemFlags().anything
    assert ProblemFlags(space="original").anything
