"""Models found in a folder."""

import pytest
from moseg_benchmark.psb import CATEGORIES, category_of, check_category, find_models

from moseg_core import UsageError


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
