"""``moseg learn``: what its words mean, what is refused before any work, what it prints."""

from __future__ import annotations

import pytest
from moseg_learn import left_out
from moseg_learn.left_out import LeftOut

from moseg_core import load_recipe, save_labels
from moseg_core.cli import main


def call(capsys, *words):
    with pytest.raises(SystemExit) as end:
        main(["learn", *map(str, words)])
    return end.value.code or 0, *capsys.readouterr()


@pytest.fixture(scope="module")
def files(herd, tmp_path_factory):
    """Words for the examples, as files."""
    folder, words = tmp_path_factory.mktemp("herd"), []
    for example in herd:
        name = example.shape.name
        example_mesh(example).export(folder / f"{name}.off")
        save_labels(example.labels, folder / f"{name}_labels.txt", names=example.names)
        words.append(f"{folder}/{name}.off={folder}/{name}_labels.txt")
    return words


def example_mesh(example):
    import trimesh

    geometry = example.shape.geometry
    return trimesh.Trimesh(geometry.vertices, geometry.triangles, process=False)


def test_a_recipe_is_written_and_what_was_read_is_said(files, tmp_path, capsys):
    out = tmp_path / "beast.toml"
    code, shown, said = call(capsys, *files[:2], "--learner", "profiles(likely=0)", "-o", out)
    assert (code, shown) == (0, "")
    assert "body, head, leg" in said
    assert f"wrote {out}" in said
    recipe = load_recipe(str(out))
    assert recipe.labels == ("body", "head", "leg1", "leg2", "leg3")
    assert len(recipe.learned_from) == 2
    assert recipe.hierarchies()


def test_without_a_file_the_recipe_is_printed(files, capsys):
    code, shown, said = call(capsys, files[0], "--learner", "profiles(likely=0)", "--quiet")
    assert (code, said) == (0, "")
    assert 'labels = ["body", "head", "leg1", "leg2", "leg3"]' in shown


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "there is nothing to learn from"),
        (("a.off",), "example 'a.off' has no labels"),
        (("a.off=a.txt", "a.off=a.txt"), "'a.off=a.txt' is given twice"),
        (("a.off=a.txt", "--check"), "needs two or more"),
        (("a.off=a.txt", "-o", "x.json"), "to a .toml file"),
        (("a.off=a.txt", "-o", "nowhere/x.toml"), "there is no folder 'nowhere'"),
        (("a.off=a.txt",), "there is no file 'a.off'"),
        (("a.off=a.txt", "--workers", "0"), "at least one worker"),
    ],
)
def test_malformed_requests_are_refused_before_any_work(capsys, words, message):
    code, shown, said = call(capsys, *words)
    assert code in (1, 2)
    assert message in said
    assert shown == ""


@pytest.mark.parametrize(
    ("learner", "message"),
    [("profile", "did you mean 'profiles'"), ("profiles(likly=2)", "did you mean 'likely'")],
)
def test_an_unknown_learner_is_refused(files, capsys, learner, message):
    code, _, said = call(capsys, files[0], "--learner", learner)
    assert code == 2
    assert message in said


def test_check_prints_a_row_for_each_example_and_the_mean(files, capsys, monkeypatch):
    def tried(example, recipe, numbers, seed, report):
        return LeftOut(
            name=example.shape.name, rand_index_error=0.1, named_right=0.9, cost=2.0, own_cost=3.0
        )

    monkeypatch.setattr(left_out, "_tried", tried)
    words = (*files[:2], "--check", "--learner", "profiles(likely=0)", "--workers", "1")
    code, shown, said = call(capsys, *words)
    assert code == 0
    rows = [line.split() for line in shown.splitlines()]
    assert rows[1] == ["one", "0.100", "90.0", "%", "2", "3"]
    assert rows[-1] == ["mean", "0.100", "90.0", "%"]
    assert "[2/2] without two, 90 % named right" in said
