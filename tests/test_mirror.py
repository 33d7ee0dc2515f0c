"""Tests stand where the modules stand: those of ``moseg_core/shape/mesh.py`` in
``tests/shape/test_mesh.py``, or one after another aspect in ``tests/shape/test_mesh_*.py``.

So whoever changes a module knows which tests to run and where the next one goes. What has no file
of its own is listed here, with where it is tested instead.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
#: Each folder of modules with the folder of its tests.
MIRRORED = {
    ROOT / "moseg_core": ROOT / "tests",
    **{
        package: package.parent / "tests"
        for package in ROOT.glob("plugins/*/moseg_*")
        if (package / "__init__.py").exists()
    },
}

#: Modules, or folders of them, without a test file of their own, and why.
ELSEWHERE = {
    "moseg_core/__main__.py": "three lines: every test that runs `python -m moseg_core`",
    "moseg_core/cli/plugin_app.py": "declares commands, each with a file: test_plugin_new.py, ...",
    "moseg_core/view/scene.py": "plain records, drawn by test_svg.py and test_png.py",
}


def has_tests(module: Path, package: Path, tests: Path) -> bool:
    folder = tests / module.relative_to(package).parent
    own = folder / f"test_{module.stem}.py"
    return own.exists() or any(folder.glob(f"test_{module.stem}_*.py"))


def without_tests() -> Iterator[str]:
    for package, tests in MIRRORED.items():
        for module in sorted(package.rglob("*.py")):
            if module.name != "__init__.py" and not has_tests(module, package, tests):
                yield str(module.relative_to(ROOT))


def excuse(module: str) -> str | None:
    """The entry of the list above that a module falls under."""
    return next((entry for entry in ELSEWHERE if f"{module}/".startswith(f"{entry}/")), None)


def test_every_module_has_tests_of_its_own_or_a_reason_why_not():
    assert len(MIRRORED) >= 4
    assert [module for module in without_tests() if excuse(module) is None] == []


def test_no_reason_is_left_over():
    assert {excuse(module) for module in without_tests()} - {None} == set(ELSEWHERE)


@pytest.mark.parametrize("entry", ELSEWHERE)
def test_files_that_reasons_name_are_there(entry):
    words = [word.strip(",:") for word in ELSEWHERE[entry].split()]
    for word in words:
        if word.endswith(".py"):
            assert (ROOT / word).exists() or list(ROOT.glob(f"tests/**/{word}")), word


def test_a_module_of_no_tests_is_found():
    package = ROOT / "moseg_core"
    assert has_tests(package / "shape" / "mesh.py", package, ROOT / "tests")
    assert not has_tests(package / "shape" / "mash.py", package, ROOT / "tests")
    assert excuse("moseg_core/view/scene.py") == "moseg_core/view/scene.py"
    assert excuse("moseg_core/view/scenery.py") is None
