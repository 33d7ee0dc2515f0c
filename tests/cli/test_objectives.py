"""``moseg objectives``: the words of the language."""

from __future__ import annotations

import json

from moseg_core.components.discovery.registry import registry


def test_all_are_listed_with_what_they_are_about(moseg):
    run = moseg("objectives")
    rows = {line.split()[0]: line.split() for line in run.out.splitlines()[1:] if line[:1] != " "}
    assert {component.spec.name for component in registry().components("objective")} <= set(rows)
    assert rows["narrow"][1:4] == ["basic", "one", "part"]
    order = list(rows)
    assert order.index("narrow") < order.index("above") < order.index("convex_parts")
    listed = json.loads(moseg("objectives", "--json").out)
    assert "basic:narrow" in [entry["id"] for entry in listed]


def test_one_is_explained(moseg):
    assert moseg("objectives", "narrow").out == moseg("plugin", "explain", "basic:narrow").out


def test_a_name_that_is_none(moseg):
    for asked in ("narow", "kmeans"):  # a seeder is no objective
        run = moseg("objectives", asked)
        assert (run.code, run.out) == (2, "")
        assert run.err.startswith(f"moseg: unknown objective '{asked}'")
        assert "(see 'moseg objectives')" in run.err
