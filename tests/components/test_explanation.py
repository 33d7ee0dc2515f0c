"""What is read from signatures, traits and docstrings."""

from __future__ import annotations

import pytest

from moseg_core.components.explanation import (
    bounds,
    default,
    explain_component,
    read_docstring,
    read_entries,
)
from moseg_core.components.parameters import Interval, Parameter
from moseg_core.errors import PluginError
from moseg_core.language import Table, Target

DOCSTRING = """Small where it is long:
    in one line or two.

    More of it.

    And more.

    Parameters
    ----------
    part : Part
    low, high : float
        Bounds, in units
        of its own.
    *rest : float
        Others.

    See Also
    --------
    nothing

    Notes
    -----
    Known since Euclid.
    """


def test_docstrings_are_taken_apart():
    headline, body, sections = read_docstring(DOCSTRING)
    assert headline == "Small where it is long: in one line or two."
    assert body == "More of it.\n\nAnd more."
    assert list(sections) == ["Parameters", "See Also", "Notes"]
    assert sections["Notes"] == "Known since Euclid."
    assert read_entries(sections["Parameters"]) == {
        "part": "",
        "low": "Bounds, in units of its own.",
        "high": "Bounds, in units of its own.",
        "rest": "Others.",
    }
    assert read_docstring("") == ("", "", {})


@pytest.mark.parametrize(
    ("parameter", "allowed", "unless_given"),
    [
        (
            Parameter(name="p", type=float, default=0.5, interval=Interval(0, 1)),
            "number, 0 to 1",
            "0.5",
        ),
        (Parameter(name="p", type=float, required=True), "number", "must be given"),
        (Parameter(name="p", type=str, default="auto"), "text", "auto"),
        (Parameter(name="p", type=bool, default=False), "0 or 1", "0"),
        (Parameter(name="p", type=int, optional=True), "whole number, or none", "none"),
        (
            Parameter(name="p", type=Table, required=True),
            "a table of the recipe, by its name",
            "must be given",
        ),
        (
            Parameter(name="p", type=Table, default=Table(), optional=True),
            "a table of the recipe, by its name, or none",
            "a table of the component's own",
        ),
        (
            Parameter(name="p", type=Target, default=Target(6, 2)),
            "a target such as 0.06+-0.02",
            "6+-2",
        ),
        (
            Parameter(name="p", type=Target, interval=Interval(0, 1), optional=True),
            "a target such as 0.06+-0.02, its value 0 to 1, or none",
            "none",
        ),
    ],
)
def test_parameters_in_words(parameter, allowed, unless_given):
    assert (bounds(parameter), default(parameter)) == (allowed, unless_given)


def test_components_of_strangers(site):
    site.add(
        "moseg-odd",
        bundles={"odd": "odd_bundle"},
        odd_bundle="""
            from moseg_core import ObjectiveSpec, SeederSpec, hookimpl

            @hookimpl
            def moseg_seeders():
                return [
                    SeederSpec(name="bare", target="odd_bundle:Bare", summary="says nothing"),
                    SeederSpec(name="unread", target="odd_bundle:Unread"),
                    SeederSpec(name="missing", target="odd_bundle:Missing"),
                ]

            class Bare:
                def __init__(self, *, n: int = 3): ...

            class Unread:
                def __init__(self, *, n: complex = 3j): ...
        """,
    )
    found = site.discover()
    bare = explain_component(found.find("seeder", "bare"))
    assert (bare.headline, bare.about, bare.said) == ("says nothing", "", {})
    assert [parameter.name for parameter in bare.parameters] == ["n"]
    with pytest.raises(PluginError, match=r"'odd:unread' of moseg-odd 1\.0 cannot be explained"):
        explain_component(found.find("seeder", "unread"))
    with pytest.raises(PluginError, match=r"'odd:missing' of moseg-odd 1\.0 cannot be loaded"):
        explain_component(found.find("seeder", "missing"))
