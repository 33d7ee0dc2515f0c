"""Children with hash seeds of their own: what they answer, and what becomes of them."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

from moseg_core.components.discovery.registry import registry
from moseg_core.components.discovery.specs import MeasureSpec
from moseg_core.testing import Subject
from moseg_core.testing.fixtures.comparison import difference
from moseg_core.testing.fixtures.drivers import drive
from moseg_core.testing.processes import other_hash_seed
from moseg_core.testing.processes.other_hash_seed import ChildError, drive_elsewhere
from tests.testing.outcomes import subject


def measure(target):
    return subject(MeasureSpec(name="mine", target=target))


def test_another_process_gives_the_same():
    narrow = Subject(component=registry().find("objective", "narrow"), registry=registry())
    assert difference(drive(narrow), drive_elsewhere(narrow, hash_seed=1), tolerance=1e-9) == ""


def test_another_process_has_other_hashes():
    found = measure("tests.testing.broken.repeats:by_hash")
    first, second = (drive_elsewhere(found, hash_seed=seed) for seed in (1, 2))
    assert difference(first, second)


def test_a_child_that_dies_is_named_and_started_anew():
    with pytest.raises(ChildError, match="ended"):
        drive_elsewhere(measure("tests.testing.odd:end"), hash_seed=1)
    with pytest.raises(ChildError, match="not_there"):
        drive_elsewhere(measure("tests.testing.broken.heavy:not_there"), hash_seed=1)


def test_what_a_component_prints_gets_in_nobody_s_way(capfd):
    found = drive_elsewhere(measure("tests.testing.broken.repeats:prints"), hash_seed=1)
    assert found
    assert capfd.readouterr() == ("", "")


def test_a_child_serves_all_components_and_ends_with_its_parent():
    drive_elsewhere(measure("tests.testing.broken.heavy:spread"), hash_seed=1)
    child = other_hash_seed._CHILDREN[1]
    drive_elsewhere(measure("tests.testing.broken.heavy:spread"), hash_seed=1)
    assert other_hash_seed._CHILDREN.pop(1) is child
    assert child._process.poll() is None
    child.pipe.close()
    assert child._process.wait(timeout=60) == 0


def test_a_parent_that_is_killed_leaves_no_child():
    code = (
        "import os, sys; sys.path.insert(0, os.getcwd());"
        "from moseg_core.testing.processes.other_hash_seed import _Child;"
        "print(_Child(3)._process.pid, flush=True); sys.stdin.read()"
    )
    command = [sys.executable, "-c", code]
    parent = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    pid = int(parent.stdout.readline())
    parent.kill()
    parent.communicate()
    end = time.monotonic() + 60
    while time.monotonic() < end and _runs(pid):
        time.sleep(0.05)
    assert not _runs(pid)


def _runs(pid):
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
