"""What the documentation points at is there: files of the project, and pages of its own."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / ".github").rglob("*.md"), *ROOT.glob("docs/**/*.md")])

# `folder/name.py` between single backticks: a path from the root of the project.
FILE = re.compile(r"(?<!`)`([\w.-]+(?:/[\w.-]+)+\.(?:py|md|toml))`(?!`)")
LINK = re.compile(r"\]\((?!https?:|#)([^)#\s]+)[^)]*\)")


def files_named(text: str) -> list[str]:
    """Paths that a page names in running text; what is in a fenced block is an example."""
    return FILE.findall(re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL))


def test_paths_are_told_from_other_code():
    text = "`a/b.py`, `b.py`, `-o a/b.toml`, ``a/c.py``, `a/b/d.md`\n```\n`a/e.py`\n```\n`f/g.toml`"
    assert files_named(text) == ["a/b.py", "a/b/d.md", "f/g.toml"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_files_that_are_named_exist(page):
    folders = (ROOT, page.with_suffix(""))  # a page may have files of its own, as the tutorial
    named = files_named(page.read_text())
    missing = [name for name in named if not any((f / name).is_file() for f in folders)]
    assert not missing


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_pages_and_pictures_that_are_linked_exist(page):
    missing = [name for name in LINK.findall(page.read_text()) if not (page.parent / name).exists()]
    assert not missing


def test_the_page_on_the_paper_names_code_and_tests():
    named = files_named((ROOT / "docs" / "paper.md").read_text())
    assert sum("tests/" in name for name in named) > 30
    assert {"moseg_core/builtin/flood.py", "moseg_core/view/convergence.py"} <= set(named)
