"""Shapes and distributions that tests of several modules need.

Shapes are frozen and live for the session, so that hypothesis may use them. Distributions are
real ones, a module and a ``.dist-info`` folder each, on a ``sys.path`` that lasts for one test.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator, Mapping
from importlib import metadata
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest

from moseg_core.plugins import Registry, discover
from moseg_core.shape import Shape

BlockMesh = tuple[list[tuple[int, int, int]], list[list[int]]]


def block_mesh(nx: int, ny: int, nz: int) -> BlockMesh:
    """The closed, outward-oriented surface of a block of unit cubes, in unit squares."""
    size = (nx, ny, nz)
    number: dict[tuple[int, int, int], int] = {}
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for i in range(size[u]):
            for j in range(size[v]):
                for end in (0, size[axis]):
                    corners = []
                    for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        point = [0, 0, 0]
                        point[axis], point[u], point[v] = end, i + a, j + b
                        corners.append(number.setdefault(tuple(point), len(number)))
                    faces.append(corners if end else corners[::-1])
    return list(number), faces


@pytest.fixture(scope="session")
def block() -> Callable[[int, int, int], BlockMesh]:
    """Make the surface of a block of unit cubes: vertices and quads."""
    return block_mesh


@pytest.fixture(scope="session")
def box() -> Shape:
    """A closed box of 3 x 2 x 1 with a volume of 6; 22 unit squares."""
    return Shape.from_mesh(*block_mesh(3, 2, 1), name="box")


@pytest.fixture(scope="session")
def row() -> Shape:
    """Six unit squares side by side in a plane: open, without a volume."""
    x = np.repeat(np.arange(7), 2)
    vertices = np.column_stack([x, np.tile([0, 1], 7), np.zeros(14)])
    faces = [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(6)]
    return Shape.from_mesh(vertices, faces, name="row")


@pytest.fixture(scope="session")
def nothing_installed() -> Registry:
    """A registry without bundles."""
    return Registry(())


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
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    yield Site(folder)
    for name, module in list(sys.modules.items()):
        if (getattr(module, "__file__", None) or "").startswith(str(folder)):
            del sys.modules[name]
