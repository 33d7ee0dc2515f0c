"""Shapes and distributions that tests of several modules need.

Shapes are frozen and live for the session, so that hypothesis may use them. Distributions are
real ones, a module and a ``.dist-info`` folder each, on a ``sys.path`` that lasts for one test.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
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
        requires: Sequence[str] = (),
        **modules: str,
    ) -> None:
        """Install a distribution.

        Parameters
        ----------
        distribution, version : str
        bundles : mapping of str to str
            For each entry point its value.
        requires : sequence of str
            Distributions that it says it cannot do without, as in its metadata.
        **modules : str
            Source of each module.
        """
        for name, source in modules.items():
            (self.folder / f"{name}.py").write_text(dedent(source), encoding="utf-8")
        info = self.folder / f"{distribution.replace('-', '_')}-{version}.dist-info"
        info.mkdir()
        header = f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n"
        header += "".join(f"Requires-Dist: {requirement}\n" for requirement in requires)
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


#: What a stranger may call as somebody else did; there are no such modules behind it.
_NAMED = {
    "objective": ("ObjectiveSpec", "moseg_objectives"),
    "field": ("FieldSpec", "moseg_fields"),
    "constraint": ("ConstraintSpec", "moseg_constraints"),
    "embedding": ("EmbeddingSpec", "moseg_embeddings"),
    "parameterization": ("ParameterizationSpec", "moseg_parameterizations"),
    "seeder": ("SeederSpec", "moseg_seeders"),
    "labeler": ("LabelerSpec", "moseg_labelers"),
    "optimizer": ("OptimizerSpec", "moseg_optimizers"),
    "refiner": ("RefinerSpec", "moseg_refiners"),
}


@pytest.fixture
def install_stranger(site: Site) -> Iterator[Callable[[], Registry]]:
    """Install a distribution that has something of every name that is installed already.

    The function gives the registry of everything, which is the process's own until the test ends.
    """

    def install() -> Registry:
        source = "import moseg_core\nfrom moseg_core import hookimpl\n"
        for kind, (spec, hook) in _NAMED.items():
            names = [component.spec.name for component in registry().components(kind)]
            source += (
                f"@hookimpl\ndef {hook}():\n    return [moseg_core.{spec}(name=name,"
                f" target='nowhere_at_all:' + name) for name in {names}]\n"
            )
        site.add("Strange-Parts", bundles={"strange": "strange_bundle"}, strange_bundle=source)
        registry.cache_clear()
        return registry()

    yield install
    registry.cache_clear()
