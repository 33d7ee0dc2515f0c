"""Distributions that disagree, and objectives that fail, return NaN or hang, as a user meets them.

Each test shows the message, and that the rest goes on. Distributions that cannot be imported or
misspell a hook are met in ``test_broken_distribution.py``.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from moseg_core import __version__, load
from moseg_core.io.result_json import read_result
from tests import shapes
from tests.conftest import Site

BUNDLE = """
    from moseg_core import ObjectiveSpec, hookimpl

    moseg_contract = {contract}

    @hookimpl
    def moseg_objectives():
        names = {names}
        return [ObjectiveSpec(name=name, target="{module}:" + name) for name in names]
"""
MOODY = """
    import itertools, math, os, time

    from moseg_core import Part, objective

    calls = itertools.count()

    @objective(range=(0, 1))
    def slender(part: Part) -> float:
        return float(part.scales[1] / part.scales[0])

    @objective(range=(0, 1))
    def grumpy(part: Part) -> float:
        if next(calls) > 15:
            raise ValueError("not today")
        return float(part.scales[1] / part.scales[0])

    @objective(range=(0, 1))
    def dizzy(part: Part) -> float:
        return math.nan if next(calls) > 15 else float(part.scales[1] / part.scales[0])

    @objective(range=(0, 1))
    def leaving(part: Part) -> float:
        if next(calls) > 15:
            raise SystemExit(0)
        return float(part.scales[1] / part.scales[0])

    @objective(range=(0, 1))
    def crashing(part: Part) -> float:
        if next(calls) > 15:
            os.abort()
        return float(part.scales[1] / part.scales[0])

    @objective(range=(0, 1))
    def sleepy(part: Part) -> float:
        while not os.path.exists(os.environ["WAKE"]):
            time.sleep(0.01)
        return 0.5
"""


MOODS = ("slender", "grumpy", "dizzy", "leaving", "crashing", "sleepy")


def add(site, distribution, version, namespace, names, *, contract=1, module="moody"):
    source = BUNDLE.format(contract=contract, names=repr(names), module=module)
    plugin = f"{distribution.replace('-', '_')}_bundle"
    site.add(distribution, version, bundles={namespace: plugin}, **{plugin: source})


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Two rivals for one namespace, a bundle of the future, and one of moody objectives."""
    site = Site(tmp_path_factory.mktemp("site"))
    add(site, "moseg-acme", "1.4.0", "acme", [*MOODS])
    add(site, "moseg-vessels", "1.0", "vessels", ["slender"])
    add(site, "angio-tools", "0.3", "vessels", ["slender"])
    add(site, "moseg-future", "8.0", "future", ["slender"], contract=9)
    (site.folder / "moody.py").write_text("\n".join(line[4:] for line in MOODY.splitlines()))
    vertices, faces = shapes.tee()
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(f"{x:g}" for x in vertex) for vertex in vertices]
    lines += [f"{len(face)} {' '.join(map(str, face))}" for face in faces]
    (site.folder / "tee.off").write_text("\n".join(lines) + "\n")
    return site.folder


@pytest.fixture
def command(folder, tmp_path):
    """The arguments of a process that sees the distributions."""

    def prepared(*words, code="from moseg_core.cli import main; main()", **variables):
        path = os.pathsep.join(filter(None, [str(folder), os.environ.get("PYTHONPATH")]))
        hidden = ("MOSEG_PLUGINS", "MOSEG_STRICT")
        environment = {k: v for k, v in os.environ.items() if k not in hidden}
        return {
            "args": [sys.executable, "-c", code, *map(str, words)],
            "env": environment | {"PYTHONPATH": path} | variables,
            "cwd": tmp_path,
            "text": True,
        }

    return prepared


@pytest.fixture
def moseg(command):
    def run(*words, code=0, **variables):
        done = subprocess.run(**command(*words, **variables), capture_output=True)
        assert done.returncode == code, done.stderr
        assert "Traceback" not in done.stderr
        return done

    return run


def segmenting(folder, minimize, *more):
    few = ("--optimizer", "pattern_search(max_evaluations=300)")
    named = ("--labels", "stem,bar", "--minimize", minimize)
    return ("segment", folder / "tee.off", *named, *few, *more)


RIVALRY = "the namespace 'vessels' is claimed by angio-tools 0.3 and moseg-vessels 1.0"
FUTURE = (
    f"moseg-future 8.0: it was written for contract 9, and moseg-core {__version__} accepts 1;"
    " install a newer moseg-core, or a moseg-future for contract 1"
)


def test_the_list_says_what_is_set_aside_and_why(moseg):
    text = " ".join(moseg("plugin", "list").stdout.split())
    advice = "uninstall one of them"
    assert f"set aside: angio-tools 0.3: {RIVALRY}; {advice}" in text
    assert f"set aside: moseg-vessels 1.0: {RIVALRY}; {advice}" in text
    assert f"set aside: {FUTURE}" in text
    assert text.count("set aside:") == 3
    assert "objective acme:slender" in text
    bundles = json.loads(moseg("plugin", "list", "--json").stdout)
    assert {b["name"]: b["contract"] for b in bundles}["future"] == 9


def test_everything_else_goes_on(moseg, folder):
    done = moseg(*segmenting(folder, "acme:slender(stem) + narrow(bar)", "--json"))
    assert {part["label"] for part in json.loads(done.stdout)["parts"]} == {"stem", "bar"}
    assert "set aside" not in done.stderr


@pytest.mark.parametrize(("name", "reason"), [("vessels", RIVALRY), ("future", FUTURE)])
def test_who_asks_for_one_of_them_is_told(moseg, folder, name, reason):
    done = moseg(*segmenting(folder, f"{name}:slender(stem)"), code=1)
    assert f"bundle '{name}' is set aside: " in done.stderr
    assert reason in done.stderr


def test_strictly_each_of_them_is_an_error(moseg, folder):
    for words in (("plugin", "list"), segmenting(folder, "narrow(bar)")):
        done = moseg(*words, code=1, MOSEG_STRICT="1")
        assert done.stdout == ""
        assert done.stderr.startswith("moseg: 3 bundles are set aside, and MOSEG_STRICT is 1: ")
        assert RIVALRY in done.stderr
        assert FUTURE in done.stderr
    moseg("plugin", "list", MOSEG_STRICT="1", MOSEG_PLUGINS="acme,basic")


def test_a_distribution_that_is_there_twice_is_listed_once_with_a_note(moseg, folder, tmp_path):
    ahead = Site(tmp_path / "ahead")
    ahead.folder.mkdir()
    add(ahead, "moseg-acme", "2.0", "acme", ["slender"])
    path = os.pathsep.join([str(ahead.folder), str(folder)])
    bundles = json.loads(moseg("plugin", "list", "--json", PYTHONPATH=path).stdout)
    (acme,) = [bundle for bundle in bundles if bundle["name"] == "acme"]
    assert (acme["version"], acme["problem"], len(acme["components"])) == ("2.0", None, 1)
    text = " ".join(moseg("plugin", "list", PYTHONPATH=path).stdout.split())
    assert (
        f"note: moseg-acme is installed 2 times, 2.0 in {ahead.folder} and 1.4.0 in {folder};"
        f" Python imports 2.0 in {ahead.folder}, so that one is used; uninstall the rest"
    ) in text


# --- objectives that fail in the middle of a search


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("grumpy", r"failed in 'grumpy\(bar\)' for bar: ValueError: not today \(\S*:\d+: .*\)"),
        ("leaving", r"failed in 'leaving\(bar\)' for bar: SystemExit: 0 \(\S*:\d+: .*\)"),
        ("dizzy", r"returned nan in 'dizzy\(bar\)' for bar; values must be finite"),
    ],
)
@pytest.mark.parametrize("workers", ["1", "2"])
def test_the_best_so_far_is_written_and_the_failure_told(
    moseg, folder, tmp_path, name, what, workers
):
    out = tmp_path / "tee.json"
    options = ("--restarts", "2", "--workers", workers, "-o", out)
    done = moseg(*segmenting(folder, f"slender(stem) + {name}(bar)", *options), code=1)
    assert re.fullmatch(
        rf"moseg: objective 'acme:{name}' of moseg-acme 1\.4\.0 {what}; report it to its authors,"
        " or do without it",
        done.stderr.splitlines()[-1],
    )
    assert f"; wrote {out}" in done.stderr
    assert "moseg: warning: the run failed; this is the best that it had found" in done.stderr
    saved = json.loads(out.read_text())
    assert saved["reason"] == "failed"
    assert len(saved["labels"]) == load(folder / "tee.off").n_elements
    assert read_result(out).names == ("stem", "bar")


def test_a_crash_in_a_worker_process_names_the_component(moseg, folder, tmp_path):
    out = tmp_path / "tee.json"
    options = ("--restarts", "2", "--workers", "2", "-o", out)
    done = moseg(*segmenting(folder, "slender(stem) + crashing(bar)", *options), code=1)
    assert (
        "moseg: a worker process ended early (signal 6) while objective 'acme:crashing' of"
        " moseg-acme 1.4.0 in 'crashing(bar)' for bar was at work"
    ) in done.stderr


def test_nothing_is_printed_of_a_failed_run_that_no_file_was_wanted_of(moseg, folder):
    done = moseg(*segmenting(folder, "grumpy(bar)", "--json"), code=1)
    assert done.stdout == ""
    assert "ValueError: not today" in done.stderr


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_slow_term_is_named_while_it_is_waited_for(command, folder, tmp_path, workers):
    """The objective sleeps until the message has been read."""
    wake = tmp_path / "wake"
    impatient = (
        "import moseg_core.cli.segment as segment; from moseg_core.cli import main;"
        "segment.PATIENCE = 0.0; main()"
    )
    words = segmenting(folder, "slender(stem) + sleepy(bar)", "--workers", workers)
    prepared = command(*words, "--restarts", "2", code=impatient, WAKE=str(wake))
    with subprocess.Popen(**prepared, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL) as run:
        for line in run.stderr:
            if "'sleepy(bar)'" in line:
                break
        wake.touch()
        run.communicate()
    assert line.startswith(
        "moseg: waiting for objective 'acme:sleepy' of moseg-acme 1.4.0 in 'sleepy(bar)' for "
    )
    assert line.endswith(" s so far\n")
    assert run.returncode == 0
