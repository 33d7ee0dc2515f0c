"""A component that never returns, checked by the command line as its author would check it."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

BUNDLE = """
    from moseg_core import ObjectiveSpec, hookimpl

    @hookimpl
    def moseg_objectives():
        return [
            ObjectiveSpec(name="patient", target="endless_objectives:patient"),
            ObjectiveSpec(name="large", target="endless_objectives:large"),
        ]
"""
OBJECTIVES = '''
    import time

    from moseg_core import Part, objective

    @objective(range=(0, 1))
    def patient(part: Part) -> float:
        """Waits for better times."""
        while True:
            time.sleep(0.1)

    @objective(range=(0, 1))
    def large(part: Part) -> float:
        """Small for a part that is most of the shape."""
        return 1.0 - min(1.0, part.area / part.shape.area)
'''


@pytest.mark.slow
def test_it_is_ended_and_named_and_the_rest_goes_on(site):
    modules = {"endless": BUNDLE, "endless_objectives": OBJECTIVES}
    site.add("moseg-endless", bundles={"endless": "endless"}, **modules)
    words = ["plugin", "check", "endless", "--json", "--timeout", "40"]
    done = subprocess.run(
        [sys.executable, "-m", "moseg_core", *words],
        env=os.environ | {"PYTHONPATH": str(site.folder)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1, done.stderr
    assert "bundle 'endless' of moseg-endless 1.0 does not pass the contract checks" in done.stderr
    told = json.loads(done.stdout)["outcomes"]
    failed = [outcome for outcome in told if outcome["status"] == "failed"]
    assert [outcome["component"] for outcome in failed] == ["endless:patient"]
    assert failed[0]["message"].startswith("its process was ended after 40 s, in 'patient' (")
    assert "endless_objectives.py, line" in failed[0]["message"]
    other = [outcome["status"] for outcome in told if outcome["component"] == "endless:large"]
    assert "passed" in other
    assert "failed" not in other
