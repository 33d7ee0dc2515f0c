"""Models found in a folder."""

import pytest
from moseg_benchmark.command import USUAL_RECIPES, read_recipes
from moseg_benchmark.label_matching import Naming
from moseg_benchmark.psb import CATEGORIES, NAMINGS, category_of, check_category, find_models

from moseg_core import UsageError, load_recipe
from moseg_core.agreement import fold


def test_categories_are_blocks_of_twenty_ids():
    assert len(CATEGORIES) == 19
    firsts = {1: "Human", 21: "Cup", 241: "Bird", 281: "Armadillo", 361: "Vase", 381: "Fourleg"}
    for first, name in firsts.items():
        assert {category_of(first + k) for k in range(20)} == {name}
    assert {category_of(k) for k in (0, -3, 261, 280, 401)} == {""}


def test_models_come_by_id_with_what_people_say(psb):
    models = find_models(psb)
    assert [model.number for model in models] == [21, 25, 381]
    assert [len(model.people) for model in models] == [3, 2, 0]
    assert models[0].people[1].name == "21_1.seg"
    assert [model.names is None for model in models] == [False, False, True]
    assert [model.number for model in find_models(psb, ("Fourleg",))] == [381]


def test_the_original_layout_will_do_too(psb, tmp_path):
    (tmp_path / "seg").mkdir()
    (tmp_path / "off").symlink_to(psb / "off")
    (tmp_path / "seg" / "Benchmark").symlink_to(psb / "seg")
    assert [len(model.people) for model in find_models(tmp_path)] == [3, 2, 0]


def test_errors_say_what_is_missing(psb, tmp_path):
    with pytest.raises(UsageError, match=r"no folder 'off' in it, which should have <id>\.off"):
        find_models(tmp_path)
    with pytest.raises(UsageError, match="there are no models of Ant in"):
        find_models(psb, ("Ant",))
    with pytest.raises(UsageError, match="unknown category 'Fourlegs'; did you mean 'Fourleg'"):
        check_category("Fourlegs")
    assert check_category(" octopus") == "Octopus"


# The names that Kalogerakis et al. give to the parts of a category.
NAMES = {
    "Bird": "body head leg tail wing",
    "Chair": "arm backsupport leg support",
    "Cup": "body handle",
    "Fourleg": "earhorn head leg neck tail torso",
    "Hand": "finger1 finger2 finger3 finger4 hand thumb",
    "Octopus": "body leg",
    "Table": "leg support",
}
PRINTED = {"Bird": ["dove"], "Fourleg": ["horse", "bulldog"], "Octopus": ["octopus"]}


@pytest.mark.parametrize("category", NAMES)
def test_recipes_have_a_label_for_every_name_and_a_name_for_every_label(category):
    usual = read_recipes(USUAL_RECIPES)[category].name
    assert usual == f"words_{category.lower()}"
    for name in [usual, *(f"paper_{name}" for name in PRINTED.get(category, []))]:
        labels = load_recipe(name).labels
        naming = NAMINGS.get(category, Naming())
        found = {naming.kind(part, labels) for part in NAMES[category].split()}
        assert found == {fold(label) for label in labels}


def test_every_usual_recipe_is_for_a_category_with_names():
    assert set(read_recipes(USUAL_RECIPES)) == set(NAMES)
    assert set(NAMINGS) <= set(CATEGORIES)


def test_what_a_recipe_has_no_label_for_counts_as_what_it_hangs_on():
    fourleg = NAMINGS["Fourleg"]
    labels = load_recipe("words_fourleg").labels
    assert [fourleg.kind(name, labels) for name in ("tail", "earhorn", "neck")] == [
        *("body", "head", "neck"),
    ]
    assert fourleg.kind("neck", load_recipe("paper_horse").labels) == "head"


def test_only_models_with_several_named_parts_teach(members):
    teaching = {model.number: model.teaches for model in find_models(members)}
    assert teaching == {21: True, 22: True, 23: True, 24: True, 25: False, 26: False}
