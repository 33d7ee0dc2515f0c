"""Statements: the same whether read from a recipe, a result or the command line."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core import (
    Hierarchy,
    Problem,
    load,
    sample_path,
    save,
    segment,
    segment_hierarchy,
)
from moseg_core.cli.flags import SearchedProblemFlags
from moseg_core.cli.request import read_statement
from moseg_core.components.chosen import Choice
from moseg_core.errors import UsageError
from moseg_core.io import read_result
from moseg_core.language import Target, parse
from moseg_core.problem.recipe import Recipe, load_recipe, parse_recipe
from moseg_core.problem.settings import Method
from moseg_core.problem.statement import Statement, check_label_names

WORDS = st.text(st.characters(exclude_categories=["Cs"]), max_size=9)
NAMES = st.from_regex(r"[a-z][a-z0-9]{0,4}", fullmatch=True)
TARGETS = st.builds(Target, st.floats(-9, 9), st.floats(1e-9, 9))
VALUES = st.integers(-9, 9).map(float) | WORDS | st.booleans() | st.none() | TARGETS
TABLES = st.recursive(
    st.dictionaries(
        WORDS.filter(bool),
        st.integers(-(2**63), 2**63 - 1)
        | st.floats(allow_nan=False, allow_infinity=False)
        | st.booleans()
        | TARGETS
        | WORDS.filter(lambda text: "+-" not in text and "±" not in text),
        max_size=2,
    ),
    lambda inner: st.dictionaries(WORDS.filter(bool), inner, max_size=2),
    max_leaves=3,
)
CHOICES = st.builds(Choice, NAMES, st.dictionaries(NAMES, VALUES, max_size=2))
SEARCHES = st.builds(
    Method,
    seeder=st.none() | CHOICES,
    optimizer=st.none() | CHOICES,
    restarts=st.none() | st.integers(1, 99),
    resolution=st.none() | st.just("full") | st.integers(1, 9999),
)


def statements(parts):
    return st.builds(
        Statement,
        labels=st.just(("a", "b")),
        minimize=WORDS,
        constraints=st.lists(WORDS, max_size=2).map(tuple),
        plane=st.none() | st.sampled_from(["auto", "x"]),
        embedding=st.none() | CHOICES,
        space=st.none() | NAMES,
        given=st.dictionaries(WORDS.filter(bool), TABLES, max_size=2),
        search=SEARCHES,
        parts=parts,
    )


LEAVES = statements(st.just(()))
TREES = statements(
    st.dictionaries(st.sampled_from("ab"), LEAVES).map(lambda parts: tuple(sorted(parts.items())))
)


@given(TREES)
def test_plain_data_reads_back_as_it_was(stated):
    document = json.loads(json.dumps(stated.document()))
    assert Statement.read(document) == stated


@given(TREES, WORDS)
def test_a_recipe_reads_back_as_it_was(stated, description):
    recipe = Recipe(name="mine", statement=stated, description=description)
    assert parse_recipe(recipe.toml(), "mine") == recipe


@pytest.mark.parametrize(
    "name", ["paper_hammer", "words_fourleg", "paper_bulldog", "paper_dove", "paper_octopus"]
)
def test_the_command_line_and_the_recipe_say_the_same(name):
    stated = load_recipe(name).statement
    flags = SearchedProblemFlags(
        labels=",".join(stated.labels),
        minimize=stated.minimize,
        constraint=list(stated.constraints) or None,
        plane=stated.plane,
        embedding=None if stated.embedding is None else str(stated.embedding),
        space=stated.space,
    )
    assert read_statement(flags) == replace(stated, search=Method())


def test_a_result_says_what_was_asked(tmp_path):
    stated = Statement.read(
        {
            "labels": ["handle", "head"],
            "minimize": "narrow(handle)",
            "constraints": ["on_plane(handle)"],
            "plane": "x",
            "given": {"unused": {"area": "0.5±0.1", "many": 3}},
        }
    )
    tables = {"claw": {"length": "0.2+-0.1"}}
    part = Statement(labels=("face", "claw"), minimize="is(claw, given=claw)", given=tables)
    parts = (("head", part),)
    task = Hierarchy.of(replace(stated, parts=parts))
    assert task.statement == replace(stated, parts=parts)
    result = segment_hierarchy(
        load(sample_path("hammer")), task, optimizer="pattern_search(max_evaluations=5)"
    )
    save(result, tmp_path / "hammer.json")
    saved = read_result(tmp_path / "hammer.json")
    assert saved.statement == task.statement
    assert saved.search("head").optimizer == Choice("core:pattern_search", {"max_evaluations": 5})
    with pytest.raises(UsageError, match="unknown level 'hed'; did you mean 'head'"):
        saved.search("hed")
    assert Hierarchy.of(saved.statement).labels == task.labels


CHANGES = [
    {"labels": ("a", "c")},
    {"minimize": "flat(a)"},
    {"constraints": ("on_plane(a)",)},
    {"plane": "y"},
    {"embedding": Choice("mds", {"refine": 3.0})},
    {"space": "mds"},
    {"given": {"leg": {}}},
    {"given": {"leg": {"area": Target(0.06, 0.02)}}},
    {"search": Method(seeder="evolution")},
    {"search": Method(restarts=2)},
    {"parts": (("a", Statement(labels=("c",), minimize="narrow(c)")),)},
]


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: next(iter(change)))
def test_whatever_differs_shows_in_the_digest(change):
    stated = Statement(labels=("a", "b"), minimize="narrow(a)")
    assert replace(stated, **change).digest() != stated.digest()
    assert replace(stated, **change) != stated
    assert replace(stated).digest() == stated.digest() == Statement.read(stated.document()).digest()
    assert hash(replace(stated, **change)) == hash(replace(stated, **change))


def test_a_problem_keeps_its_statement():
    tables = {"a": {"area": Target(0.5, 0.1)}}
    problem = Problem(
        ["a", "b"],
        "  is( a,given=a )+ 2*flat(b)",
        constraints=["on_plane(a, b)"],
        plane="x",
        given=tables,
    )
    assert problem.statement == Statement(
        labels=("a", "b"),
        minimize="is(a, given=a) + 2*flat(b)",
        constraints=("on_plane(a)", "on_plane(b)"),
        plane="x",
        given=tables,
    )
    assert Problem.of(problem.statement).statement == problem.statement


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"label": []}, "unknown key 'label'; did you mean 'labels'"),
        ({"minimize": "f"}, "'labels' must be a list of texts; it is missing"),
        ({"labels": "a", "minimize": "f"}, "'labels' must be a list of texts; it is 'a'"),
        ({"labels": ["a", 3], "minimize": "f"}, "'labels' must be a list of texts; 3 is none"),
        ({"labels": ["a"], "minimize": "f", "plane": 3}, "'plane' must be a text; it is 3"),
        ({"labels": ["a"], "minimize": "f", "restarts": 0}, "at least one start, not 0"),
        ({"labels": ["a"], "minimize": "f", "embedding": 3}, "embedding must be a name or a table"),
        ({"labels": ["a"], "minimize": "f", "given": 3}, "'given' must be tables such as [given.l"),
        ({"labels": ["a"], "minimize": "f", "given": {"leg": 3}}, "[given.leg]; 'leg' is 3"),
        (
            {"labels": ["a"], "minimize": "f", "given": {"leg": {"area": "0.06+-"}}},
            "'leg.area' in the tables is no target",
        ),
    ],
)
def test_what_is_no_statement(table, message):
    with pytest.raises(UsageError) as caught:
        Statement.read(table)
    assert message in str(caught.value)


def test_the_order_of_parameters_says_nothing():
    one, other = (
        Statement(labels=["a"], minimize="narrow(a)", embedding=Choice("mds", parameters))
        for parameters in ({"landmarks": 50, "refine": 3}, {"refine": 3, "landmarks": 50})
    )
    assert one == other
    assert hash(one) == hash(other)
    assert one.digest() == other.digest()


def test_a_result_with_more_to_say_is_read(tmp_path):
    result = segment(
        load(sample_path("hammer")),
        Problem(["handle", "head"], "narrow(handle)"),
        optimizer="pattern_search(max_evaluations=5)",
    )
    save(result, tmp_path / "a.json")
    text = (tmp_path / "a.json").read_text().replace('"problem": {', '"problem": {"novel": 1, ')
    (tmp_path / "b.json").write_text(text)
    assert read_result(tmp_path / "b.json").statement == result.problem.statement


def test_an_open_label_is_numbered():
    stated = Statement(labels=("body", "leg*", "tail"), minimize="narrow(leg*)", plane="x")
    assert stated.is_open
    four = stated.with_parts(4)
    assert not four.is_open
    assert four == replace(stated, labels=("body", "leg1", "leg2", "tail"))
    assert stated.with_parts(3).labels == ("body", "leg1", "tail")
    assert Statement(labels=("part*",), minimize="f").with_parts(1).labels == ("part1",)


def test_what_is_said_of_the_parts_of_an_open_label_holds_for_each():
    inner = Statement(labels=("a", "b"), minimize="narrow(a)")
    stated = Statement(labels=("limb*",), minimize="narrow(limb*)", parts=(("limb*", inner),))
    assert Hierarchy.of(stated.with_parts(2)).labels == ("limb1/a", "limb1/b", "limb2/a", "limb2/b")


def test_an_open_statement_reads_back_as_it_was():
    stated = Statement(labels=("body", "leg*"), minimize="narrow(leg*)", search=Method(restarts=2))
    assert Statement.read(json.loads(json.dumps(stated.document()))) == stated
    recipe = Recipe(name="mine", statement=stated)
    assert parse_recipe(recipe.toml(), "mine") == recipe


@pytest.mark.parametrize(
    ("labels", "count", "message"),
    [
        (("a", "b"), 2, "the number of parts is fixed by the labels a, b; do not say how many"),
        (("a", "b*", "c"), 2, "2 parts are too few for the labels a, b*, c; give 3 or more"),
        (("part*",), 0, "0 parts are too few for the labels part*; give 1 or more"),
        (("a*", "b*"), 4, "one label may end with '*', not several: a*, b*"),
        (("a*", "a*"), 4, "label 'a*' is given twice"),
        (("*",), 4, "label '*' is not allowed"),
        (("a*b",), 4, "label 'a*b' is not allowed"),
        (("leg2*",), 4, "label 'leg2*' is not allowed"),  # leg21 would be what?
        (("a b", "c*"), 4, "label 'a b' is not allowed"),
    ],
)
def test_numbers_of_parts_that_cannot_be(labels, count, message):
    with pytest.raises(UsageError) as caught:
        Statement(labels=labels, minimize="f").with_parts(count)
    assert message in str(caught.value)


@pytest.mark.parametrize("labels", [["a"], ("leg1", "leg2"), ["3", "_", "E"], np.array(["x", "y"])])
def test_labels_keep_their_order(labels):
    assert check_label_names(labels) == tuple(labels)


@given(st.lists(st.text()))
def test_any_labels_are_taken_as_they_are_or_refused(labels):
    try:
        names = check_label_names(labels)
    except UsageError:
        return
    assert names == tuple(labels)
    assert len(set(names)) == len(names) > 0
    # Whatever is allowed as a label can be written in an expression.
    assert [argument.pattern for argument in parse(f"f({','.join(names)})").terms[0].arguments] == (
        labels
    )


def test_only_who_may_leave_it_open_does():
    assert check_label_names(["body", "leg*"], may_be_open=True) == ("body", "leg*")
    with pytest.raises(UsageError, match=r"'leg\*' stands for any number of parts.* --parts 5"):
        check_label_names(["body", "leg*"])
