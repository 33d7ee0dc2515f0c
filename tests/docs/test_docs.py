"""What the documentation points at is there: files of the project, pages of its own, headings."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / ".github").rglob("*.md"), *ROOT.glob("docs/**/*.md")])
PAGES = [page for page in PAGES if "generated" not in page.parts]  # what the site is made of

# `folder/name.py` between single backticks: a path from the root of the project.
FILE = re.compile(r"(?<!`)`([\w.-]+(?:/[\w.-]+)+\.(?:py|md|toml))`(?!`)")
LINK = re.compile(r"\]\((?!https?:|#)([^)#\s]+)[^)]*\)")
ANCHORED = re.compile(r"\]\((?!https?:)([^)#\s]*)#([^)\s]+)\)")


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


def anchors(text: str) -> set[str]:
    """What the headings of a page are called in links, as GitHub and MyST do it."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    headings = re.findall(r"^#{1,6} +(.*)$", text, re.MULTILINE)
    plain = [re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower() for heading in headings]
    named = set(re.findall(r'<a (?:id|name)="([^"]+)"', text))
    return named | {re.sub(r"[^\w\- ]", "", heading).strip().replace(" ", "-") for heading in plain}


def test_anchors_are_made_of_headings():
    text = '# One `a_b(c)`: two\n```sh\n# none\n```\n## [Linked](x.md), here\n<a id="own"></a>'
    assert anchors(text) == {"one-a_bc-two", "linked-here", "own"}


def test_headings_that_are_linked_exist():
    broken, found = [], 0
    for page in PAGES:
        for file, anchor in ANCHORED.findall(page.read_text()):
            target = page.parent / file if file else page
            found += 1
            if target.suffix == ".md" and anchor not in anchors(target.read_text()):
                broken.append(f"{page.relative_to(ROOT)}: {file}#{anchor}")
    assert broken == []
    assert found > 15


def test_the_page_on_the_paper_names_code_and_tests():
    named = files_named((ROOT / "docs" / "paper.md").read_text())
    assert sum("tests/" in name for name in named) > 30
    assert {"moseg_core/builtin/flood.py", "moseg_core/view/convergence.py"} <= set(named)
