"""``moseg benchmark psb``: what its words mean, and what is refused before any work."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from moseg_benchmark.command import USUAL_RECIPES, read_lessons, read_recipes, read_seeds

from moseg_core import UsageError
from moseg_core.cli import main


def call(capsys, *words):
    with pytest.raises(SystemExit) as end:
        main(["benchmark", *map(str, words)])
    return end.value.code, *capsys.readouterr()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--category", "Fourlegs"), "unknown category 'Fourlegs'; did you mean 'Fourleg'"),
        (("--recipe-for", "Cup"), "write --recipe-for Fourleg=fourleg"),
        (("--recipe-for", "Cup=hamer"), "did you mean"),
        (("--recipe-for", "Cup=any_shape"), "leaves the number of parts open (part*)"),
        (("--recipe-for", "Cup=hammer", "--recipe-for", "cup=paper_horse"), "two recipes for Cup"),
        (("--category", "Ant", "--recipe-for", "Cup=hammer"), "asks for Ant only"),
        (("--settings", "papers"), "unknown settings 'papers'; did you mean 'paper'"),
        (("--seeds", "2-0"), "the seeds '2-0' are not understood; write 0-2"),
        (("--workers", "0"), "at least one worker"),
        (("--learn", "--examples", "few"), "the numbers of examples 'few' are not understood"),
        (("--learn", "--examples", "0"), "write 1,2,all"),
        (("--learn", "--learner", "profile"), "did you mean 'profiles'"),
        (("--examples", "1"), "ask for it with --learn"),
        (("--train", "."), "--train DIR to learn from"),
    ],
)
def test_malformed_requests_are_refused_before_any_work(psb, tmp_path, capsys, words, message):
    code, _, err = call(capsys, "psb", "--data", psb, "-o", tmp_path / "r", *words)
    assert code == 2
    assert message in err
    assert not (tmp_path / "r").exists()


def test_a_recipe_with_an_unknown_component_is_refused(psb, tmp_path, capsys):
    recipe = tmp_path / "odd.toml"
    recipe.write_text((psb / "capsule.toml").read_text() + 'seeder = "kmean"\n')
    words = ("--recipe-for", f"Cup={recipe}", "-o", tmp_path / "r")
    code, _, err = call(capsys, "psb", "--data", psb, *words)
    assert code == 2
    assert "unknown seeder 'kmean'; did you mean 'kmeans'" in err
    assert not (tmp_path / "r").exists()


def test_folders_are_checked(psb, tmp_path, capsys):
    code, _, err = call(capsys, "psb", "--data", psb, "-o", tmp_path / "no" / "r")
    assert code == 2
    assert "there is no folder" in err
    (tmp_path / "file").write_text("")
    code, _, err = call(capsys, "psb", "--data", psb, "-o", tmp_path / "file")
    assert code == 2
    assert "is a file; the report needs a folder" in err
    code, _, err = call(capsys, "psb", "--data", tmp_path, "-o", tmp_path / "r")
    assert code == 2
    assert "does not hold the benchmark" in err


def test_seeds_and_recipes_are_read():
    assert read_seeds("3,0-1,1") == [3, 0, 1]
    assert read_recipes(["fourleg = paper_horse"])["Fourleg"].name == "paper_horse"
    assert read_recipes(["none"]) == {}
    assert len(read_recipes(["usual"])) == len(USUAL_RECIPES)
    with pytest.raises(UsageError, match="'--recipe-for none' is not understood"):
        read_recipes(["none", "Cup=cup"])
    with pytest.raises(UsageError, match="write 0-2 or 0,5,7"):
        read_seeds("all")


def test_two_folders_need_each_other(psb, tmp_path, capsys):
    for words in ((), ("--test", psb), ("--data", psb, "--train", psb, "--test", psb)):
        code, _, err = call(capsys, "psb", "-o", tmp_path / "r", *words)
        assert code == 2
        assert "--data DIR, or in two, --train DIR to learn from" in err


def test_lessons_are_read(psb):
    lessons = read_lessons("2, all,2", "profiles(separate=5)", psb, ("Cup",))
    assert lessons.examples == (2, None)
    assert lessons.methods == ("learned 2", "learned")
    assert [model.number for model in lessons.teachers] == [21, 25]
    assert read_lessons("all", "profiles", None, ()).teachers is None


def test_help_lists_collections_and_options(capsys):
    code, out, _ = call(capsys, "--help")
    assert code == 0
    assert "psb" in out
    code, out, _ = call(capsys, "psb", "--help")
    assert code == 0
    assert "--recipe-for" in out


def test_an_unknown_collection_suggests(capsys):
    code, _, err = call(capsys, "psbs")
    assert code == 2
    assert 'Did you mean "psb"' in err


def test_asking_for_help_loads_no_numerical_library():
    code = (
        "import atexit, json, sys; atexit.register(lambda: print(json.dumps(sorted(sys.modules))));"
        "from moseg_core.cli import main; main(['benchmark', 'psb', '--help'])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in json.loads(run.stdout.splitlines()[-1])}
    assert "moseg_benchmark" in loaded
    assert not loaded & {"numpy", "scipy", "igl", "numba", "trimesh", "PIL"}
