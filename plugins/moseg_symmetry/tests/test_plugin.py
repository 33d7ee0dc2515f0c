from __future__ import annotations

import json
import subprocess
import sys

import pytest
from moseg_symmetry import plugin

from moseg_core import registry


def test_nothing_heavy_is_imported():
    code = (
        "import sys, json, moseg_symmetry.plugin as p, moseg_symmetry.command;"
        "p.moseg_constraints(), p.moseg_commands();"
        "print(json.dumps(sorted(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in json.loads(run.stdout)}
    assert "moseg_symmetry" in loaded
    assert not loaded & {"numpy", "scipy", "igl", "numba", "trimesh", "PIL"}


def test_bundle_is_found_whole():
    bundle = next(b for b in registry().bundles if b.name == "symmetry")
    assert bundle.problem is None
    offered = plugin.moseg_constraints() + plugin.moseg_commands() + plugin.moseg_recipes()
    assert {c.spec for c in bundle.components} == set(offered)
    for component in bundle.components:
        assert component.load() is not None
        assert component.spec.summary


@pytest.mark.parametrize("name", ["mirror", "on_plane"])
def test_constraints_by_name(name):
    target = registry().find("constraint", name).load()
    assert registry().find("constraint", f"symmetry:{name}").load() is target
