"""Weights and centres that were moved, and the search that goes on from them."""

from __future__ import annotations

import numpy as np
import pytest

import moseg_core as moseg
from moseg_core.components.protocols import never_stop
from moseg_core.errors import UsageError
from moseg_core.problem.recipe import Recipe
from moseg_core.tune.session import Session, Wish
from tests.shapes import tee


@pytest.mark.parametrize(
    ("document", "why"),
    [
        ([], "a wish is an object"),
        ({"weigths": [1]}, "did you mean 'weights'"),
        ({}, "'weights' are numbers"),
        ({"weights": [True]}, "'weights' are numbers"),
        ({"weights": [float("nan")]}, "'weights' are numbers"),
        ({"weights": [1e7]}, "'weights' are numbers"),
        ({"weights": [1], "moved": ["bar"]}, "'moved'"),
        ({"weights": [1], "moved": {"bar": 1.0}}, "'moved'"),
        ({"weights": [1], "moved": {"bar": True}}, "'moved'"),
        ({"weights": [1], "anew": 1}, "'anew' is true or false"),
    ],
)
def test_a_wish_of_another_kind_is_refused(document, why):
    with pytest.raises(UsageError, match=why):
        Wish.read(document)


def test_a_search_has_the_weights_that_were_asked_for(session):
    before = session.result
    result = session.search(Wish(weights=(3.0, 0.5, 1.0)), never_stop)
    assert [term.weight for term in result.evaluation.terms] == [3.0, 0.5, 1.0]
    assert session.result is result is not before
    assert session.recipe().statement.minimize == "3*narrow(stem) + 0.5*narrow(bar) + convex_parts"


def test_going_on_is_a_search_from_the_present_centres(session):
    wish = Wish(weights=session.weights)
    kept = session.result
    again = session.search(wish, never_stop)
    assert again.cost <= kept.cost
    anew = session.search(Wish(weights=wish.weights, anew=True), never_stop)
    seeded = [bool(result.history["seeding"]) for result in (kept, again, anew)]
    assert seeded == [True, False, True]


def test_a_weight_of_nothing_leaves_the_term_out(session):
    result = session.search(Wish(weights=(1.0, 0.0, 1.0)), never_stop)
    assert [term.text for term in result.evaluation.terms] == ["narrow(stem)", "convex_parts"]
    assert len(session.terms) == 3
    with pytest.raises(UsageError, match="every term has weight 0"):
        session.search(Wish(weights=(0.0, 0.0, 0.0)), never_stop)
    with pytest.raises(UsageError, match="2 weights for 3 terms"):
        session.recipe((1.0, 2.0))


def test_the_recipe_of_its_author_keeps_its_spelling(session):
    assert session.recipe() is session.recipe((1.0, 2.0, 1.0))


def test_a_centre_that_is_held_stays_at_its_element(session):
    element = int(np.argmax(session.shape.points[:, 0]))
    wish = Wish(weights=session.weights, moved={"bar": element}, hold=True)
    result = session.search(wish, never_stop)
    bar = result.problem.labels.index("bar")
    np.testing.assert_allclose(
        result.centers.positions[bar], session.shape.points[element], atol=1e-12
    )


@pytest.mark.parametrize(
    ("moved", "why"),
    [({"bra": 0}, "did you mean 'bar'"), ({"bar": 10**6}, "there is no face"), ({"bar": -1}, "no")],
)
def test_what_cannot_be_moved_leaves_the_result_as_it_is(session, moved, why):
    before = session.result
    with pytest.raises(UsageError, match=why):
        session.search(Wish(weights=(9.0, 9.0, 9.0), moved=moved), never_stop)
    assert session.result is before
    assert session.weights == (1.0, 2.0, 1.0)


def test_only_label_sets_that_may_be_chosen_are_tried():
    statement = moseg.Statement(
        labels=("stem", "bar{1..2}"), minimize="narrow(stem) + compact(bar*)"
    )
    options = moseg.SearchOptions(restarts=1, optimizer="pattern_search(max_evaluations=10)")
    shape = moseg.Shape.from_mesh(*tee(), name="tee")
    recipe = Recipe(name="tee", statement=statement)
    session = Session(shape, recipe, options, sets=[("stem", "bar1", "bar2")])
    result = session.search(Wish(weights=session.weights), never_stop)
    assert result.problem.labels == ("stem", "bar1", "bar2")


def test_a_step_can_be_taken_back(session):
    before = session.result
    session.search(Wish(weights=(3.0, 0.5, 1.0)), never_stop)
    assert session.back() is before
    assert session.weights == (1.0, 2.0, 1.0)
    with pytest.raises(UsageError, match="the first result"):
        session.back()
