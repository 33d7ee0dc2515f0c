"""What the tests of all readers share: files from bytes, random meshes, cutting files short.

The fixtures live for the session so that hypothesis may use them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import strategies as st

from moseg_core.errors import ShapeError


@pytest.fixture(scope="session")
def as_file(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, bytes | str], Path]:
    """Write contents to a file of the given name, in a folder of its own."""
    folder = tmp_path_factory.mktemp("files")
    numbers = itertools.count()

    def write(name: str, contents: bytes | str) -> Path:
        path = folder / str(next(numbers)) / name
        path.parent.mkdir()
        path.write_bytes(contents.encode() if isinstance(contents, str) else contents)
        return path

    return write


@pytest.fixture(scope="session")
def refusal(as_file) -> Callable[..., str]:
    """The message with which a reader refuses contents; it names the file and has one line."""

    def message(reader: Callable[[Path], object], name: str, contents: bytes | str) -> str:
        with pytest.raises(ShapeError) as caught:
            reader(as_file(name, contents))
        text = str(caught.value)
        assert text.startswith(name)
        assert "\n" not in text
        return text.removeprefix(name)

    return message


def _named(error: ShapeError, name: str) -> None:
    assert str(error).startswith(name)


@pytest.fixture(scope="session")
def accepted_cuts(tmp_path_factory) -> Callable[..., dict[int, object]]:
    """Read a file cut off at each position: what was read where it was not refused.

    Anything but a ShapeError that names the file escapes, and so fails the test.
    """
    folder = tmp_path_factory.mktemp("cuts")

    def cut(
        reader: Callable[[Path], object],
        name: str,
        contents: bytes,
        positions: Iterable[int] | None = None,
    ) -> dict[int, object]:
        path = folder / name
        read = {}
        for stop in range(len(contents)) if positions is None else positions:
            path.write_bytes(contents[:stop])
            try:
                read[stop] = reader(path)
            except ShapeError as error:
                _named(error, name)
        return read

    return cut


@pytest.fixture(scope="session")
def damages(tmp_path_factory) -> Callable[..., int]:
    """Read a file with single bytes replaced; how many of these were refused.

    Anything but a ShapeError that names the file escapes, and so fails the test.
    """
    folder = tmp_path_factory.mktemp("damages")

    def damage(
        reader: Callable[[Path], object], name: str, contents: bytes, count: int = 250
    ) -> int:
        rng = np.random.default_rng(7)
        path = folder / name
        refused = 0
        for _ in range(count):
            changed = bytearray(contents)
            changed[rng.integers(len(contents))] = rng.integers(256)
            path.write_bytes(bytes(changed))
            try:
                reader(path)
            except ShapeError as error:
                _named(error, name)
                refused += 1
        return refused

    return damage


@st.composite
def _polygon_meshes(draw: st.DrawFn) -> tuple[np.ndarray, list[list[int]]]:
    coordinate = st.floats(-100, 100, width=32, allow_nan=False)
    extra = draw(st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=3, max_size=9))
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), *extra], np.float64)
    corner = st.integers(0, len(vertices) - 1)
    polygon = st.lists(corner, min_size=3, max_size=6, unique=True)
    triangle = st.lists(corner, min_size=3, max_size=3, unique=True)
    rest = draw(st.lists(draw(st.sampled_from([polygon, triangle])), max_size=8))
    faces = [[0, 1, 2], *rest]
    place = draw(st.integers(0, len(faces) - 1))
    faces[0], faces[place] = faces[place], faces[0]
    return vertices, faces


@pytest.fixture(scope="session")
def polygon_meshes() -> st.SearchStrategy[tuple[np.ndarray, list[list[int]]]]:
    """Vertices that single precision holds exactly, and faces of which one has an area."""
    return _polygon_meshes()


@pytest.fixture(scope="session")
def polygons_of() -> Callable[[object], list[list[int]]]:
    """The polygons of a shape's geometry, as lists of vertex indices."""

    def polygons(shape) -> list[list[int]]:
        mesh = shape.geometry
        return [mesh.corners[a:b].tolist() for a, b in itertools.pairwise(mesh.offsets.tolist())]

    return polygons
