"""The garbage collector rests while a command imports."""

from __future__ import annotations

import gc
import subprocess
import sys

import pytest

from moseg_core.cli.collection import importing


@pytest.fixture
def thawed():
    yield
    gc.unfreeze()
    gc.enable()


def test_what_was_made_meanwhile_is_passed_over_afterwards(thawed):
    before = gc.get_freeze_count()
    with importing():
        kept = [[k] for k in range(1000)]
        assert not gc.isenabled()
    assert gc.isenabled()
    assert gc.get_freeze_count() >= before + len(kept)


def test_a_collector_that_rests_already_is_not_woken(thawed):
    gc.disable()
    with importing():
        pass
    assert not gc.isenabled()


def test_an_import_that_fails_wakes_it(thawed):
    with pytest.raises(ImportError), importing():
        raise ImportError
    assert gc.isenabled()


def test_a_command_imports_at_rest_and_runs_awake():
    """The program's own collector: on while it works, and all is passed over when it ends."""
    code = (
        "import atexit, gc, sys\n"
        "atexit.register(lambda: print('at exit', gc.get_freeze_count() > 10 * len(sys.modules)))\n"
        "import moseg_core.cli\ntry:\n    moseg_core.cli.main()\n"
        "finally:\n    print('awake', gc.isenabled())\n"
    )
    done = subprocess.run([sys.executable, "-c", code, "recipes"], capture_output=True, text=True)
    assert done.stdout.splitlines()[-2:] == ["awake True", "at exit True"], done.stderr
