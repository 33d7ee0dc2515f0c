"""The small files that readers are tried on: one for each suffix, and each is read."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.registry import registry
from moseg_core.io.files import load
from moseg_core.io.read.examples import _MAKERS, example


def test_there_are_examples_of_all_formats():
    core = (c for c in registry().components("reader") if c.bundle == "core")
    assert set(_MAKERS) == {suffix for component in core for suffix in component.spec.suffixes}
    assert example(".doc") is None


@pytest.mark.parametrize("suffix", _MAKERS)
def test_each_is_read(tmp_path, suffix):
    path = tmp_path / f"corner{suffix}"
    path.write_bytes(example(suffix))
    shape = load(path)
    assert shape.n_elements == (27 if suffix in (".npy", ".binvox") else 4)
    if suffix in (".off", ".ply", ".obj", ".stl", ".glb", ".gltf"):
        assert shape.volume == pytest.approx(1 / 6)
