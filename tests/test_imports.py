"""What is loaded when, and that the public names are where they are said to be."""

from __future__ import annotations

import ast
import importlib
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


def loaded_by(*command: str, folder: Path) -> set[str]:
    """Full names of the modules that a fresh interpreter imports on a command line."""
    done = subprocess.run(
        [sys.executable, "-X", "importtime", *command],
        capture_output=True,
        text=True,
        check=True,
        cwd=folder,
    )
    lines = [line for line in done.stderr.splitlines() if line.startswith("import time:")]
    modules = {line.rpartition("|")[2].strip() for line in lines}
    assert "moseg_core" in modules
    return modules


def packages(modules: set[str]) -> set[str]:
    return {module.partition(".")[0] for module in modules}


def plugin_packages() -> set[str]:
    """Packages of the installed bundles other than the core."""
    bundles = moseg_core.registry().bundles
    return packages({b.module.partition(":")[0] for b in bundles}) - {"moseg_core"}


@pytest.mark.parametrize(
    "command",
    [
        ("-m", "moseg_core", "--help"),
        ("-m", "moseg_core", "--version"),
        ("-m", "moseg_core", "segment", "--help"),
        ("-c", "import moseg_core"),
        ("-c", "from moseg_core import ObjectiveSpec, hookimpl"),
    ],
    ids=" ".join,
)
def test_asking_for_help_loads_no_numerical_library_and_no_plugin(command, tmp_path):
    found = packages(loaded_by(*command, folder=tmp_path))
    assert plugin_packages()
    assert not found & (HEAVY | plugin_packages())


@pytest.mark.parametrize("options", [(), ("--json",)], ids=["table", "json"])
def test_listing_plugins_loads_bundles_but_no_component_and_no_numerical_library(options, tmp_path):
    found = loaded_by("-m", "moseg_core", "plugin", "list", *options, folder=tmp_path)
    assert not packages(found) & HEAVY
    assert plugin_packages() <= packages(found)
    targets = {c.spec.target.partition(":")[0] for c in moseg_core.registry().components()}
    assert not found & targets


@pytest.mark.parametrize("name", moseg_core.__all__)
def test_every_public_name_is_there(name):
    value = getattr(moseg_core, name)
    if name != "__version__":
        home = importlib.import_module(f"moseg_core.{moseg_core._HOMES[name]}")
        assert value is getattr(home, name)


def test_the_type_checker_sees_the_same_names_from_the_same_places():
    tree = ast.parse(Path(moseg_core.__file__).read_text(encoding="utf-8"))
    (block,) = [
        node
        for node in tree.body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    ]
    seen = {}
    for node in block.body:
        assert isinstance(node, ast.ImportFrom)
        for alias in node.names:
            # Only `import x as x` is a re-export to a strict type checker.
            assert alias.asname == alias.name
            assert alias.name not in seen
            seen[alias.name] = node.module
    assert seen == {name: f"moseg_core.{home}" for name, home in moseg_core._HOMES.items()}


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
