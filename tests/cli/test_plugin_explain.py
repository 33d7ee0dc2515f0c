"""``moseg plugin explain``."""

from __future__ import annotations

import json
import sys

from moseg_core.components.discovery.registry import registry


def test_explain_an_objective(moseg):
    run = moseg("plugin", "explain", "area_fraction")
    assert run.code == 0
    text = " ".join(run.out.split())
    for words in (
        "basic:area_fraction objective",
        "min = 0 number, 0 to 1 Bounds of the share",
        "range 0 to 1",
        "takes one label, or several to be summed",
        "needs nothing but the parts",
        "unchanged by order, reflection, rigid, scale, tessellation",
        "cost cheap",
        "expects a share of the area, where its parameters tell which",
        "from moseg-objectives-basic 0.1.0",
        "target moseg_objectives_basic.area:area_fraction",
        "max(min - share, share - max, 0)",
    ):
        assert words in text, words
    assert "`" not in run.out
    needs = " ".join(moseg("plugin", "explain", "basic:convex_parts").out.split())
    assert "needs volume" in needs
    assert "range 0 to infinity" in needs
    assert "expects" not in needs


def test_explain_begins_with_the_summary_and_says_nothing_twice(moseg):
    narrow = moseg("plugin", "explain", "narrow").out
    assert narrow.splitlines()[1].strip() == "one part: long and thin"
    assert "(s2 + s3) / (2 s1)" in narrow  # what the docstring begins with comes next
    assert moseg("plugin", "explain", "core:seg").out.lower().count("one label number a line") == 1


def test_explain_other_kinds(moseg):
    seeder = " ".join(moseg("plugin", "explain", "kmeans").out.split())
    assert "rounds = 100 whole number, 1 or more Most rounds to run." in seeder
    assert "Algorithm 2" in seeder  # where it comes from, in the words of its module
    assert "moseg recipes basic:paper_hammer" in moseg("plugin", "explain", "paper_hammer").out
    assert "to use it moseg segment SHAPE --recipe basic:paper_hammer -o x.png" in " ".join(
        moseg("plugin", "explain", "paper_hammer").out.split()
    )
    assert "--recipe basic:any_shape --parts 5" in moseg("plugin", "explain", "any_shape").out
    assert ".off" in moseg("plugin", "explain", "core:off").out
    assert "moseg embed --help" in moseg("plugin", "explain", "embed").out
    # One name for two kinds of the same bundle: both.
    both = json.loads(moseg("plugin", "explain", "core:ply", "--json").out)
    assert [told["kind"] for told in both] == ["reader", "writer"]


def test_explain_as_json(moseg):
    (told,) = json.loads(moseg("plugin", "explain", "rotational_symmetric", "--json").out)
    assert told["id"] == "basic:rotational_symmetric"
    assert told["distribution"] == "moseg-objectives-basic 0.1.0"
    assert told["traits"]["range"] == [0, 1]
    assert told["traits"]["requires"] == ["surface"]
    assert told["traits"]["expects_share"] is False
    (parameter,) = told["parameters"]
    assert (parameter["name"], parameter["default"]) == ("n", 2)
    assert (parameter["low"], parameter["high"]) == (2, None)


def test_explain_everything_that_is_installed(moseg):
    for component in registry().components():
        told = json.loads(moseg("plugin", "explain", component.id, "--json").out)
        assert component.kind in [entry["kind"] for entry in told]
        assert all(entry["headline"] for entry in told)
        for parameter in [p for entry in told for p in entry["parameters"]]:
            assert parameter["says"], f"'{parameter['name']}' of {component.id} is not documented"


def test_targets_are_told_in_words(site, moseg, monkeypatch):
    site.add(
        "moseg-sizes",
        bundles={"sizes": "sizes_bundle"},
        sizes_bundle="""
            from typing import Annotated

            from moseg_core import Interval, ObjectiveSpec, Part, Target, hookimpl, objective

            @hookimpl
            def moseg_objectives():
                return [ObjectiveSpec(name="sized", target="sizes_bundle:sized")]

            @objective()
            def sized(part: Part, *, area: Annotated[Target, Interval(0, 1)] = Target(0.06, 0.02)):
                "Small where it has the usual size."
        """,
    )
    module = sys.modules["moseg_core.cli.plugin_explain"]
    monkeypatch.setattr(module, "registry", site.discover)
    text = " ".join(moseg("plugin", "explain", "sized").out.split())
    assert "area = 0.06+-0.02 a target such as 0.06+-0.02, its value 0 to 1" in text
    (told,) = json.loads(moseg("plugin", "explain", "sized", "--json").out)
    (parameter,) = told["parameters"]
    assert (parameter["type"], parameter["default"]) == ("Target", "0.06+-0.02")


def test_explain_says_what_is_near(moseg):
    run = moseg("plugin", "explain", "narow")
    assert run.code == 2
    assert "did you mean 'narrow'" in run.err
    assert "did you mean 'core:kmeans'" in moseg("plugin", "explain", "core:kmean").err
