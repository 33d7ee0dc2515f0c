"""What the site is made of besides pages: names of the API, links out of the folder, files."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

import moseg_core as moseg

EXTENSIONS = Path(__file__).parents[2] / "docs" / "_ext"


def extension(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXTENSIONS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_public_name_stands_in_one_room():
    rooms = extension("api_pages").names_by_room()
    listed = [name for names in rooms.values() for name in names]
    assert sorted(["__version__", *listed]) == sorted(moseg.__all__)
    assert "segment" in rooms["search"]


@pytest.mark.parametrize(
    ("file", "link", "led"),
    [
        ("docs/learning.md", "formats.md#labellings", "formats.md#labellings"),
        ("docs/authors/index.md", "../plugins.md", "../plugins.md"),
        (
            "docs/learning.md",
            "../plugins/moseg_recipes_shapes/README.md",
            "/generated/recipes_shapes.md",
        ),
        ("plugins/moseg_recipes_shapes/README.md", "../../docs/learning.md", "/learning.md"),
        ("plugins/moseg_recipes_shapes/README.md", "../../README.md", "/index.md"),
        ("docs/start.md", "https://example.org/README.md", "https://example.org/README.md"),
        ("docs/start.md", "#install", "#install"),
    ],
)
def test_links_that_leave_the_folder_lead_to_pages_of_the_site(file, link, led):
    assert extension("outside").led_home(f"See [it]({link}).", file) == f"See [it]({led})."
