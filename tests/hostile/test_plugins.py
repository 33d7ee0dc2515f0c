"""Bundles and components that misbehave, as a user of the command line meets them.

Each is a folder on ``PYTHONPATH`` with a distribution of one bundle, and at most an objective
``bad``. None may end a command without a word, or take its output elsewhere.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests import shapes

Run = Callable[..., subprocess.CompletedProcess[str]]

BUNDLE = """
from moseg_core import ObjectiveSpec, hookimpl
moseg_contract = 1
@hookimpl
def moseg_objectives():
    return [ObjectiveSpec(name="bad", target="h5_{name}_obj:bad", summary="a test")]
"""
OBJECTIVE = """
from moseg_core import Part, objective
@objective(range=(0, 1))
def bad(part: Part) -> float:
    {deed}
    return 0.5
"""
EVIL_REPR = """
from moseg_core import hookimpl
@hookimpl
def moseg_objectives():
    class R:
        def __repr__(self): raise RuntimeError("repr")
    return [R()]
"""
WRITERS = """
from moseg_core import WriterSpec, hookimpl
@hookimpl
def moseg_writers():
    return [WriterSpec(name="w", target="h5_h_writer_gone:w", suffixes=(".bad",))]
"""

#: What the modules of bundles do when they are imported, and what is said of it.
AT_IMPORT = {
    "i_osexit": ("import os; os._exit(0)", "ended the process with exit code 0"),
    "i_segv": ("import ctypes; ctypes.string_at(0)", "died of SIGSEGV ("),
    "i_base": ("class B(BaseException): pass\nraise B('boom')", "failed with B: boom"),
    "i_chdir": ("import os; os.chdir('/')", "changes the working directory"),
    "i_random": ("import random; random.seed(1)", "changes the global generator of random"),
    "h_evilrepr": (EVIL_REPR, "returned a R, which cannot be shown, not a ObjectiveSpec"),
}
#: What objectives do when they are called, and what is said of it.
AT_WORK = {
    "o_exit": ("raise SystemExit(0)", 'SystemExit: 0 ({file}:5: "raise SystemExit(0)")'),
    "o_osexit": ("import os; os._exit(0)", "os._exit(0) ("),
    "o_chdir": ("import os; os.chdir('/')", "changed the working directory (from "),
    "o_random": (
        "import numpy as np, random; np.random.seed(1); random.seed(1)",
        "changed the global generator of random",
    ),
}


def install(folder: Path, name: str, module: str, deed: str = "pass") -> None:
    site = folder / name
    info = site / f"h5_{name}-1.0.dist-info"
    info.mkdir(parents=True)
    distribution = f"h5-{name.replace('_', '-')}"
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[moseg]\n{name} = h5_{name}\n")
    offers = "" if "hookimpl" in module else BUNDLE.format(name=name)
    (site / f"h5_{name}.py").write_text(f"{module}\n{offers}")
    (site / f"h5_{name}_obj.py").write_text(OBJECTIVE.format(deed=deed))


@pytest.fixture(scope="module")
def sites(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sites")
    for name, (module, _) in AT_IMPORT.items():
        install(folder, name, module)
    install(folder, "i_print", 'print("hello from a plugin")')
    install(folder, "h_writer", WRITERS)
    for name, (deed, _) in AT_WORK.items():
        install(folder, name, "", deed)
    install(folder, "o_print", "", 'print("hello"); import os; os.write(2, b"")')
    install(folder, "o_segv", "", "import ctypes; ctypes.string_at(0)")
    return folder


@pytest.fixture(scope="module")
def tee(tmp_path_factory: pytest.TempPathFactory) -> Path:
    vertices, faces = shapes.tee()
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(f"{x:g}" for x in vertex) for vertex in vertices]
    lines += [f"{len(face)} {' '.join(map(str, face))}" for face in faces]
    path = tmp_path_factory.mktemp("meshes") / "tee.off"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture
def moseg(sites: Path, tmp_path: Path) -> Run:
    """Run a command line in a process that sees some of them."""

    def run(*arguments: str | Path, sees: list[str], **variables: str):
        path = os.pathsep.join([*(str(sites / name) for name in sees), os.getcwd()])
        done = subprocess.run(
            [sys.executable, "-m", "moseg_core", *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": path} | variables,
            timeout=300,
        )
        assert "Traceback" not in done.stderr
        return done

    return run


SEARCH = ("--labels", "stem,bar", "--optimizer", "pattern_search(max_evaluations=20)", "--json")


def test_what_happens_at_import_is_told_of_each_and_the_rest_goes_on(moseg, tmp_path):
    names = [*AT_IMPORT, "i_print", "h_writer", "o_exit"]
    done = moseg("plugin", "list", "--json", sees=names, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    assert (done.returncode, done.stderr) == (0, "")
    found = {bundle["name"]: bundle for bundle in json.loads(done.stdout)}
    for name, (_, said) in AT_IMPORT.items():
        assert said in found[name]["problem"], name
        assert found[name]["problem"].startswith(f"h5-{name.replace('_', '-')} 1.0: ")
        assert not found[name]["components"]
    note = "printed when it was imported, and left out: 'hello from a plugin'"
    assert found["i_print"]["note"] == note
    for name in ("core", "basic", "i_print", "h_writer", "o_exit"):
        assert found[name]["problem"] is None
        assert found[name]["components"]
    # With everything that is known now, and without all of it.
    again = moseg("plugin", "list", "--json", sees=names, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    assert again.stdout == done.stdout
    alone = moseg("plugin", "list", "--json", "--no-plugins", sees=names)
    assert [bundle["name"] for bundle in json.loads(alone.stdout)] == ["core"]


def test_who_asks_for_one_that_is_set_aside_is_told(moseg, tee):
    done = moseg("segment", tee, *SEARCH, "--minimize", "i_osexit:bad(stem)", sees=["i_osexit"])
    assert (done.returncode, done.stdout) == (1, "")
    assert "bundle 'i_osexit' is set aside: h5-i-osexit 1.0: importing" in done.stderr


@pytest.mark.parametrize("name", AT_WORK)
def test_what_happens_at_work_ends_the_run_with_the_name(moseg, tee, sites, name):
    said = AT_WORK[name][1].format(file=sites / name / f"h5_{name}_obj.py")
    minimize = f"narrow(bar) + {name}:bad(stem)"
    done = moseg("segment", tee, *SEARCH, "--minimize", minimize, "-o", "r.json", sees=[name])
    assert done.returncode == 1
    assert f"objective '{name}:bad' of h5-{name.replace('_', '-')} 1.0 " in done.stderr
    assert said in done.stderr
    assert not Path("/r.json").exists()


def test_what_an_objective_prints_does_not_break_the_output(moseg, tee):
    done = moseg("segment", tee, *SEARCH, "--minimize", "o_print:bad(stem)", sees=["o_print"])
    assert done.returncode == 0
    assert json.loads(done.stdout)["parts"]
    said = "objective 'o_print:bad' of h5-o-print 1.0 prints on standard output: 'hello'; left out"
    assert done.stderr.count(said) == 1


def test_a_segfault_in_a_check_shows_the_line_of_the_author(moseg, sites):
    done = moseg("plugin", "check", "o_segv", "--json", sees=["o_segv"])
    assert done.returncode == 1
    failed = [o for o in json.loads(done.stdout)["outcomes"] if o["status"] == "failed"]
    assert len(failed) == 1
    file = sites / "o_segv" / "h5_o_segv_obj.py"
    line = f"died of SIGSEGV in 'bad', {file}:5: \"import ctypes; ctypes.string_at(0)\""
    assert line in failed[0]["message"]


@pytest.mark.slow  # the kit's own tests have such a measure
def test_a_check_finds_what_seeds_at_each_call(moseg):
    done = moseg("plugin", "check", "o_random", "--json", sees=["o_random"])
    assert done.returncode == 1
    outcomes = json.loads(done.stdout)["outcomes"]
    failed = [o["check"] for o in outcomes if o["status"] == "failed"]
    assert failed == ["random-state-untouched"]
