"""Measures and fields are found by name, loaded once, and blamed by their own name."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import FieldSpec, MeasureSpec
from moseg_core.errors import PluginError, UsageError

FIELDS = """
    from moseg_core import FieldSpec, hookimpl

    @hookimpl
    def moseg_fields():
        return [FieldSpec(name="height", target="field_parts:height", requires=("surface",))]
"""

BARE = FIELDS.replace("field_parts:height", "builtins:dict")


def test_measures_are_loaded_once(good, monkeypatch):
    (good.folder / "good_parts.py").write_text("def girth(part): return 1.0\n")
    loads = []
    load = Component.load
    monkeypatch.setattr(Component, "load", lambda self: (loads.append(self.id), load(self))[1])
    lookup = Lookup(good.discover())
    found = lookup.measure("girth")
    assert (found.id, found.function(None), found.keep) == ("good:girth", 1.0, False)
    assert lookup.measure("girth") is found
    assert lookup.measure("good:girth") is found
    assert loads == ["good:girth"]


def test_fields_are_loaded_once_and_say_what_they_require(site, monkeypatch):
    site.add("Field-Parts", "2.0", bundles={"fine": "fine_bundle"}, fine_bundle=FIELDS)
    (site.folder / "field_parts.py").write_text("def height(shape): raise ZeroDivisionError\n")
    loads = []
    load = Component.load
    monkeypatch.setattr(Component, "load", lambda self: (loads.append(self.id), load(self))[1])
    lookup = Lookup(site.discover())
    found = lookup.field("height")
    assert (found.id, found.requires) == ("fine:height", ("surface",))
    assert "Field-Parts 2.0" in found.source
    assert lookup.field("fine:height") is found
    assert loads == ["fine:height"]
    with pytest.raises(PluginError, match=r"field 'fine:height' of Field-Parts 2\.0 failed"):
        found.function(None)


def test_fields_say_what_their_parameters_are_where_nobody_does(site):
    site.add("Field-Parts", "2.0", bundles={"fine": "fine_bundle"}, fine_bundle=FIELDS)
    (site.folder / "field_parts.py").write_text(
        "def height(shape, other=3, *, up='z', radius=0.1, among): ...\n"
    )
    assert dict(Lookup(site.discover()).field("height").defaults) == {"up": "z", "radius": 0.1}
    site.add("No-Signature", "1.0", bundles={"bare": "bare_bundle"}, bare_bundle=BARE)
    assert dict(Lookup(site.discover()).field("bare:height").defaults) == {}


@pytest.mark.parametrize("kind", ["measure", "field"])
def test_names_that_are_not_there(kind):
    spec = {"measure": MeasureSpec, "field": FieldSpec}[kind](name="slim", target="home:thing")
    bundles = (
        Bundle("basic", "moseg-basic", "1.0", "basic", (Component("basic", "moseg-basic", spec),)),
        Bundle("broken", "moseg-broken", "1.0", "broken", (), "importing it failed"),
    )
    find = getattr(Lookup(Registry(bundles)), kind)
    with pytest.raises(UsageError, match=f"unknown {kind} 'slam'; did you mean 'slim'"):
        find("slam")
    with pytest.raises(PluginError, match=f"{kind} 'broken:x' is not available"):
        find("broken:x")
