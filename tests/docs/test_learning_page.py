"""The walk in ``docs/learning.md``, command by command, as it is written."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import moseg_core as moseg
from moseg_core.agreement import named_right
from moseg_core.cli import main

PAGE = Path(__file__).parents[2] / "docs" / "learning.md"


def commands():
    """The indented lines that begin with ``moseg``, those that go on joined."""
    text = re.sub(r" \\\n +", " ", PAGE.read_text())
    return [line.strip().split(" ", 1)[1] for line in re.findall(r"^    moseg .*$", text, re.M)]


def words(command):
    import shlex

    return shlex.split(command)


def test_the_page_has_the_whole_walk():
    verbs = [command.split()[0] for command in commands()]
    assert verbs.count("learn") >= 3
    assert verbs[-1] == "explain"


@pytest.mark.slow
def test_the_walk_can_be_walked(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shown = {}
    for command in commands():
        with pytest.raises(SystemExit) as end:
            main([*words(command)])
        shown[command] = capsys.readouterr().out
        assert not end.value.code, command
    recipe = moseg.load_recipe("fourleg.toml")
    assert len(recipe.learned_from) == 2
    assert "leg*" in recipe.minimize
    dog = moseg.load("bulldog.ply")
    found = moseg.read_labels("bulldog.json", dog.n_elements)
    truth = moseg.read_labels(moseg.sample_labels_path("bulldog"), dog.n_elements)
    right = named_right(found.labels, found.names, truth.labels, truth.names, dog.areas)
    assert right > 0.6
    checked = next(text for command, text in shown.items() if command.endswith("--check"))
    assert [line.split()[0] for line in checked.splitlines()[1:]] == ["horse", "bulldog", "mean"]
    assert "typical" in shown["explain bulldog.json"]


def test_every_measure_and_key_is_explained(capsys):
    text = PAGE.read_text()
    recipe_keys = ("learned_from", "labels", "variants", "parameterization", "seeder", "restarts")
    names = moseg.Segmentation.from_labels(*_halves(), 2).parts[0].measure("basic:likeness")._fields
    for name in (*recipe_keys, *names):
        assert f"`{name}`" in text, name


def _halves():
    shape = moseg.load(moseg.sample_path("hammer"))
    return shape, (shape.points[:, 0] > 0).astype(int)
