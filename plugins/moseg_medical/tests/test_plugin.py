from __future__ import annotations

import json
import subprocess
import sys

from moseg_medical import plugin

from moseg_core import registry


def test_nothing_heavy_is_imported():
    code = (
        "import sys, json, moseg_medical.plugin as p;"
        "p.moseg_readers(), p.moseg_writers();"
        "print(json.dumps(sorted(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in json.loads(run.stdout)}
    assert "moseg_medical" in loaded
    assert not loaded & {"numpy", "nibabel", "nrrd"}


def test_bundle_is_found_whole():
    bundle = next(b for b in registry().bundles if b.name == "medical")
    assert bundle.problem is None
    assert {c.spec for c in bundle.components} == {
        *plugin.moseg_readers(),
        *plugin.moseg_writers(),
    }
    for component in bundle.components:
        assert component.load() is not None
        assert component.spec.summary
    assert registry().by_suffix("reader", ".scan.nii.gz").id == "medical:nifti"
    assert registry().by_suffix("writer", ".seg.nrrd").id == "medical:nrrd"
