from __future__ import annotations

import numpy as np
import pytest

from moseg_core import Example, Shape, UsageError, learn, segment_variants
from moseg_core.agreement import named_right, rand_index_error


def test_a_recipe_says_what_was_learned_and_from_what(recipe):
    stated = recipe.statement
    assert recipe.learned_from == (
        "one: body, head, 3 leg",
        "three: body, head, 3 leg, tail",
        "two: body, head, 3 leg",
    )
    assert stated.variants == (
        ("body", "head", "leg{3}"),
        ("body", "head", "leg{3}", "tail"),
    )
    assert set(stated.given) == {"body", "head", "leg", "tail", "looks"}
    assert set(stated.given["looks"]) == {"body", "head", "leg", "tail"}
    for term in (
        "is(leg*, given=leg)",
        "0.5*likely(leg*, kind=leg, among=looks)",
        "touching(body, head, leg*)",
        "separate_parts",
    ):
        assert term in stated.minimize


@pytest.mark.slow
def test_another_of_the_kind_is_cut_as_it_should_be(recipe, make):
    # Longer than any of the examples, and seen from elsewhere.
    other = make.beast(stretch=1.35, tail=True, name="four")
    result = segment_variants(
        other.shape, recipe, seeder="sized_evolution(population=30, generations=12)", resolution=400
    )
    assert rand_index_error(result.labels.astype("int64"), other.labels) < 0.1
    right = named_right(
        result.labels.astype("int64"),
        result.problem.labels,
        other.labels,
        other.names,
        other.shape.areas,
    )
    assert right > 0.9
    assert "tail" in result.problem.labels


def test_terms_can_be_left_out_and_weighed(herd):
    plain = learn(herd[:1], learner="profiles(separate=0, likely=0, touching=0, apart=0)")
    assert plain.statement.minimize == (
        "is(body, given=body) + is(head, given=head) + is(leg*, given=leg)"
    )
    assert "looks" not in plain.statement.given
    assert plain.statement.labels == ("body", "head", "leg1", "leg2", "leg3")
    heavy = learn(
        herd[:1], learner='profiles(separate=7, likely=0, touching=3, apart=0, refiner="graph_cut")'
    )
    # Three legs touch the body; of body and head there is one pair, which makes no rule.
    assert "+ 9*touching(body, leg*) + 7*separate_parts" in heavy.statement.minimize
    assert heavy.statement.search.refiner.name == "graph_cut"


def test_numbers_tell_kinds_apart_where_that_is_asked_for(herd):
    first = herd[0]
    names = ("body", "head1", "leg", "tail")
    apart = learn(
        [Example(first.shape, first.labels, names)],
        learner="profiles(numbers=different, likely=0)",
    )
    assert "head1" in apart.statement.labels
    assert "head1" in apart.statement.given
    with pytest.raises(UsageError, match="did you mean 'different'"):
        learn(herd[:1], learner="profiles(numbers=diferent)")


def test_a_kind_may_be_called_looks(herd):
    first = herd[0]
    named = Example(first.shape, first.labels, ("looks", "head", "leg", "tail"))
    found = learn([named])
    assert set(found.statement.given["looks"]) >= {"area", "crease"}
    assert set(found.statement.given["looks_"]) == {"looks", "head", "leg"}
    assert found.hierarchies()


def test_clouds_are_learned_from_by_what_they_tell():
    x, y = np.meshgrid(np.linspace(0, 3, 30), np.linspace(0, 1, 10))
    points = np.stack([x, y, 0.1 * np.sin(3 * x) * y], axis=-1).reshape(-1, 3)
    cloud = Shape.from_points(points, name="cloud", adjacency="knn")
    labels = np.digitize(points[:, 0], [1, 2])
    found = learn([Example(cloud, labels, ("a", "b", "c"))])
    assert "likely" not in found.statement.minimize
    assert "thickness" not in found.statement.given["a"]
    assert found.statement.minimize.endswith(" + 10*short_boundaries")
    assert found.hierarchies()


def test_what_is_learned_of_a_solid_can_be_searched_on_a_solid():
    solid = Shape.from_voxels(np.ones((9, 3, 2), bool), pitch=(1.0, 1.0, 2.0), name="solid")
    labels = np.digitize(solid.points[:, 0], [6.0])
    found = learn([Example(solid, labels, ("long", "short"))])
    assert "separate" not in found.statement.minimize
    for task in found.hierarchies():
        task.check(solid)


def test_examples_of_one_part_show_too_little(herd, make):
    whole = make.beast(name="whole")
    whole = Example(whole.shape, np.zeros_like(whole.labels), ("body",))
    with pytest.raises(UsageError, match="'whole' is one part, body"):
        learn([whole])
    recipe = learn([herd[0], whole])
    alone = learn([herd[0]])
    assert recipe.statement == alone.statement
    assert recipe.learned_from[1] == "whole: body (not learned from: one part)"


@pytest.mark.slow
def test_places_move_boundaries_where_it_is_known_how_surely(herd, recipe):
    assert str(learn(herd[:1]).statement.search.refiner) == "graph_cut(band=0.2)"
    assert str(recipe.statement.search.refiner) == "graph_cut(band=0.4, data=4)"
    full = learn(herd, learner="profiles(likely=1)")
    assert str(full.statement.search.refiner) == "graph_cut(band=0.4, data=2)"
    alone = learn(herd, learner="profiles(likely=0)")
    assert str(alone.statement.search.refiner) == "graph_cut(band=0.2)"
    unrefined = learn(herd, learner="profiles(refiner=none)").statement.search
    assert unrefined.refiner is None
    # What no refiner moves is polished, and of what one moves one result where there is time.
    assert recipe.statement.variants
    assert (recipe.statement.search.polished, unrefined.polished) == (0, None)
    assert learn(herd[:1]).statement.search.polished == 1


def test_examples_may_be_labelled_in_part(herd):
    """A recipe of examples with a few faces left out is nearly that of the whole ones."""
    partly = [
        Example(e.shape, np.where(np.arange(len(e.labels)) % 50 == 7, -1, e.labels), e.names)
        for e in herd
    ]
    whole, some = (learn(each, learner="profiles(likely=0)") for each in (herd, partly))
    assert some.labels == whole.labels
    assert some.statement.minimize == whole.statement.minimize
    for kind in ("body", "leg", "head"):
        there, here = (recipe.statement.given.document()[kind] for recipe in (whole, some))
        assert there.keys() == here.keys()
