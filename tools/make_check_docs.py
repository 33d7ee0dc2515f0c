"""Make ``docs/authors/checks.md``: what the contract kit tests, and why.

From the places where checks are declared (:mod:`moseg_core.testing`) and where each has a component
that fails it and no other (``tests/testing/broken``)::

    python tools/make_check_docs.py

A test compares the page with what this script makes.
"""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import get_args

from moseg_core.components.discovery.specs import Kind, Spec
from moseg_core.testing import Check
from moseg_core.testing.run import load_checks

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "authors" / "checks.md"
BROKEN = ROOT / "tests" / "testing" / "broken"

#: Kinds in the order of the page, with what they are called there.
KINDS: dict[Kind, str] = {
    "objective": "Objectives",
    "field": "Fields",
    "parameterization": "Parameterizations",
    "seeder": "Seeders",
    "labeler": "Labelers",
    "optimizer": "Optimizers",
    "refiner": "Refiners",
    "constraint": "Constraints",
    "embedding": "Embeddings",
    "learner": "Learners",
    "reader": "Readers",
    "writer": "Writers",
}

INTRODUCTION = """\
# What is checked

`moseg plugin check NAME`, and `parametrize_contract("NAME")` in a test, run these checks on every
component of an installed bundle, or on one that is not installed ([index.md](index.md)); made from
the code by `tools/make_check_docs.py`. A check that came with a later contract (*since*) than the
bundle states warns instead of failing
([contract.md](contract.md)). Each is itself tested by a component that fails it and no other, which
is in the last column; they are in `tests/testing/broken`.
"""


def page() -> str:
    """The text of the page."""
    return INTRODUCTION + "".join(_sections())


def _sections() -> Iterator[str]:
    checks, broken = load_checks(), broken_components()
    several = [check for check in checks if len(check.kinds) > 1]
    for kinds in dict.fromkeys(check.kinds for check in several):
        mine = [check for check in several if check.kinds == kinds]
        yield from _table(_named(kinds), mine, broken)
    for kind, title in KINDS.items():
        mine = [check for check in checks if check.kinds == (kind,)]
        yield from _table(title, mine, broken)


def _named(kinds: tuple[Kind, ...]) -> str:
    """Several kinds in words, or those that are missing where that is shorter."""
    missing = [kind for kind in get_args(Kind) if kind not in kinds]
    if not missing:
        return "All components"
    if len(missing) < len(kinds):
        return f"All but {_listed(missing)}"
    return _listed(kinds).capitalize()


def _listed(kinds: Iterable[Kind]) -> str:
    *most, last = (f"{kind}s" for kind in kinds)
    return f"{', '.join(most)} and {last}"


def _table(title: str, checks: list[Check], broken: dict[str, Spec]) -> Iterator[str]:
    yield f"\n## {title}\n\n| check | why | since | fails for |\n|---|---|---|---|\n"
    for check in checks:
        yield f"| `{check.id}` | {check.why} | {check.since} | {_headline(broken[check.id])} |\n"


def broken_components() -> dict[str, Spec]:
    """For the id of each check the component that fails it."""
    found: dict[str, Spec] = {}
    for path in sorted(BROKEN.glob("*.py")):
        module = importlib.import_module(f"tests.testing.broken.{path.stem}")
        found |= getattr(module, "BROKEN", {})
    return found


def _headline(spec: Spec) -> str:
    """A component's name and the first line of its docstring."""
    module, _, name = spec.target.partition(":")
    target = getattr(importlib.import_module(module), name, None)
    said = (inspect.getdoc(target) or "").partition("\n")[0].rstrip(".").replace("``", "`")
    return f"`{name}`: {said}" if said else f"`{name}`"


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))  # for the tests' broken components
    PAGE.write_text(page(), encoding="utf-8")
