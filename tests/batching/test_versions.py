"""What a process is made of, and how a difference is told."""

from __future__ import annotations

import platform

import numpy as np

from moseg_core.batching.versions import difference, own_versions
from moseg_core.components.discovery.registry import registry


def test_python_libraries_and_all_bundles_are_told():
    found = own_versions()
    assert found["python"] == platform.python_version()
    assert found["numpy"] == np.__version__
    assert {bundle.distribution for bundle in registry().bundles} <= set(found)


def test_a_bundle_that_is_set_aside_differs_from_one_that_is_not(site):
    registry.cache_clear()
    site.add("odd", bundles={"odd": "odd_bundle"}, odd_bundle="raise ValueError('no')")
    try:
        assert own_versions()["odd"] == "1.0 (set aside)"
    finally:
        registry.cache_clear()


def test_equal_versions_do_not_differ():
    assert difference({"a": "1", "b": "2"}, {"b": "2", "a": "1"}) == ""
    assert difference({"a": "1"}, {"a": "1", "b": "2"}) == "b is missing here and 2 there"
