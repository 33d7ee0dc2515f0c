from __future__ import annotations

import json
import subprocess
import sys

from moseg_core import registry


def test_nothing_heavy_is_imported():
    code = (
        "import sys, json, moseg_learn.plugin as p;"
        "p.moseg_learners(), p.moseg_commands();"
        "print(json.dumps(sorted(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in json.loads(run.stdout)}
    assert "moseg_learn" in loaded
    assert not loaded & {"numpy", "scipy", "igl", "numba", "trimesh", "PIL"}


def test_bundle_is_found_whole():
    bundle = next(b for b in registry().bundles if b.name == "learn")
    assert bundle.problem is None
    for component in bundle.components:
        assert component.load() is not None
        assert component.spec.summary
    assert registry().find("learner", "profiles").id == "learn:profiles"
