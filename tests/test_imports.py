"""What is loaded when, and that the public names are where they are said to be."""

from __future__ import annotations

import ast
import importlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

import moseg_core

HEAVY = {
    "PIL",
    "igl",
    "manifold3d",
    "numba",
    "numpy",
    "scipy",
    "trimesh",
}


# What `python -X importtime` lists leaves out what is imported by name, as bundles are.
TELL = """
import atexit, json, runpy, sys
path, *arguments = sys.argv[1:]
atexit.register(lambda: json.dump(sorted(sys.modules), open(path, "w")))
"""
RUN = f"{TELL}sys.argv[1:] = arguments; runpy.run_module('moseg_core', run_name='__main__')"


def loaded_by(code: str, *arguments: str, folder: Path) -> set[str]:
    """Full names of the modules that a fresh interpreter has imported when it ends."""
    path = folder / "modules.json"
    command = [sys.executable, "-c", code, str(path), *arguments]
    subprocess.run(command, capture_output=True, check=True, cwd=folder)
    modules = set(json.loads(path.read_text()))
    assert "moseg_core" in modules
    return modules


def packages(modules: set[str]) -> set[str]:
    return {module.partition(".")[0] for module in modules}


def plugin_packages() -> set[str]:
    """Packages of the installed bundles other than the core."""
    bundles = moseg_core.registry().bundles
    return packages({b.module.partition(":")[0] for b in bundles}) - {"moseg_core"}


@pytest.mark.parametrize(
    "arguments",
    [("--help",), ("--version",), ("segment", "--help"), ("plugin", "--help"), ()],
    ids=" ".join,
)
def test_asking_for_help_loads_no_numerical_library_and_no_plugin(arguments, tmp_path):
    found = packages(loaded_by(RUN, *arguments, folder=tmp_path))
    assert plugin_packages()
    assert not found & (HEAVY | plugin_packages())


@pytest.mark.parametrize(
    "statement",
    [
        "import moseg_core; dir(moseg_core)",
        "from moseg_core import MosegError, ObjectiveSpec, hookimpl, sample_path",
        "from moseg_core.language import parse; parse('3*narrow(leg*)')",
        "from moseg_core import registry; registry().find('objective', 'narrow')",
    ],
)
def test_names_without_numbers_load_no_numerical_library(statement, tmp_path):
    assert not packages(loaded_by(TELL + statement, folder=tmp_path)) & HEAVY


def test_the_check_sees_what_is_loaded(tmp_path):
    found = packages(loaded_by(f"{TELL}from moseg_core import Shape", folder=tmp_path))
    assert {"numpy", "scipy"} <= found


@pytest.mark.parametrize("options", [(), ("--json",)], ids=["table", "json"])
def test_listing_plugins_loads_bundles_but_no_component_and_no_numerical_library(options, tmp_path):
    found = loaded_by(RUN, "plugin", "list", *options, folder=tmp_path)
    assert not packages(found) & HEAVY
    assert plugin_packages() <= packages(found)
    targets = {c.spec.target.partition(":")[0] for c in moseg_core.registry().components()}
    assert not found & targets


@pytest.mark.parametrize("name", moseg_core.__all__)
def test_every_public_name_is_there(name):
    value = getattr(moseg_core, name)
    if name != "__version__":
        home = importlib.import_module(moseg_core._homes()[name])
        assert value is getattr(home, name)


def test_the_loader_reads_every_name_of_the_stub():
    stub = Path(moseg_core.__file__).with_suffix(".pyi")
    seen = {}
    for node in ast.parse(stub.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                # Only `import x as x` is a re-export to a strict type checker.
                assert alias.asname == alias.name
                assert alias.name not in seen
                seen[alias.name] = node.module
    assert seen == moseg_core._homes()


@pytest.mark.parametrize("use", ["moseg_core.Shape", "moseg_core.__all__", "dir(moseg_core)"])
def test_the_stub_is_read_when_a_name_is_first_asked_for(use, tmp_path):
    names = "moseg_core._homes.cache_info().currsize"
    loaded_by(
        f"{TELL}import moseg_core; assert {names} == 0; {use}; assert {names} == 1", folder=tmp_path
    )


def test_the_package_alone_loads_nothing_to_read_files_with(tmp_path):
    before = "before = set(sys.modules); import moseg_core; "
    loaded_by(f"{TELL}{before}assert 'pathlib' not in set(sys.modules) - before", folder=tmp_path)


def test_unknown_names_are_unknown():
    with pytest.raises(AttributeError, match="module 'moseg_core' has no attribute 'segmnt'"):
        _ = moseg_core.segmnt
    assert not hasattr(moseg_core, "_nothing")


def test_names_are_listed_before_they_are_used():
    assert dir(moseg_core) == sorted(moseg_core.__all__)
    assert len(set(moseg_core.__all__)) == len(moseg_core.__all__)


def test_everything_can_be_imported_at_once():
    names: dict[str, object] = {}
    exec("from moseg_core import *", names)
    assert set(moseg_core.__all__) <= set(names)


def test_the_version_is_that_of_the_distribution():
    from importlib import metadata

    assert moseg_core.__version__ == metadata.version("moseg-core")
