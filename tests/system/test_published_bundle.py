"""A stranger's day: wheels, a clean environment, new bundles of each kind, and a search with one.

Nothing comes from the checkout but the wheels that are built of it. In one test, since the
environment takes longest to make.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from moseg_core.cli.scaffold import SKETCHES

ROOT = Path(__file__).parents[2]
PIP = ("-m", "pip", "--disable-pip-version-check", "--quiet")

Run = Callable[..., subprocess.CompletedProcess[str]]


def build_wheels(folder: Path) -> list[Path]:
    """Wheels of the core and of all plugins."""
    sources = [ROOT, *sorted(path.parent for path in ROOT.glob("plugins/*/pyproject.toml"))]
    for source in sources:
        command = [*PIP, "wheel", "--no-deps", "--no-build-isolation", "-w", folder, source]
        subprocess.run([sys.executable, *command], check=True, cwd=folder)
    return sorted(folder.glob("*.whl"))


def environment(folder: Path, work: Path) -> Run:
    """A virtual environment, and a way to run its programs with nothing around them."""
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    plain = {
        key: value
        for key, value in os.environ.items()
        if not key.startswith(("PYTHON", "MOSEG", "PYTEST", "VIRTUAL_ENV"))
    }
    plain |= {"PYTHONNOUSERSITE": "1", "MOSEG_STRICT": "1"}

    def run(program: str, *words: object, cwd: Path = work, code: int = 0):
        done = subprocess.run(
            [folder / "bin" / program, *map(str, words)],
            cwd=cwd,
            env=plain,
            capture_output=True,
            text=True,
        )
        assert done.returncode == code, f"{program} {words}\n{done.stdout}\n{done.stderr}"
        return done

    return run


@pytest.mark.slow
def test_bundles_of_every_kind_from_wheels_alone(tmp_path):
    work, home = tmp_path / "work", tmp_path / "environment"
    work.mkdir()
    (tmp_path / "dist").mkdir()
    wheels = build_wheels(tmp_path / "dist")
    (core,) = (wheel for wheel in wheels if wheel.name.startswith("moseg_core-"))
    assert len(wheels) == 9

    # The extra "all" brings the plugins, here from the wheels beside the core's.
    run = environment(home, work)
    pinned = ["-c", ROOT / "constraints.txt"]
    tools = ["pytest", "hypothesis", "hatchling"]
    found = ["--find-links", tmp_path / "dist"]
    run("python", *PIP, "install", *pinned, *found, f"{core}[all]", *tools)
    assert (
        json.loads(run("python", "-m", "pip", "list", "--editable", "--format=json").stdout) == []
    )
    tell = "import json, sys, moseg_core; print(json.dumps([moseg_core.__file__, sys.path]))"
    origin, path = json.loads(run("python", "-c", tell).stdout)
    assert Path(origin).is_relative_to(home)
    assert not [entry for entry in path if Path(entry).is_relative_to(ROOT)]

    names = {kind: f"my_{kind}" for kind in SKETCHES}
    folders = [work / f"moseg-my-{kind}" for kind in SKETCHES]
    for kind, name in names.items():
        run("moseg", "plugin", "new", name, "--kind", kind)
    run("python", *PIP, "install", *pinned, "--no-build-isolation", *folders)
    listed = json.loads(run("moseg", "plugin", "list", "--json").stdout)
    own = {"core", "basic", "symmetry", "mds", "benchmark", "learn", "shapes"}
    own |= {"robotics", "medical"}
    assert {bundle["name"] for bundle in listed} == own | set(names.values())
    assert not [bundle["problem"] for bundle in listed if bundle["problem"]]

    for (kind, name), folder in zip(names.items(), folders, strict=True):
        run("python", "-m", "pytest", "-q", cwd=folder)
        report = json.loads(run("moseg", "plugin", "check", name, "--json").stdout)
        assert report["passed"]
        assert report["counts"]["passed"] > 0
        component = f"{name}:{SKETCHES[kind].component}"
        assert {outcome["component"] for outcome in report["outcomes"]} == {component}
        assert component in run("moseg", "plugin", "explain", component).stdout

    run("moseg", "sample", "hammer", "-o", "hammer.ply")
    run(
        "moseg",
        "segment",
        "hammer.ply",
        *("--labels", "handle,head", "--seeder", "scattered", "--labeler", "exchange"),
        *("--minimize", "3*slender(handle, ratio=6) + perpendicular(handle, head) + convex_parts"),
        *("--optimizer", "gaussian_steps(max_evaluations=60)", "--refiner", "majority"),
        *("-o", "result.json", "-o", "result.html"),
    )
    assert (work / "result.html").stat().st_size > 500_000  # the page with its script
    result = json.loads((work / "result.json").read_text())
    assert result["terms"][0]["objective"] == "my_objective:slender"
    assert result["method"]["optimizer"].startswith("my_optimizer:gaussian_steps")
    assert result["method"]["refiner"] == "my_refiner:majority"
    assert set(result["labels"]) == {0, 1}
