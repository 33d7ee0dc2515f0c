"""The authors' guide: its examples keep the contract, its tutorial runs as written."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import types
from pathlib import Path

import pytest

from moseg_core.components.discovery.hookspecs import HOOKS
from moseg_core.components.discovery.specs import ReaderSpec, WriterSpec
from tests.conftest import Site
from tests.testing.outcomes import outcomes

GUIDE = Path(__file__).parents[2] / "docs" / "authors"
TUTORIAL = GUIDE / "tutorial"
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)

#: For the page of each kind the components that it shows.
SHOWN = {
    "objective": ("round_section", "thin_plate"),
    "field": ("toward_the_rim",),
    "seeder": ("Spread",),
    "labeler": ("ByArea",),
    "optimizer": ("Shrinking",),
    "parameterization": ("Nearest",),
    "refiner": ("Trimmed",),
    "constraint": ("Centred",),
    "embedding": ("Gathered",),
}


# --- pages of kinds


@pytest.fixture(scope="module")
def checked(tmp_path_factory) -> list[dict[str, str]]:
    """What ``moseg plugin check`` says of a bundle of the examples of all pages."""
    site = Site(tmp_path_factory.mktemp("guide"))
    modules = {}
    hooks = f"from moseg_core import hookimpl, {', '.join(s.__name__ for _, s in HOOKS.values())}\n"
    for kind, names in SHOWN.items():
        modules[f"guide_{kind}"] = "".join(BLOCK.findall((GUIDE / f"{kind}.md").read_text()))
        hook, spec = next((hook, spec) for hook, (its, spec) in HOOKS.items() if its == kind)
        offers = [
            f"{spec.__name__}(name='{kind}_{name.lower()}', target='guide_{kind}:{name}')"
            for name in names
        ]
        hooks += f"@hookimpl\ndef {hook}():\n    return [{', '.join(offers)}]\n"
    site.add("guide", bundles={"guide": "guide_bundle"}, guide_bundle=hooks, **modules)
    words = ("plugin", "check", "guide", "--json")
    done = subprocess.run(
        [sys.executable, "-m", "moseg_core", *words],
        env=os.environ | {"PYTHONPATH": str(site.folder)},
        capture_output=True,
        text=True,
    )
    assert done.stdout, done.stderr
    return json.loads(done.stdout)["outcomes"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "shown", [f"{kind}_{name.lower()}" for kind, names in SHOWN.items() for name in names]
)
def test_the_examples_of_each_kind_keep_the_contract(checked, shown):
    mine = [outcome for outcome in checked if outcome["component"] == f"guide:{shown}"]
    assert [outcome for outcome in mine if outcome["status"] not in ("passed", "skipped")] == []
    assert sum(outcome["status"] == "passed" for outcome in mine) >= 10


def test_there_is_a_page_for_each_kind_that_the_index_lists():
    listed = re.findall(r"^\| \[(\w+)\]\((\w+)\.md\)", (GUIDE / "index.md").read_text(), re.M)
    assert listed == [(kind, kind) for kind in SHOWN]


# --- the tutorial


def shown_files():
    """Path and content of each file that the tutorial shows."""
    text = (GUIDE / "tutorial.md").read_text()
    return re.findall(r"^`([\w./]+)`:\n\n```\w+\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def test_the_tutorial_shows_the_files_as_they_are():
    shown = dict(shown_files())
    assert {
        "src/moseg_printing/overhang.py",
        "src/moseg_printing/plugin.py",
        "tests/test_overhang.py",
        "try_it.py",
    } <= set(shown)
    for path, content in shown.items():
        assert content == (TUTORIAL / path).read_text(), path


@pytest.fixture(scope="module")
def environment(tmp_path_factory) -> dict[str, str]:
    """That of a process which sees the tutorial's bundle as an editable install would show it."""
    site = Site(tmp_path_factory.mktemp("site"))
    site.add("moseg-printing", "0.1.0", bundles={"printing": "moseg_printing.plugin"})
    kept = {k: v for k, v in os.environ.items() if k not in ("MOSEG_PLUGINS", "MOSEG_STRICT")}
    paths = [str(site.folder), str(TUTORIAL / "src"), os.environ.get("PYTHONPATH", "")]
    return kept | {"PYTHONPATH": os.pathsep.join(filter(None, paths)), "MOSEG_STRICT": "1"}


def run(environment, folder, *words):
    """Run Python in a folder; what it says."""
    command = [sys.executable, *map(str, words)]
    done = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def said(after):
    """What the tutorial says that a command prints."""
    text = (GUIDE / "tutorial.md").read_text()
    (lines,) = re.findall(rf"^    \$ {re.escape(after)}\n((?:    .*\n|\n(?=    ))*)", text, re.M)
    return [line.strip() for line in lines.splitlines() if line.strip() and "$" not in line]


@pytest.mark.slow
def test_the_tutorials_tests_pass(environment, tmp_path):
    options = ("-q", "-p", "no:cacheprovider", "-c", TUTORIAL / "pyproject.toml")
    told = run(environment, tmp_path, "-m", "pytest", *options, TUTORIAL / "tests")
    assert re.search(r"\d+ passed", told)
    assert "failed" not in told


def test_the_mushroom_is_cut_below_its_cap(environment, tmp_path):
    told = run(environment, tmp_path, TUTORIAL / "try_it.py")
    assert told.splitlines() == said("python try_it.py")
    words = ("segment", "mushroom.off", "--labels", "stem,cap", "--minimize", "overhang(*)")
    table = run(environment, tmp_path, "-m", "moseg_core", *words)
    assert re.search(r"^total\s+0\.000000\s*$", table, re.M)


def test_the_bundle_is_the_one_that_its_pyproject_describes():
    project = (TUTORIAL / "pyproject.toml").read_text()
    assert 'printing = "moseg_printing.plugin"' in project
    assert 'name = "moseg-printing"' in project


def test_the_reader_and_the_writer_of_the_page_on_files_keep_the_contract(monkeypatch):
    (source,) = BLOCK.findall((GUIDE / "files.md").read_text())
    home = types.ModuleType("guide_files")
    exec(source, home.__dict__)
    monkeypatch.setitem(sys.modules, "guide_files", home)
    reader = ReaderSpec(
        name="dots",
        target="guide_files:read_dots",
        suffixes=(".dots",),
        example="guide_files:example",
    )
    writer = WriterSpec(name="dots", target="guide_files:write_dots", suffixes=(".parts",))
    for spec in (reader, writer):
        assert [found for found in outcomes(spec) if found.status == "failed"] == []
