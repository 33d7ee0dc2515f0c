"""What the bundle offers."""

from __future__ import annotations

from cyclopts import App
from moseg_benchmark import plugin

from moseg_core import registry


def test_bundle_is_found_whole():
    bundle = next(b for b in registry().bundles if b.name == "benchmark")
    assert bundle.problem is None
    assert [c.spec for c in bundle.components] == plugin.moseg_commands()
    (component,) = bundle.components
    assert isinstance(component.load(), App)
