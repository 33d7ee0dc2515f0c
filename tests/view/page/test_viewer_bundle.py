"""The page's script is what its sources make: it is committed, and nobody would see it go stale."""

from __future__ import annotations

import importlib.util
import json
import re
from pathlib import Path

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "moseg_core" / "view" / "page"


def tool():
    spec = importlib.util.spec_from_file_location("make_viewer", ROOT / "tools" / "make_viewer.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_bundle_was_made_from_these_sources():
    bundle = (PAGE / "viewer.js").read_text(encoding="ascii")
    assert bundle.split("\n", 1)[0] == tool().first_line(), "run python tools/make_viewer.py"


def test_another_source_makes_another_first_line(tmp_path):
    for source in (ROOT / "tools" / "viewer").iterdir():
        if source.is_file():
            (tmp_path / source.name).write_bytes(source.read_bytes())
    assert tool().first_line(tmp_path) == tool().first_line()
    (tmp_path / "stage.js").write_text("// another")
    assert tool().first_line(tmp_path) != tool().first_line()


def test_versions_are_exact():
    package = json.loads((ROOT / "tools" / "viewer" / "package.json").read_text())
    for name, version in (package["dependencies"] | package["devDependencies"]).items():
        assert re.fullmatch(r"\d+\.\d+\.\d+", version), name


def test_the_licence_of_three_js_is_beside_it():
    license = (PAGE / "three-license.txt").read_text()
    assert license.startswith("The MIT License")
    assert "three.js authors" in license


def test_names_reach_the_page_as_text_only():
    for source in (ROOT / "tools" / "viewer").glob("*.js"):
        found = re.findall(
            r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", source.read_text()
        )
        assert found == [], source.name
