"""Make ``docs/components.md``: all components of moseg's own bundles and their parameters.

From the one place where they are declared, the code (:mod:`moseg_core.components.explanation`)::

    python tools/make_component_docs.py

A test compares the page with what this script makes of the installed bundles.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from moseg_core.components.discovery.registry import registry
from moseg_core.components.discovery.specs import Kind
from moseg_core.components.explanation import Explained, bounds, default, explain_component, span

PAGE = Path(__file__).parents[1] / "docs" / "components.md"
BUNDLES = ("core", "basic", "symmetry", "mds")

#: Kinds in the order of the page, with what they are called there.
KINDS: dict[Kind, str] = {
    "objective": "Objectives",
    "constraint": "Constraints",
    "embedding": "Embeddings",
    "seeder": "Seeders",
    "labeler": "Labelers",
    "optimizer": "Optimizers",
    "parameterization": "Parameterizations",
    "measure": "Measures",
    "reader": "Readers",
    "writer": "Writers",
    "recipe": "Recipes",
    "command": "Commands",
}

INTRODUCTION = """\
# Components

What moseg brings, with all parameters; made from the code by `tools/make_component_docs.py`.
`moseg plugin explain NAME` says more of each, also of what others have published, and
`moseg plugin list` what is installed. Formulas are in [objectives.md](objectives.md).
"""


def page() -> str:
    """The text of the page."""
    return INTRODUCTION + "".join(_sections())


def _sections() -> Iterator[str]:
    known = [c for c in registry().components() if c.bundle in BUNDLES]
    for kind, title in KINDS.items():
        yield f"\n## {title}\n"
        for component in sorted((c for c in known if c.kind == kind), key=lambda c: c.id):
            yield from _entry(explain_component(component))


def _entry(explained: Explained) -> Iterator[str]:
    component = explained.component
    said = component.spec.summary or explained.headline
    yield f"\n`{component.id}`: {said}\n"
    traits = explained.traits
    if traits is not None:
        needs = f"; needs {' and '.join(sorted(traits.requires))}" if traits.requires else ""
        yield f"Takes {traits.takes}; {span(traits)}; {traits.cost}{needs}.\n"
    if explained.parameters:
        yield "\n| parameter | default | allowed | |\n|---|---|---|---|\n"
    for parameter in explained.parameters:
        said = explained.said.get(parameter.name, "").replace("``", "`")
        words = re.sub(r":\w+:(?=`)", "", said)
        yield f"| `{parameter.name}` | {default(parameter)} | {bounds(parameter)} | {words} |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
