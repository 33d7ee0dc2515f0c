"""The module of a bundle that greets everybody who asks what is installed."""

from __future__ import annotations

from moseg_core.components.discovery.hookspecs import hookimpl
from moseg_core.components.discovery.specs import MeasureSpec

print("hello")


@hookimpl
def moseg_measures():
    return [MeasureSpec(name="broken", target="tests.testing.broken.heavy:spread")]
