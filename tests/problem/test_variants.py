"""A statement with counts for one label set after the other: what is left out, what is an error."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.registry import registry
from moseg_core.errors import ExpressionError, UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import Recipe, parse_recipe
from moseg_core.problem.settings import Method
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants, closed_statements, parameterization_of

LABELS = ("body", "leg{1..2}", "tail{0..1}")


def stated(minimize="narrow(*)", **more) -> Statement:
    return Statement(labels=LABELS, minimize=minimize, **more)


def meaning(minimize, names):
    """What an expression becomes for a label set."""
    return closed_statements(stated(minimize), [names])[0].minimize


# --- expressions


@pytest.mark.parametrize(
    ("minimize", "names", "left"),
    [
        ("narrow(leg*) + flat(tail)", ("body", "leg1"), "narrow(leg*)"),
        ("flat(body) - 2*narrow(leg2)", ("body", "leg1"), "flat(body)"),
        ("narrow(leg1, leg2, tail)", ("body", "leg1", "tail"), "narrow(leg1, tail)"),
        ("flat(body) + similar(leg*)", ("body", "leg1"), "flat(body)"),
        ("flat(body) + similar(leg*)", ("body", "leg1", "leg2"), "flat(body) + similar(leg*)"),
        ("flat(body) + touching(body, tail)", ("body", "leg1"), "flat(body)"),
        ("touching(body, leg*, tail)", ("body", "leg1"), "touching(body, leg*)"),
        ("3*convex_parts + narrow(t*)", ("body", "leg1"), "3*convex_parts"),
        ("is(*, area=0.3+-0.1)", ("body", "leg1"), "is(*, area=0.3+-0.1)"),
    ],
)
def test_labels_that_are_not_there_are_left_out_of_calls(minimize, names, left):
    assert meaning(minimize, names) == left


def test_what_needs_no_change_stays_as_it_was_written():
    assert meaning("narrow( leg* )+flat(body)", ("body", "leg1")) == "narrow( leg* )+flat(body)"


@pytest.mark.parametrize(
    ("minimize", "message"),
    [
        ("narrow(tial)", "unknown label 'tial'"),
        ("narrow(leg3)", "unknown label 'leg3'"),
        ("narrow(wing*)", "'wing*' matches none of the labels body, leg1, leg2, tail"),
        ("narow(tail)", "unknown objective 'narow'"),
        ("flat(body) + similar(tail)", "'similar' takes"),
        ("convex_parts(tail)", "'convex_parts' takes"),
    ],
)
def test_mistakes_are_mistakes_in_every_label_set(minimize, message):
    with pytest.raises(ExpressionError) as caught:
        meaning(minimize, ("body", "leg1"))
    assert message in str(caught.value)
    assert f'in "{minimize}"' in str(caught.value)


def test_a_label_set_needs_something_to_minimise():
    with pytest.raises(UsageError, match=r"nothing is left to minimise for the labels body, leg1"):
        meaning("narrow(tail)", ("body", "leg1"))


# --- constraints, parts, parameters


@pytest.mark.parametrize(
    ("constraint", "left"),
    [
        ("mirror(leg2, leg1)", ()),
        ("on_plane(body, tail)", ("on_plane(body)",)),
        ("on_plane(tail)", ()),
        ("on_plane(t*)", ()),
        ("on_plane(leg*, plane=x)", ("on_plane(leg*, plane=x)",)),
        ("on_plane", ("on_plane",)),
    ],
)
def test_constraints_on_labels_that_are_not_there(constraint, left):
    closed = closed_statements(stated(constraints=(constraint,)), [("body", "leg1")])[0]
    assert closed.constraints == left


def test_an_unknown_label_of_a_constraint_is_an_error():
    with pytest.raises(ExpressionError, match="unknown label 'leg7'"):
        closed_statements(stated(constraints=("mirror(leg7, leg1)",)), [("body", "leg1")])


def test_parts_that_are_not_there_are_not_divided():
    inner = Statement(labels=("a{2}",), minimize="narrow(a*)")
    whole = stated(parts=(("leg*", inner), ("tail", inner)))
    tasks = Variants.of(whole).tasks
    assert tasks[0].labels == ("body", "leg1/a1", "leg1/a2")
    assert tasks[3].labels == (
        *("body", "leg1/a1", "leg1/a2", "leg2/a1", "leg2/a2"),
        *("tail/a1", "tail/a2"),
    )
    with pytest.raises(UsageError, match="parts: unknown label 'tial'"):
        Variants.of(stated(parts=(("tial", inner),)))


@pytest.mark.parametrize(
    ("centers", "left"),
    [
        ("body=3,tail=2", "body=3"),
        ("tail=2", None),
        ("leg*=2", "leg*=2"),
        ("t*=2,body=2", "body=2"),
        ("tial=2,body=2", "tial=2,body=2"),  # a mistake stays one
        ("auto", "auto"),
    ],
)
def test_parameters_about_labels_that_are_not_there(centers, left):
    chosen = Choice("voronoi", {"centers": centers})
    search = Method(parameterization=chosen)
    closed = closed_statements(stated(search=search), [("body", "leg1")])[0]
    kept = closed.search.parameterization
    assert (kept.parameters["centers"] if isinstance(kept, Choice) else None) == left
    other = Choice("voronoi", {"centers": centers, "connected": False})
    assert parameterization_of(
        other, ["body", "leg1"], ["body", "leg1", "leg2", "tail"], registry()
    ).parameters == {"connected": False, **({"centers": left} if left else {})}


# --- statements and recipes


def test_a_statement_without_counts_is_closed():
    plain = Statement(labels=("a", "b"), minimize="narrow(a)")
    assert closed_statements(plain)[0] is plain
    assert plain.label_sets() == (("a", "b"),)
    assert plain.written_out() is plain


def test_one_closed_statement_for_each_label_set():
    closed = closed_statements(stated(search=Method(restarts=2)))
    assert [one.labels for one in closed] == list(stated().label_sets())
    assert all(one.search == Method(restarts=2) and not one.has_counts for one in closed)
    only = stated(variants=(("body", "leg{2}"), ("body", "leg{1}", "tail")))
    assert [one.labels for one in closed_statements(only)] == [
        ("body", "leg1", "leg2"),
        ("body", "leg1", "tail"),
    ]


def test_a_statement_with_counts_reads_back_as_it_was():
    variants = (("body", "leg{2}"), ("body", "leg{4}", "tail"))
    follow = Statement(variants=variants, minimize="narrow(leg*)")
    assert "labels" not in follow.document()
    both = Statement(labels=("body", "leg{0..4}", "tail{0..1}"), variants=variants, minimize="f")
    assert both.document()["labels"] == ["body", "leg{0..4}", "tail{0..1}"]
    for one in (follow, both, stated()):
        assert Statement.read(json.loads(json.dumps(one.document()))) == one
        recipe = Recipe(name="mine", statement=one)
        assert parse_recipe(recipe.toml(), "mine") == recipe


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ('variants = ["a", "b"]', "'variants' must be a list of lists of texts; 'a' is none"),
        ("variants = 3", "'variants' must be a list of lists of texts; it is 3"),
        ('variants = [["a"], []]', "'variants': a problem needs at least one label"),
        ("variants = []", "'labels' must be a list of texts; it is missing"),
        ('variants = [["a"], ["a", "b!"]]', "label 'b!' is not allowed"),
        ('labels = ["a*", "b{2}"]', "labels have a star or counts, not both: a*, b{2}"),
        ('labels = ["a{2..1}"]', "'a{2..1}': a count goes from the least"),
        ('labels = ["a"]\nvariants = [["a", "b"]]', "variants: unknown label 'b'"),
        (
            'labels = ["a"]\n[parts.a]\nlabels = ["b{1..2}"]\nminimize = "narrow(b*)"',
            "recipe 'mine/a' leaves the number of parts open (b{1..2})",
        ),
    ],
)
def test_recipes_with_mistakes_in_counts(given, message):
    head, _, parts = given.partition("\n[")
    text = f'{head}\nminimize = "narrow(*)"\n' + (f"[{parts}" if parts else "")
    with pytest.raises(UsageError) as caught:
        parse_recipe(text, "mine")
    assert message in str(caught.value)


def test_a_recipe_divides_the_parts_that_it_names():
    recipe = parse_recipe(
        'labels = ["body", "leg{1..2}"]\nminimize = "narrow(*)"\n'
        '[parts."leg*"]\nlabels = ["a{2}"]\nminimize = "narrow(a*)"\n'
        '[parts.leg2]\nlabels = ["b", "c"]\nminimize = "narrow(b)"\n',
        "mine",
    )
    assert [task.labels for task in recipe.hierarchies()] == [
        ("body", "leg1/a1", "leg1/a2"),
        ("body", "leg1/a1", "leg1/a2", "leg2/b", "leg2/c"),
    ]


def test_several_label_sets_are_no_single_problem():
    for make in (Problem.of, Hierarchy.of):
        with pytest.raises(UsageError, match=r"stand for 4 label sets; try them all") as caught:
            make(stated())
        assert '--labels "body, leg{2}, tail"' in str(caught.value)
    alone = Statement(labels=("top", "leg{4}"), minimize="narrow(leg*)")
    assert Problem.of(alone).labels == ("top", "leg1", "leg2", "leg3", "leg4")
    with pytest.raises(UsageError, match=r"label 'leg\{4\}' has a count, which only"):
        Problem(["leg{4}"], "narrow(leg*)")
    with pytest.raises(UsageError, match="say which numbers of parts are tried"):
        stated().with_parts(3)


def test_the_recipes_of_the_page_are_recipes():
    page = (Path(__file__).parents[2] / "docs" / "variants.md").read_text()
    octopus, cow = re.findall(r"^```toml\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    assert len(parse_recipe(octopus, "octopus").hierarchies()) == 24
    cow = parse_recipe(
        cow + 'minimize = "is(torso, given=torso) + is(tail, given=tail)"\n'
        '[given.torso]\narea = "0.5+-0.1"\n[given.tail]\narea = "0.1+-0.05"\n',
        "cow",
    )
    assert [task.problem.statement.minimize for task in cow.hierarchies()] == [
        "is(torso, given=torso)",
        *["is(torso, given=torso) + is(tail, given=tail)"] * 2,
    ]
    assert parse_recipe(cow.toml(), "cow") == cow


# --- which of them


def test_texts_say_what_is_there_and_what_differs():
    variants = Variants.of(stated())
    assert variants.texts[:2] == ("body, leg{1}", "body, leg{1}, tail")
    assert variants.short_texts == (
        "leg{1}, no tail",
        "leg{1}, tail",
        "leg{2}, no tail",
        "leg{2}, tail",
    )
    assert Variants.of(stated(), [("body", "leg1")]).short_texts == ("body, leg{1}",)


def test_label_sets_that_have_certain_labels():
    variants = Variants.of(stated())
    assert variants.having(["tail"], "--pin").texts == ("body, leg{1}, tail", "body, leg{2}, tail")
    assert variants.having(["body", "leg1"], "--start", exactly=True).texts == ("body, leg{1}",)
    with pytest.raises(UsageError, match="--pin: unknown label 'tial'; did you mean 'tail'"):
        variants.having(["tial"], "--pin")
    with pytest.raises(UsageError, match="--start: no label set has just the labels body; there"):
        variants.having(["body"], "--start", exactly=True)


def test_the_label_set_that_fits_a_labelling():
    only = stated(variants=(("body", "leg{1}", "tail"), ("body", "leg{2}")))
    variants = Variants.of(only)
    assert variants.fitting(["leg1", "body", "tail"]) is variants.tasks[0]
    assert variants.fitting(["leg2"]) is variants.tasks[1]  # a part may have been lost
    assert variants.fitting(["tail", "leg2", "body"]).labels == ("body", "leg2", "tail")
    with pytest.raises(UsageError, match="unknown label 'tial'"):
        variants.fitting(["body", "tial"])
