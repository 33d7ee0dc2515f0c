"""Instructions are the same after they were sent, and wrong ones are refused before."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from moseg_core.batching.instructions import EarlierResult, Instructions
from moseg_core.builtin.kmeans import KMeans
from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.registry import registry
from moseg_core.errors import UsageError
from moseg_core.io.part_files import PartForm
from moseg_core.io.reading import Reading
from moseg_core.problem.recipe import load_recipe
from moseg_core.problem.settings import CHOSEN_KINDS, Method, SearchOptions
from moseg_core.problem.statement import Statement

PLAIN = Instructions(statement=Statement(labels=("a", "b"), minimize="narrow(a)"))
COUNTED = Statement(labels=("top", "leg{3..4}"), minimize="flat(top) + narrow(leg*)")
FULL = Instructions(
    statement=replace(COUNTED, search=Method(optimizer="pattern_search(expansion=2)")),
    sets=(("top", "leg1", "leg2", "leg3"),),
    options=SearchOptions(
        seed=4, seeder="evolution(population=9)", resolution="full", ignore_pieces_below="0.1%"
    ),
    reading=Reading(up="-z", pitch=(1.0, 1.0, 3.0), weld=0.0, volume="hull"),
    clip=True,
    form=PartForm(hulls=True, hull_vertices=12),
    start_from=EarlierResult(path="/a.json", digest="0f"),
    term_timeout=2.5,
)


@pytest.mark.parametrize("given", [PLAIN, FULL, replace(PLAIN, n_parts="auto")])
def test_there_and_back(given):
    again = Instructions.read(json.loads(given.text()))
    assert again == given
    assert again.text() == given.text()


def test_all_recipes_are_sent_whole_and_as_they_are_written():
    for component in registry().components("recipe"):
        given = load_recipe(component.id).statement
        again = Instructions.read(json.loads(Instructions(statement=given).text())).statement
        assert again == given
        assert chosen(again) == chosen(given)


def chosen(statement):
    """What the components of all levels are, as results tell it: in the order of writing."""
    return [
        str(getattr(level.search, kind)) for _, level in statement.levels() for kind in CHOSEN_KINDS
    ]


def test_parameters_keep_their_order_and_kind():
    """A result tells them as they were given, so that its bytes depend on that."""
    given = Method(seeder={"name": "sized_evolution", "population": 9, "generations": 2})
    sent = Instructions(statement=replace(PLAIN.statement, search=given))
    again = Instructions.read(json.loads(sent.text()))
    for found in (again.statement.search.seeder, again.options.over(given).seeder):
        assert list(found.parameters.items()) == [("population", 9), ("generations", 2)]
        assert isinstance(found.parameters["population"], int)
    inner = replace(sent.statement, parts=(("a", sent.statement),))
    below = Instructions.read(json.loads(Instructions(statement=inner).text())).statement
    assert str(below.parts[0][1].search.seeder) == "sized_evolution(population=9, generations=2)"
    listed = replace(PLAIN, options=SearchOptions(seeder=Choice("kmeans", {"x": [1, 2]})))
    assert Instructions.read(json.loads(listed.text())).options.seeder.parameters == {"x": [1, 2]}


def test_processes_of_one_search_are_no_instruction():
    several = replace(PLAIN, options=SearchOptions(workers=7))
    assert several.text() == PLAIN.text()


def test_counts_and_numbers_of_parts_are_problems_each():
    counted = Instructions(statement=COUNTED)
    assert [len(task.labels) for task in counted.problems()] == [4, 5]
    assert [len(task.labels) for task in replace(counted, sets=FULL.sets).problems()] == [4]
    numbered = Instructions(statement=load_recipe("any_shape").statement, n_parts=3)
    assert [len(task.labels) for task in numbered.problems()] == [3]
    numbered.check()
    counted.check()


def test_components_are_told_with_their_versions():
    found = PLAIN.components()
    assert found["basic:narrow"].startswith("moseg-objectives-basic ")
    assert found["core:pattern_search"].startswith("moseg-core ")
    other = replace(PLAIN, options=SearchOptions(seeder="evolution")).components()
    assert "core:evolution" in other
    assert "core:kmeans" not in other


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"statement": Statement(labels=("a",), minimize="narow(a)")}, "did you mean 'narrow'"),
        ({"options": SearchOptions(seeder="kmean")}, "did you mean 'kmeans'"),
        ({"n_parts": 3}, "number of parts is fixed"),
        ({"options": SearchOptions(seeder=Choice("KMeans", {}, KMeans))}, "is not installed"),
        (
            {"clip": True, "options": SearchOptions(refiner="graph_cut")},
            "cannot be clipped",
        ),
    ],
)
def test_what_is_wrong_with_every_shape_is_refused(change, said):
    with pytest.raises(UsageError, match=said):
        replace(PLAIN, **change).check()


def test_an_earlier_result_is_itself_and_no_other(tmp_path):
    path = tmp_path / "a.json"
    path.write_text("{}")
    earlier = EarlierResult.at(path)
    assert earlier.path == str(path)
    with pytest.raises(UsageError, match="is not a moseg result"):
        replace(PLAIN, start_from=earlier).check()
    path.write_text("{ }")
    with pytest.raises(UsageError, match="has changed since the batch began"):
        replace(PLAIN, start_from=earlier).check()
    with pytest.raises(UsageError, match="--start-from speaks of single labels"):
        replace(PLAIN, start_from=earlier, n_parts=3).check()
    with pytest.raises(UsageError, match="it must be more than 0"):
        replace(PLAIN, term_timeout=0.0).check()
