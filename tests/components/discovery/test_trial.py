"""The child that imports bundles first: what it reports."""

from __future__ import annotations

import json
import os
import subprocess
import sys

from moseg_core.components.discovery.distributions import read_claims
from moseg_core.components.discovery.first_import import SOUND
from moseg_core.components.discovery.known_bundles import identity

LOUD = """
import loud_help
print("hello")
"""
SEEDS = """
import numpy as np
np.random.seed(1)
"""


def events(site, *names):
    """What the child writes of bundles, and its exit code."""
    known = {claim.point.name: identity(claim) for claim in read_claims(site.entry_points())}
    wanted = json.dumps([known.get(name, name) for name in names])
    read, write = os.pipe()
    code = "import sys; from moseg_core.components.discovery.trial import main; main(sys.argv[1:])"
    done = subprocess.run(
        [sys.executable, "-c", code, str(write), "60", wanted],
        pass_fds=(write,),
        env={**os.environ, "PYTHONPATH": f"{site.folder}{os.pathsep}{os.getcwd()}"},
    )
    os.close(write)
    with os.fdopen(read) as pipe:
        return [json.loads(line) for line in pipe], done.returncode


def test_each_is_reported_before_and_after(site):
    site.add("Loud", bundles={"loud": "loud_bundle"}, loud_bundle=LOUD, loud_help="")
    found, code = events(site, "gone", "loud")
    assert code == SOUND
    assert [(event["event"], event["index"]) for event in found] == [("begin", 1), ("end", 1)]
    end = found[1]
    assert (end["problem"], end["printed"]) == ("", "hello")
    files = {os.path.basename(file) for file in end["files"]}
    assert files == {"loud_bundle.py", "loud_help.py"}


def test_it_ends_after_one_that_has_changed_something(site):
    site.add("Loud", bundles={"loud": "loud_bundle"}, loud_bundle=LOUD, loud_help="")
    site.add("Seeds", bundles={"seeds": "seeds_bundle"}, seeds_bundle=SEEDS)
    found, code = events(site, "seeds", "loud")
    assert code == SOUND
    assert [event["event"] for event in found] == ["begin", "end"]
    assert found[1]["problem"] == "changes the global generator of numpy.random"
