"""``moseg plugin list``."""

from __future__ import annotations

import json

from moseg_core.components.discovery.registry import registry


def test_plugin_list(moseg):
    run = moseg("plugin", "list")
    assert run.code == 0
    for word in ("basic:narrow", "core:voronoi", "moseg-objectives-basic"):
        assert word in run.out
    listed = json.loads(moseg("plugin", "list", "--json").out)
    assert [bundle["name"] for bundle in listed] == [b.name for b in registry().bundles]
    assert all(
        bundle["problem"] is None for bundle in listed if bundle["name"] in ("core", "basic")
    )
