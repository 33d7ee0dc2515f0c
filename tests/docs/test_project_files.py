"""The files that people and tools look for in a project say what the project does."""

from __future__ import annotations

import re
import tomllib
from importlib import metadata
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def read(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def programs(lines: list[str]) -> set[str]:
    """What is run from .venv, without its options: ``ruff check``, ``mypy``."""
    words = [re.sub(r"^.*/", "", line).split() for line in lines]
    return {" ".join(word for word in each if word[0] not in "-.") for each in words}


def test_a_commit_is_checked_as_make_lint_checks():
    lint = re.search(r"^lint:.*\n((?:\t.*\n)+)", read("Makefile"), re.MULTILINE)[1].splitlines()
    entries = re.findall(r"^ *entry: (.*)$", read(".pre-commit-config.yaml"), re.MULTILINE)
    assert programs(entries) == programs(lint)
    assert all(entry.startswith(".venv/bin/") for entry in entries)


def test_nothing_is_downloaded_for_a_commit():
    assert re.findall(r"repo: (.*)", read(".pre-commit-config.yaml")) == ["local"]


def test_what_is_cited_is_this_version():
    cited = re.search(r"^version: (.*)$", read("CITATION.cff"), re.MULTILINE)[1]
    assert cited == metadata.version("moseg-core")


def test_the_paper_is_cited_as_the_readme_names_it():
    title = re.search(r"^  title: (.*)$", read("CITATION.cff"), re.MULTILINE)[1]
    assert f'"{title}"' in read("README.md")
    names = re.findall(r"family-names: (.*)", read("CITATION.cff"))
    assert re.search(rf"P\. {names[0]} and K\. {names[1]}", read("README.md"))


def test_every_distribution_has_the_version_that_is_cited():
    projects = [ROOT / "pyproject.toml", *ROOT.glob("plugins/*/pyproject.toml")]
    assert len(projects) > 3
    found = {re.search(r'^version = "(.*)"', p.read_text(), re.MULTILINE)[1] for p in projects}
    assert found == {metadata.version("moseg-core")}


def test_own_bundles_depend_on_each_other_as_authors_are_advised_to():
    assert "Depend on `moseg-core>=X`" in read("docs/authors/publishing.md")
    projects = [ROOT / "pyproject.toml", *ROOT.glob("plugins/*/pyproject.toml")]
    lines = [
        line
        for project in projects
        for table in [tomllib.loads(project.read_text(encoding="utf-8"))["project"]]
        for lines in [table["dependencies"], *table.get("optional-dependencies", {}).values()]
        for line in lines
        if line.startswith("moseg")
    ]
    assert sum(line.startswith("moseg-core") for line in lines) == len(projects) - 1
    assert [line for line in lines if not re.fullmatch(r"moseg-[a-z-]+>=\d+\.\d+\.\d+", line)] == []


@pytest.mark.parametrize("template", ["bug", "segmentation"])
def test_who_reports_is_asked_for_the_versions_that_moseg_prints(template):
    text = read(f".github/ISSUE_TEMPLATE/{template}.md")
    assert "`moseg plugin list`" in text
    assert re.match(r"---\nname: .+\nabout: .+\nlabels: .+\n---\n", text)
