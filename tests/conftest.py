"""Shapes and distributions that tests of several modules need.

Shapes are frozen and live for the session, so that hypothesis may use them. Distributions are
real ones, a module and a ``.dist-info`` folder each, on a ``sys.path`` that lasts for one test.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator, Mapping
from importlib import metadata
from pathlib import Path
from textwrap import dedent

import pytest
from hypothesis import settings

from moseg_core.components.discovery.registry import Registry, discover, registry
from moseg_core.shape.shape import Shape
from tests import shapes

# How long an example takes depends on the machine, and on whether kernels are compiled yet.
settings.register_profile("moseg", deadline=None)
settings.load_profile("moseg")


@pytest.fixture(scope="session")
def box() -> Shape:
    """A closed box of 3 x 2 x 1 with a volume of 6; 22 unit squares."""
    return Shape.from_mesh(*shapes.box(3, 2, 1), name="box")


@pytest.fixture(scope="session")
def row() -> Shape:
    """Six unit squares side by side in a plane: open, without a volume."""
    return Shape.from_mesh(*shapes.strip(6), name="row")


class Site:
    """A folder of distributions on ``sys.path``."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def add(
        self,
        distribution: str,
        version: str = "1.0",
        *,
        bundles: Mapping[str, str],
        **modules: str,
    ) -> None:
        """Install a distribution.

        Parameters
        ----------
        distribution, version : str
        bundles : mapping of str to str
            For each entry point its value.
        **modules : str
            Source of each module.
        """
        for name, source in modules.items():
            (self.folder / f"{name}.py").write_text(dedent(source), encoding="utf-8")
        info = self.folder / f"{distribution.replace('-', '_')}-{version}.dist-info"
        info.mkdir()
        header = f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n"
        (info / "METADATA").write_text(header, encoding="utf-8")
        points = "".join(f"{name} = {value}\n" for name, value in bundles.items())
        (info / "entry_points.txt").write_text(f"[moseg]\n{points}", encoding="utf-8")
        importlib.invalidate_caches()

    def entry_points(self) -> list[metadata.EntryPoint]:
        """The entry points of all distributions here, with their distributions."""
        return [
            point
            for found in metadata.distributions(path=[str(self.folder)])
            for point in found.entry_points
        ]

    def discover(self, **options: set[str] | None) -> Registry:
        """The registry of these distributions alone."""
        return discover(self.entry_points(), **options)


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Site]:
    """An empty folder of distributions; what was imported from it is forgotten afterwards."""
    registry()  # remembered before the folder is there, so that other tests do not see it
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    yield Site(folder)
    for name, module in list(sys.modules.items()):
        if (getattr(module, "__file__", None) or "").startswith(str(folder)):
            del sys.modules[name]
