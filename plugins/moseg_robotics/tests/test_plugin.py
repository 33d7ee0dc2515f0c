from __future__ import annotations

import json
import subprocess
import sys

from moseg_robotics import plugin

from moseg_core import registry


def test_nothing_heavy_is_imported():
    code = (
        "import sys, json, moseg_robotics.plugin as p; p.moseg_writers();"
        "print(json.dumps(sorted(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in json.loads(run.stdout)}
    assert "moseg_robotics" in loaded
    assert not loaded & {"numpy", "scipy", "trimesh", "numba", "PIL"}


def test_bundle_is_found_whole():
    bundle = next(b for b in registry().bundles if b.name == "robotics")
    assert bundle.problem is None
    assert {c.spec for c in bundle.components} == set(plugin.moseg_writers())
    for suffix in (".urdf", ".mjcf"):
        component = registry().by_suffix("writer", suffix)
        assert component.spec.summary
        assert component.load() is not None
