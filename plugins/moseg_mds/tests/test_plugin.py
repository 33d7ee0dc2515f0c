from __future__ import annotations

import json
import subprocess
import sys

from moseg_mds import plugin
from moseg_mds.embedding import MDS

from moseg_core import registry


def test_nothing_heavy_is_imported():
    code = (
        "import sys, json, moseg_mds.plugin as p;"
        "p.moseg_embeddings(), p.moseg_commands();"
        "print(json.dumps(sorted(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in json.loads(run.stdout)}
    assert "moseg_mds" in loaded
    assert not loaded & {"numpy", "scipy", "igl", "numba", "trimesh", "PIL"}


def test_bundle_is_found_whole():
    bundle = next(b for b in registry().bundles if b.name == "mds")
    assert bundle.problem is None
    offered = plugin.moseg_embeddings() + plugin.moseg_commands() + plugin.moseg_recipes()
    assert {c.spec for c in bundle.components} == set(offered)
    for component in bundle.components:
        assert component.load() is not None
        assert component.spec.summary
    assert registry().find("embedding", "mds").load() is MDS


def test_only_the_core_of_libigl_is_imported():
    code = (
        "import sys, moseg_mds.embedding;"
        "print(*(name for name in sys.modules if name.startswith('igl')))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    modules = run.stdout.split()
    assert "igl" in modules
    assert not [name for name in modules if "copyleft" in name or "triangle" in name]
