from __future__ import annotations

import json
import subprocess
import sys
from importlib.resources import files

import pytest
from moseg_recipes_shapes import plugin, recipes

from moseg_core import registry


def test_nothing_heavy_is_imported():
    code = (
        "import sys, json, moseg_recipes_shapes.plugin as p;"
        "p.moseg_recipes();"
        "print(json.dumps(sorted(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = json.loads(run.stdout)
    assert "moseg_recipes_shapes.plugin" in loaded
    assert "moseg_recipes_shapes.recipes" not in loaded
    assert not {name.partition(".")[0] for name in loaded} & {"numpy", "scipy", "numba", "trimesh"}


def test_bundle_is_found_whole():
    bundle = next(b for b in registry().bundles if b.name == "shapes")
    assert bundle.problem is None
    assert {c.spec for c in bundle.components} == set(plugin.moseg_recipes())
    for component in bundle.components:
        assert isinstance(component.load(), str)
        assert component.spec.summary


def test_every_file_is_a_recipe_of_the_bundle():
    names = {file.name for file in files(recipes).iterdir() if file.name.endswith(".toml")}
    assert names == {f"{name}.toml" for name in plugin.RECIPES}


def test_a_text_is_had_by_the_name_of_its_recipe():
    assert files(recipes).joinpath("bird.toml").read_text() == recipes.BIRD
    for name in ("bird", "UNICORN"):
        with pytest.raises(AttributeError, match=f"has no recipe '{name}'"):
            getattr(recipes, name)


@pytest.mark.parametrize("name", plugin.RECIPES)
def test_a_plain_name_means_the_learned_recipe(name):
    assert registry().find("recipe", name).id == f"shapes:{name}"
