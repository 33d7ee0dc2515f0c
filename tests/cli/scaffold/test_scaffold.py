"""What is written for a new bundle: files that are in order, under the names that were chosen."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from typing import get_args, get_type_hints

import pytest

from moseg_core.cli.plugin_app import new_plugin
from moseg_core.cli.scaffold import SKETCHES, render, words, write_bundle
from moseg_core.components.discovery.contract import VERSION
from moseg_core.components.discovery.hookspecs import HOOKS
from moseg_core.components.discovery.specs import Kind
from moseg_core.errors import UsageError
from tests.conftest import Site

KINDS = list(SKETCHES)

#: What is around a search: little is asked of these, and they are tried in no time.
AROUND = ("measure", "learner", "recipe", "reader", "writer", "command")
IN = tuple(kind for kind in KINDS if kind not in AROUND)
RULES = ["E", "F", "W", "I", "B", "UP", "N", "RUF", "SIM", "PT", "C4", "NPY", "PERF", "D"]


def test_every_kind_has_a_sketch():
    assert set(KINDS) == set(get_args(Kind))
    offered = get_type_hints(new_plugin)["kind"]
    assert list(get_args(offered)) == KINDS


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_left_of_the_templates(kind):
    files = render("steel_parts", kind)
    component = SKETCHES[kind].component
    assert set(files) == {
        ".github/workflows/test.yml",
        ".gitignore",
        "README.md",
        "pyproject.toml",
        "src/moseg_steel_parts/__init__.py",
        "src/moseg_steel_parts/plugin.py",
        f"src/moseg_steel_parts/{component}.py",
        "tests/test_contract.py",
        f"tests/test_{component}.py",
    }
    text = "".join(files) + "".join(files.values())
    assert not [word for word in words("x", kind) if word in text]
    assert "steel_parts" in text


@pytest.mark.parametrize("kind", KINDS)
def test_the_package_names_its_entry_point_and_its_bundle_the_component(kind):
    files = render("vessels", kind)
    project = tomllib.loads(files["pyproject.toml"])["project"]
    assert project["name"] == "moseg-vessels"
    assert project["entry-points"]["moseg"] == {"vessels": "moseg_vessels.plugin"}
    made: dict[str, object] = {}
    exec(files["src/moseg_vessels/plugin.py"], made)
    hook = next(hook for hook, (of, _) in HOOKS.items() if of == kind)
    (spec,) = made[hook]()
    assert spec.kind == kind
    assert spec.name == SKETCHES[kind].component
    module, _, name = spec.target.partition(":")
    source = files[f"src/{module.replace('.', '/')}.py"]
    assert re.search(rf"^(class|def) {name}\b|^{name} =", source, re.MULTILINE)


def test_distributions_whose_components_are_named_are_required():
    files = render("vessels", "recipe")
    required = tomllib.loads(files["pyproject.toml"])["project"]["dependencies"]
    assert [word for word in required if word.startswith("moseg")] == [
        f"moseg-core>={VERSION}",
        f"moseg-objectives-basic>={VERSION}",
    ]


# Each installs a bundle and runs its tests: one kind is enough for every day.
@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(kind, marks=() if kind == "recipe" else pytest.mark.slow)
        for kind in (*AROUND, *IN)
    ],
)
def test_the_bundle_passes_its_tests_and_the_kit(kind, tmp_path):
    """Without installing anything: its sources and its metadata are on the path.

    tests/system/test_published_bundle.py installs bundles of all kinds.
    """
    write_bundle(tmp_path / "b", "my_parts", kind)
    project = tomllib.loads((tmp_path / "b" / "pyproject.toml").read_text())["project"]
    site = Site(tmp_path / "b" / "src")
    (bundle,) = project["entry-points"]["moseg"].items()
    site.add("moseg-my-parts", bundles=dict([bundle]), requires=project["dependencies"])
    paths = [str(site.folder), os.environ.get("PYTHONPATH", "")]
    around = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths)), "MOSEG_STRICT": "1"}

    def run(*words: str) -> str:
        command = [sys.executable, "-m", *words]
        done = subprocess.run(
            command, env=around, cwd=tmp_path / "b", capture_output=True, text=True
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    run("pytest", "-q", "-p", "no:cacheprovider", "-W", "error")
    report = json.loads(run("moseg_core", "plugin", "check", "my_parts", "--json"))
    assert {outcome["status"] for outcome in report["outcomes"]} <= {"passed", "skipped"}
    assert report["counts"]["passed"] > 2


@pytest.mark.parametrize("kind", KINDS)
def test_the_code_is_in_order(kind, tmp_path):
    write_bundle(tmp_path / "b", "vessels", kind)
    ruff = [sys.executable, "-m", "ruff"]
    common = ["--isolated", "--no-cache", "--line-length", "100"]
    rules = ["--select", ",".join(RULES), "--ignore", "N803,N806,D1,D401"]
    rules += ["--config", "lint.pydocstyle.convention='numpy'"]
    for command in (["check", *rules], ["format", "--check"]):
        words = [*ruff, *command, *common, "."]
        done = subprocess.run(words, cwd=tmp_path / "b", capture_output=True, text=True)
        assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("Steel-Parts", "did you mean 'steel_parts'"),
        ("moseg-vessels", "did you mean 'vessels'"),
        ("3d", "as in 'steel_parts'"),
        ("", "as in 'steel_parts'"),
        ("größe", "did you mean 'gr__e'"),
        ("a\n", "did you mean 'a'"),
    ],
)
def test_names_that_are_no_names_are_refused_with_what_is_allowed(name, hint):
    with pytest.raises(
        UsageError, match=r"lower-case letters, digits and _, a letter first"
    ) as told:
        render(name, "objective")
    assert hint in str(told.value)


def test_kinds_that_are_none_are_refused():
    with pytest.raises(UsageError, match="did you mean 'seeder'"):
        render("a", "seder")


def test_folders_with_something_in_them_are_left_alone(tmp_path):
    (tmp_path / "empty").mkdir()
    assert write_bundle(tmp_path / "empty", "a", "objective")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine")
    for name in ("full", "full/mine.txt", "empty"):
        with pytest.raises(UsageError, match="is there already"):
            write_bundle(tmp_path / name, "a", "objective")
    assert [path.name for path in (tmp_path / "full").iterdir()] == ["mine.txt"]
    with pytest.raises(UsageError, match="cannot write"):
        write_bundle(tmp_path / "full" / "mine.txt" / "b", "a", "objective")


def test_names_that_are_taken_are_refused(tmp_path):
    with pytest.raises(UsageError, match=r"'acme' is taken by moseg-acme 1\.0"):
        write_bundle(tmp_path / "b", "acme", "objective", taken={"acme": "moseg-acme 1.0"})
    assert not (tmp_path / "b").exists()
