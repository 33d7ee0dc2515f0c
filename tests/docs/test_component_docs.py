"""What the documentation says of components is what the code says today."""

from __future__ import annotations

import dataclasses
import re
import tomllib

import pytest

from moseg_core.components.discovery.registry import registry
from moseg_core.components.explanation import Explained, explain_component
from tools.make_component_docs import (
    BLOCKS,
    BUNDLES,
    PAGE,
    ROOT,
    basic_objectives,
    call,
    filled,
    formula,
    made_page,
    page,
    small_when,
    source,
    table,
)

AGAIN = "run: python tools/make_component_docs.py"


def explained(name: str) -> Explained:
    return explain_component(registry().find("objective", name))


def test_the_page_is_of_all_bundles_of_this_repository():
    projects = [ROOT / "pyproject.toml", *ROOT.glob("plugins/*/pyproject.toml")]
    tables = [tomllib.loads(path.read_text())["project"]["entry-points"] for path in projects]
    assert sorted(BUNDLES) == sorted(name for table in tables for name in table["moseg"])


def test_the_readme_names_all_recipes_or_says_that_there_are_more():
    named = re.search(
        r"^    moseg recipes +# (.*)$", (ROOT / "README.md").read_text(), re.MULTILINE
    )
    names = set(named[1].split(", "))
    known = {c.spec.name for c in registry().components("recipe") if c.bundle in BUNDLES}
    assert names - {"..."} <= known
    assert ("..." in names) == (names - {"..."} != known)


def test_the_page_of_components_is_up_to_date():
    assert PAGE.read_text() == page(), AGAIN


@pytest.mark.parametrize("path", BLOCKS, ids=lambda path: path.name)
def test_the_tables_of_objectives_are_up_to_date(path):
    assert path.read_text() == made_page(path), AGAIN


def test_there_is_a_small_picture_of_every_basic_objective_and_no_other():
    folder = ROOT / "docs" / "images" / "objectives"
    drawn = {path.stem: path.stat().st_size for path in folder.glob("*.png")}
    assert sorted(drawn) == sorted(told.component.spec.name for told in basic_objectives())
    assert sum(drawn.values()) < 1e6


@pytest.mark.parametrize(
    ("name", "written", "small", "stands"),
    [
        ("narrow", "narrow(a)", "long and thin", "Sec. 10"),
        (
            "rotational_symmetric",
            "rotational_symmetric(a, n=2)",
            "the same n times in a full turn",
            "named in Sec. 3",
        ),
        ("parallel", "parallel(a, b)", "long axes parallel", "named in Sec. 3"),
        (
            "similar_proportions",
            "similar_proportions(a, b, ...)",
            "alike in length, width and height",
            "Sec. 10",
        ),
        ("convex_parts", "convex_parts", "their convex hulls fill the volume once", "Sec. 10"),
        (
            "area_fraction",
            "area_fraction(a, min=0, max=1)",
            "its share of the area is within the bounds",
            "",
        ),
    ],
)
def test_rows_come_from_signature_summary_and_notes(name, written, small, stands):
    told = explained(name)
    assert (call(told), small_when(told), source(told)) == (written, small, stands)


def test_a_formula_does_not_end_the_cell_of_a_table():
    assert formula(explained("perpendicular")) == r"`\|axis_1 . axis_1'\|`"
    with pytest.raises(ValueError, match="basic:narrow begins without a formula"):
        formula(dataclasses.replace(explained("narrow"), headline="Small where it is long."))


@pytest.mark.parametrize("summary", ["long and thin", "two parts: long and thin", "one part: "])
def test_a_summary_that_says_something_else_of_the_parts_is_an_error(summary):
    told = explained("narrow")
    spec = dataclasses.replace(told.component.spec, summary=summary)
    other = dataclasses.replace(told, component=dataclasses.replace(told.component, spec=spec))
    with pytest.raises(ValueError, match="the summary of basic:narrow is not 'one part: "):
        small_when(other)


def test_only_what_is_between_the_marks_is_made():
    text = (ROOT / "README.md").read_text()
    other = filled(text, "A TABLE")
    assert other.replace("A TABLE", table(BLOCKS[ROOT / "README.md"])) == text
    with pytest.raises(ValueError, match="marked"):
        filled(re.sub("end of objectives", "end", text), "A TABLE")
