"""Make ``docs/authors/checks.md``: what the contract kit tests, and why.

From the one place where checks are declared, the code (:mod:`moseg_core.testing`)::

    python tools/make_check_docs.py

A test compares the page with what this script makes.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from moseg_core.specs import Kind
from moseg_core.testing import CHECKS, Check
from moseg_core.testing.run import load_checks

PAGE = Path(__file__).parents[1] / "docs" / "authors" / "checks.md"

#: Kinds in the order of the page, with what they are called there.
KINDS: dict[Kind, str] = {
    "objective": "Objectives",
    "parameterization": "Parameterizations",
    "seeder": "Seeders",
    "labeler": "Labelers",
    "optimizer": "Optimizers",
    "constraint": "Constraints",
    "embedding": "Embeddings",
}

INTRODUCTION = """\
# What is checked

`moseg plugin check NAME`, and `parametrize_contract("NAME")` in a test, run these checks on every
component of an installed bundle; made from the code by `tools/make_check_docs.py`. A check that
came with a later contract (*since*) than the bundle states warns instead of failing
([contract.md](contract.md)). Each is itself tested by a component that fails it and no other:
`tests/testing/broken`.
"""


def page() -> str:
    """The text of the page."""
    load_checks()
    return INTRODUCTION + "".join(_sections())


def _sections() -> Iterator[str]:
    shared = [check for check in CHECKS.values() if len(check.kinds) > 1]
    if shared:
        yield from _table("Several kinds", shared, kinds=True)
    for kind, title in KINDS.items():
        yield from _table(title, [c for c in CHECKS.values() if c.kinds == (kind,)])


def _table(title: str, checks: list[Check], *, kinds: bool = False) -> Iterator[str]:
    """A section, with a column for kinds where these differ."""
    extra, rule = (" kinds |", "---|") if kinds else ("", "")
    yield f"\n## {title}\n\n| check | why | since |{extra}\n|---|---|---|{rule}\n"
    for check in checks:
        asked = [title.lower() for kind, title in KINDS.items() if kind in check.kinds]
        every = "all" if len(asked) == len(KINDS) else ", ".join(asked)
        told = f" {every} |" if kinds else ""
        yield f"| `{check.id}` | {check.why} | {check.since} |{told}\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
