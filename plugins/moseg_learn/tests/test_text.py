from __future__ import annotations

import re

from moseg_learn.text import annotated

from moseg_core import load_recipe


def test_comments_change_nothing_of_the_recipe(recipe, tmp_path):
    text = annotated(recipe)
    (tmp_path / "learned.toml").write_text(text)
    assert load_recipe(str(tmp_path / "learned.toml")) == recipe
    assert recipe.toml() == "".join(
        line for line in _without_legends(text).splitlines(keepends=True)
    )


def _without_legends(text):
    """Without comments, and the empty lines behind those of the tables."""
    return re.sub(r"^(#.*\n)+(\n(?=\[given))?|^#.*\n", "", text, flags=re.MULTILINE).replace(
        "\n\n\n", "\n\n"
    )


def test_every_measure_and_objective_that_is_used_is_explained(recipe):
    text = annotated(recipe)
    comments = " ".join(line for line in text.splitlines() if line.startswith("#"))
    for measure in recipe.statement.given["leg"]:
        assert re.search(rf"\b{measure}\b", comments), measure
    for objective in re.findall(r"([a-z_]+)\(|separate_parts", recipe.statement.minimize):
        assert objective in comments


def test_each_legend_is_given_once_and_before_the_first_table(recipe):
    lines = annotated(recipe).splitlines()
    profiles = [k for k, line in enumerate(lines) if line.startswith("# What each kind of part")]
    looks = [k for k, line in enumerate(lines) if line.startswith("# What single places on each")]
    assert len(profiles) == len(looks) == 1
    assert profiles[0] < lines.index("[given.body]") < looks[0] < lines.index("[given.looks.body]")


def test_a_plain_recipe_is_left_as_it_is_where_nothing_needs_saying():
    text = annotated(load_recipe("hammer"))
    assert "remoteness" not in text
    assert "looks" not in [line.split()[0] for line in text.splitlines() if line]
