"""A component that never returns, checked by the command line as its author would check it."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

MODULE = '''
    import time

    from moseg_core import LabelerSpec, SeederSpec, hookimpl

    @hookimpl
    def moseg_seeders():
        return [SeederSpec(name="patient", target="endless:Patient")]

    @hookimpl
    def moseg_labelers():
        return [LabelerSpec(name="plain", target="endless:Plain")]

    class Patient:
        """Waits for better times."""

        def __call__(self, evaluator, *, rng, report):
            while True:
                time.sleep(0.1)

    class Plain:
        """Optimal on single parts."""

        def __call__(self, evaluator, vector):
            return evaluator.unary_costs(vector).assign()
'''


@pytest.mark.slow
def test_it_is_ended_and_named_and_the_rest_goes_on(site):
    site.add("moseg-endless", bundles={"endless": "endless"}, endless=MODULE)
    words = ["plugin", "check", "endless", "--json", "--timeout", "15"]
    done = subprocess.run(
        [sys.executable, "-m", "moseg_core", *words],
        env=os.environ | {"PYTHONPATH": str(site.folder)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1, done.stderr
    assert "bundle 'endless' of moseg-endless 1.0 does not keep the contract" in done.stderr
    told = json.loads(done.stdout)["outcomes"]
    failed = [outcome for outcome in told if outcome["status"] == "failed"]
    assert [outcome["component"] for outcome in failed] == ["endless:patient"]
    assert failed[0]["message"].startswith("its process was ended after 15 s, in '__call__' (")
    assert "endless.py, line" in failed[0]["message"]
    labeler = [o["status"] for o in told if o["component"] == "endless:plain"]
    assert "passed" in labeler
    assert "failed" not in labeler
