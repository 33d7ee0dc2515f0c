"""The planted bundle, installed for this process and for those that it starts."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.registry import registry
from tests.batching import planted


@pytest.fixture
def planted_bundle(site, monkeypatch):
    """Install the bundle; its folder."""
    modules = {"planted_bundle": planted.BUNDLE, "planted_objective": planted.OBJECTIVE}
    site.add("planted", bundles={"planted": "planted_bundle"}, **modules)
    monkeypatch.setenv("PYTHONPATH", str(site.folder))
    registry.cache_clear()
    yield site.folder
    registry.cache_clear()


@pytest.fixture
def shape_folder(tmp_path, monkeypatch):
    """A folder for shapes, in the working directory of the test."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "models"
    folder.mkdir()
    return folder
