"""Make what the documentation says of components, from the code where it is declared.

``docs/components.md`` is made whole: all components of moseg's own bundles and their parameters
(:mod:`moseg_core.components.explanation`). In ``README.md`` and ``docs/objectives.md`` the tables
of objectives are made, between two marks::

    <!-- objectives: made by tools/make_component_docs.py -->
    <!-- end of objectives -->

and in the latter a section for each, between those of ``pictures``, with the picture that
``tools/make_objective_pictures.py`` has drawn.

What an objective is about and where it is small is the ``summary`` of its spec, ``"one part: long
and thin"``; its formula is the first line of its docstring. Run it after a change of either; a
test compares::

    python tools/make_component_docs.py
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

from moseg_core.components.discovery.registry import registry
from moseg_core.components.discovery.specs import FieldSpec, Kind
from moseg_core.components.explanation import Explained, bounds, default, explain_component, span
from moseg_core.components.objectives import Traits

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "components.md"
BUNDLES = (
    *("core", "basic", "symmetry", "mds", "benchmark", "learn", "shapes"),
    *("robotics", "medical"),
)

#: Kinds in the order of the page, with what they are called there.
KINDS: dict[Kind, str] = {
    "objective": "Objectives",
    "constraint": "Constraints",
    "embedding": "Embeddings",
    "seeder": "Seeders",
    "labeler": "Labelers",
    "optimizer": "Optimizers",
    "refiner": "Refiners",
    "parameterization": "Parameterizations",
    "measure": "Measures",
    "field": "Fields",
    "reader": "Readers",
    "writer": "Writers",
    "learner": "Learners",
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
    elif isinstance(component.spec, FieldSpec) and component.spec.requires:
        yield f"Needs {' and '.join(component.spec.requires)}.\n"
    if explained.parameters:
        yield "\n| parameter | default | allowed | |\n|---|---|---|---|\n"
    for parameter in explained.parameters:
        said = explained.said.get(parameter.name, "").replace("``", "`")
        words = re.sub(r":\w+:(?=`)", "", said)
        yield f"| `{parameter.name}` | {default(parameter)} | {bounds(parameter)} | {words} |\n"


def about(traits: Traits) -> str:
    """Of how many parts an objective is, as its summary has to say."""
    if traits.arity == "nary":
        return "two parts" if traits.most == 2 else "several parts"
    return {"unary": "one part", "global": "all parts"}[traits.arity]


def call(explained: Explained) -> str:
    """An objective as it is written in an expression, with its parameters' defaults.

    Of parameters that may be left out the first is named, for the others stand dots.
    """
    traits = explained.traits
    assert traits is not None
    labels = {"one part": ["a"], "two parts": ["a", "b"], "several parts": ["a", "b", "..."]}
    arguments = labels.get(about(traits), [])
    given = [parameter for parameter in explained.parameters if not parameter.optional]
    arguments += [f"{parameter.name}={default(parameter)}" for parameter in given]
    if left_out := [parameter.name for parameter in explained.parameters if parameter.optional]:
        arguments += [f"{left_out[0]}=...", *(["..."] if len(left_out) > 1 else [])]
    name = explained.component.spec.name
    return f"{name}({', '.join(arguments)})" if arguments else name


def small_when(explained: Explained) -> str:
    """Where an objective is small.

    Raises
    ------
    ValueError
        The summary does not begin with what the objective is about.
    """
    traits, summary = explained.traits, explained.component.spec.summary
    assert traits is not None
    start, _, rest = summary.partition(": ")
    if start != about(traits) or not rest:
        raise ValueError(
            f"the summary of {explained.component.id} is not '{about(traits)}: ...' but '{summary}'"
        )
    return rest


def formula(explained: Explained) -> str:
    """The formula that an objective's docstring begins with, for a cell of a table.

    Raises
    ------
    ValueError
        The docstring begins with something else.
    """
    found = re.match(r"``([^`]+)``:? ", f"{explained.headline} ")
    if found is None:
        raise ValueError(f"the docstring of {explained.component.id} begins without a formula")
    return "`" + found[1].replace("|", r"\|") + "`"


def source(explained: Explained) -> str:
    """Where in the paper an objective is, by its notes; empty where it is not."""
    notes = " ".join(explained.sections.get("Notes", "").split())
    found = re.search(r"(named in )?Simari & Singh, (Sec\. \d+)", notes, re.IGNORECASE)
    return f"{(found[1] or '').lower()}{found[2]}" if found else ""


def table(columns: dict[str, Callable[[Explained], str]]) -> str:
    """A table of the basic objectives, in the order in which their bundle has them."""
    rows = [[make(told) for make in columns.values()] for told in basic_objectives()]
    lines = [list(columns), ["---"] * len(columns), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def basic_objectives() -> list[Explained]:
    """The basic objectives, in the order in which their bundle has them."""
    known = registry().components("objective")
    return [explain_component(component) for component in known if component.bundle == "basic"]


def sections() -> str:
    """A section for each basic objective: how it is written, where it is small, its picture."""
    return "\n".join(_section(told) for told in basic_objectives())


def _section(told: Explained) -> str:
    name = told.component.spec.name
    return (
        f"### {name}\n\n"
        f"`{call(told)}`, {about(told.traits)}: {small_when(told)}. {formula(told)},"
        f" {span(told.traits)}.\n\n"
        f"![{name}: low on the left, high on the right](images/objectives/{name}.png)\n"
    )


def _code(explained: Explained) -> str:
    return f"`{call(explained)}`"


def _linked(explained: Explained) -> str:
    name = explained.component.spec.name
    return f"[{_code(explained)}](#{name})"


def _about(explained: Explained) -> str:
    return about(explained.traits) if explained.traits else ""


def _range(explained: Explained) -> str:
    return span(explained.traits) if explained.traits else ""


#: What is made within pages that are written by hand.
BLOCKS: dict[Path, dict[str, Callable[[Explained], str]]] = {
    ROOT / "README.md": {"objective": _code, "about": _about, "small when": small_when},
    ROOT / "docs" / "objectives.md": {
        "objective": _linked,
        "small when": small_when,
        "formula": formula,
        "range": _range,
        "paper": source,
    },
}


def filled(text: str, made: str, block: str = "objectives") -> str:
    """The text of a page with what is made between its marks.

    Parameters
    ----------
    text : str
    made : str
    block : str
        The word in the marks.

    Raises
    ------
    ValueError
        The page has no such marks.
    """
    pattern = (
        rf"(?<=<!-- {block}: made by tools/make_component_docs.py -->\n).*"
        rf"(?=<!-- end of {block} -->\n)"
    )
    found, count = re.subn(pattern, lambda _: f"\n{made}\n", text, flags=re.DOTALL)
    if count != 1:
        raise ValueError(f"the page has no place that is marked for {block}")
    return found


def made_page(path: Path) -> str:
    """The text of a page of :data:`BLOCKS`, with what is made in it."""
    text = filled(path.read_text(encoding="utf-8"), table(BLOCKS[path]))
    return filled(text, sections(), "pictures") if path.name == "objectives.md" else text


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    for path in BLOCKS:
        path.write_text(made_page(path), encoding="utf-8")
