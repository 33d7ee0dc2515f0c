"""Specs: what a name and a target may look like."""

from __future__ import annotations

import dataclasses

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.components.discovery.specs import (
    NAME,
    FieldSpec,
    MeasureSpec,
    ObjectiveSpec,
    OptimizerSpec,
    ParameterizationSpec,
    ReaderSpec,
    WriterSpec,
)
from moseg_core.language import parse


@pytest.mark.parametrize("name", ["narrow", "a", "x2", "convex_parts", "a_", "k9_9"])
def test_names(name):
    assert ObjectiveSpec(name=name, target="a:b").name == name


@pytest.mark.parametrize(
    "name",
    ["", "Narrow", "2d", "_x", "a-b", "a b", "a:b", "a.b", "tête", "a\n", "\n", "a*", "٣", "a٣"],
)
def test_other_names_are_refused(name):
    with pytest.raises(ValueError, match=r"objective name .* is not made of lower-case letters"):
        ObjectiveSpec(name=name, target="a:b")


@pytest.mark.parametrize("target", ["a:b", "package.module:Name", "_a.b2.c:NAME_2", "A:_b"])
def test_targets(target):
    assert OptimizerSpec(name="x", target=target).target == target


@pytest.mark.parametrize(
    "target",
    [
        "",
        "a",
        "a:",
        ":b",
        "a.b",
        "a:b.c",
        "a:b:c",
        "a b:c",
        "a:b c",
        "a/b:c",
        "1a:b",
        "a:1",
        "a:b\n",
    ],
)
def test_other_targets_are_refused(target):
    with pytest.raises(ValueError, match="of optimizer 'x' is not of the form"):
        OptimizerSpec(name="x", target=target)


@given(st.text())
def test_any_name_is_taken_or_refused_and_can_be_written_in_an_expression(name):
    try:
        spec = ObjectiveSpec(name=name, target="a:b")
    except ValueError:
        assert not NAME.match(name)
        return
    assert parse(f"{spec.name} + b:{spec.name}").terms[0].name == name


@given(st.from_regex(NAME, fullmatch=True))
def test_every_allowed_name_can_be_written_in_an_expression(name):
    ObjectiveSpec(name=name, target="a:b")
    assert [term.name for term in parse(f"{name} + {name}:{name}").terms] == [
        name,
        f"{name}:{name}",
    ]


def test_specs_are_values_that_cannot_be_changed():
    spec = MeasureSpec(name="x", target="a:b")
    assert spec == MeasureSpec(name="x", target="a:b")
    assert spec != MeasureSpec(name="x", target="a:b", keep=False)
    assert spec != ObjectiveSpec(name="x", target="a:b")
    assert (spec.summary, spec.keep) == ("", True)
    with pytest.raises(dataclasses.FrozenInstanceError):
        spec.name = "y"


@pytest.mark.parametrize("make", [FieldSpec, MeasureSpec, ParameterizationSpec])
@pytest.mark.parametrize("requires", [("volumes",), "volume"])
def test_what_is_required_is_among_the_words(make, requires):
    assert make(name="x", target="a:b", requires=("volume",)).requires == ("volume",)
    with pytest.raises(
        ValueError, match=r"'x' requires 'volume.*known are volume, adjacency, surf"
    ):
        make(name="x", target="a:b", requires=requires)


def test_the_example_of_a_reader_is_a_target():
    spec = ReaderSpec(name="x", target="a:b", suffixes=(".x",), example="a.b:c")
    assert spec.example == "a.b:c"
    with pytest.raises(ValueError, match=r"example 'a\.b' of reader 'x' is not of the form"):
        ReaderSpec(name="x", target="a:b", suffixes=(".x",), example="a.b")
    with pytest.raises(ValueError, match=r"labels 'a\.b' of reader 'x' is not of the form"):
        ReaderSpec(name="x", target="a:b", suffixes=(".x",), labels="a.b")


@pytest.mark.parametrize("make", [ReaderSpec, WriterSpec])
@pytest.mark.parametrize("suffixes", [(".off",), (".ply", ".plyz"), (".tar.gz",)])
def test_suffixes(make, suffixes):
    assert make(name="x", target="a:b", suffixes=suffixes).suffixes == suffixes


@pytest.mark.parametrize("make", [ReaderSpec, WriterSpec])
@pytest.mark.parametrize(
    "suffixes", [".off", ("off",), (".OFF",), (), (".",), ("",)], ids=["text", *"abcde"]
)
def test_suffixes_that_no_file_can_have_are_refused(make, suffixes):
    # A text instead of a tuple would be taken apart into letters, and never match.
    with pytest.raises(ValueError, match="suffix"):
        make(name="x", target="a:b", suffixes=suffixes)
