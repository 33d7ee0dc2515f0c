"""Bundles that are imported by a child first, and what becomes of them."""

from __future__ import annotations

import os
import random
import re
import signal
import sys
from pathlib import Path
from textwrap import dedent

import pytest

from moseg_core.components.discovery import first_import, known_bundles
from moseg_core.components.discovery.distributions import read_claims
from moseg_core.components.discovery.first_import import IN_TRIAL, can_try, try_bundles, verdicts
from moseg_core.components.discovery.registry import discover

OFFER = """
from moseg_core import ObjectiveSpec, hookimpl
@hookimpl
def moseg_objectives():
    return [ObjectiveSpec(name="slim", target="nowhere_at_all:slim")]
"""

#: What a bundle's module does, and what is said of it; None where it is imported as ever.
DEEDS = {
    "aborts": (
        "import os; os.abort()",
        r"died of SIGABRT \(.*aborts_bundle\.py:1: \"import os; os",
    ),
    "copies": (
        "import os; os.fork()",
        "copies the process",
    ),
    "ends": ("import os; os._exit(0)", "ended the process with exit code 0"),
    "goes": ("import os; os.chdir('/')", r"changes the working directory \(from .* to /\)"),
    "hangs": ("while True: pass", r"took more than 3 s \(.*hangs_bundle\.py:1: \"while True"),
    "kept": ("import os; hook = os._exit", None),
    "presses": ("raise KeyboardInterrupt", None),
    "prints": ("print('hello'); print('again')", None),
    "raises": ("raise ImportError('no such thing')", None),
    "seeds": ("import random; random.seed(1)", "changes the global generator of random"),
    "sets": (
        "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN)",
        r"changes the handlers of signals \(SIGTERM\)",
    ),
    "starts": (
        "import threading, time\nthreading.Thread(target=time.sleep, args=(99,), name='t').start()",
        r"changes the threads that run \(left running: t\)",
    ),
    "draws": ("import random; random.random()", None),
    "zz_at_last": (
        "import atexit, os; atexit.register(os._exit, 0)",
        "ended the process with exit code 0, as the process came to its end",
    ),
}


def add(site, name, deed):
    module = f"{name}_bundle"
    site.add(f"Odd-{name}", bundles={name: module}, **{module: dedent(deed) + OFFER})


def claims_of(site):
    return read_claims(site.entry_points())


@pytest.fixture
def remembered(tmp_path, monkeypatch):
    """A record of its own, which is empty."""
    monkeypatch.setattr(known_bundles, "record_folders", lambda: [str(tmp_path / "cache")])
    return tmp_path / "cache" / "moseg-bundles.json"


def test_each_gets_what_it_deserves_and_the_rest_goes_on(site):
    for name, (deed, _) in DEEDS.items():
        add(site, name, deed)
    here, state, terminated = Path.cwd(), random.getstate(), signal.getsignal(signal.SIGTERM)
    claims = claims_of(site)
    found = dict(zip([c.point.name for c in claims], try_bundles(claims, timeout=3), strict=True))
    assert set(found) == set(DEEDS)
    for name, (_, said) in DEEDS.items():
        if said is None:
            assert found[name].problem == "", name
        else:
            assert found[name].problem.startswith(f"importing '{name}_bundle' "), name
            assert re.search(said, found[name].problem), found[name].problem
    assert found["prints"].printed == "hello again"
    assert not {f"{name}_bundle" for name in DEEDS} & set(sys.modules)
    assert (Path.cwd(), random.getstate()) == (here, state)
    assert signal.getsignal(signal.SIGTERM) is terminated


def test_what_is_set_aside_is_told_and_what_prints_has_a_note(site, remembered, capfd):
    add(site, "prints", "import os; print('hello'); os.write(1, b'below')")
    add(site, "ends", "import os; os._exit(3)")
    prints_after_all = discover(site.entry_points(), judge=verdicts)
    ends, prints = prints_after_all.bundles
    assert ends.problem == (
        "Odd-ends 1.0: importing 'ends_bundle' ended the process with exit code 3; update or"
        " reinstall Odd-ends, or uninstall it"
    )
    assert prints.problem is None
    assert prints.note == "printed when it was imported, and left out: 'belowhello'"
    assert prints_after_all.find("objective", "prints:slim")
    assert capfd.readouterr().out == ""


def test_what_is_known_is_not_tried_again_until_its_files_change(site, remembered, monkeypatch):
    add(site, "fine", "")
    (claim,) = claims_of(site)
    tried = []

    def trying(claims, *, timeout):
        tried.append([c.point.name for c in claims])
        return try_bundles(claims, timeout=timeout)

    monkeypatch.setattr(first_import, "try_bundles", trying)
    file = site.folder / "fine_bundle.py"
    for _ in range(2):
        assert verdicts([claim])[0].problem == ""
    assert tried == [["fine"]]
    file.write_text("import os; os._exit(1)\n")
    for _ in range(2):
        assert "exit code 1" in verdicts([claim])[0].problem
    assert len(tried) == 2
    (site.folder / "another.py").write_text("")  # something was installed: perhaps it helps
    file.write_text(OFFER)
    assert verdicts([claim])[0].problem == ""
    assert len(tried) == 3


def test_where_nothing_can_be_remembered_it_is_tried_each_time(site, monkeypatch):
    monkeypatch.setattr(known_bundles, "record_folders", lambda: ["/proc/no/such"])
    add(site, "ends", "import os; os._exit(1)")
    for _ in range(2):
        assert "exit code 1" in verdicts(claims_of(site))[0].problem


@pytest.mark.parametrize("program", ["", "/usr/bin/blender"])
def test_where_there_is_no_python_no_child_is_started(program, monkeypatch):
    monkeypatch.setattr(sys, "executable", program)
    assert not can_try()


def test_a_child_starts_no_child(site, monkeypatch):
    monkeypatch.setitem(os.environ, IN_TRIAL, "1")
    add(site, "ends", "import os; os._exit(1)")
    assert verdicts(claims_of(site))[0].problem == ""
