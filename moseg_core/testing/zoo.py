"""A fixed zoo of shapes on which components are tried.

Each specimen has something that components trip over: no volume, no neighbours, no surface, one
element only, faces of no area. One of them, the *lump*, has nothing of that kind. It is closed, in
one piece and in generic position: no two distances tie, and the principal axes of its parts are
well apart. Invariances are tested on it, since where axes are arbitrary so is all that hangs on
them.

Shapes are built anew each time that they are asked for. So a component that spoils its input
spoils it for nobody else.

:func:`shapes` is a hypothesis strategy over the same zoo, for authors who have hypothesis
installed; the core does not need it.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from moseg_core.errors import UsageError, unknown
from moseg_core.shape import Shape
from moseg_core.types import FloatArray, Int32Array

if TYPE_CHECKING:
    from hypothesis.strategies import SearchStrategy

Mesh = tuple[FloatArray, Sequence[Sequence[int]]]
"""Vertices and faces."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Labelling:
    """A labelling of a specimen.

    Parameters
    ----------
    title : str
        "halves".
    labels : (F,) int32
    n_parts : int
    """

    title: str
    labels: Int32Array
    n_parts: int


def specimen(name: str) -> Shape:
    """A shape of the zoo, built anew.

    Parameters
    ----------
    name : str
        One of :data:`ZOO`.

    Raises
    ------
    UsageError
        There is no such shape.

    Examples
    --------
    >>> specimen("cube")
    Shape(cube: 6 elements, area 6, volume 1)
    >>> specimen("cloud").volume is None
    True
    """
    if name not in ZOO:
        raise UsageError(unknown("specimen", name, ZOO))
    return ZOO[name]()


def labellings(shape: Shape) -> tuple[Labelling, ...]:
    """Labellings of any shape: in one part, in slices, and scattered.

    Parameters
    ----------
    shape : Shape

    Returns
    -------
    tuple of Labelling
        Only those for which there are elements enough. Every part has at least one.

    Examples
    --------
    >>> [(found.title, found.n_parts) for found in labellings(specimen("tetrahedron"))]
    [('whole', 1), ('halves', 2), ('thirds', 3), ('scattered', 2)]
    """
    count = shape.n_elements
    rank = np.empty(count, np.int64)
    rank[np.argsort(shape.points @ _OBLIQUE, kind="stable")] = np.arange(count)
    found = [
        ("whole", np.zeros(count), 1),
        ("halves", rank * 2 // count, 2),
        ("thirds", rank * 3 // count, 3),
        ("scattered", np.arange(count) % 2, 2),
    ]
    return tuple(
        Labelling(title=title, labels=labels.astype(np.int32), n_parts=n)
        for title, labels, n in found
        if n <= count
    )


_OBLIQUE = np.array([0.91, 0.37, 0.19])
"""Along no axis, so that few elements of a regular shape are equally far."""


def tetrahedron() -> Shape:
    """The corner of a cube: the least closed surface."""
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    return Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces, name="tetrahedron")


def cube() -> Shape:
    """Six squares: elements that are no triangles, scales that coincide."""
    return Shape.from_mesh(*_cube(), name="cube")


def disc() -> Shape:
    """A fan of triangles in a plane: open, flat, without a volume."""
    angle = 2 * np.pi * np.arange(12) / 12
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(12)])
    faces = [[0, 1 + k, 1 + (k + 1) % 12] for k in range(12)]
    return Shape.from_mesh(np.concatenate([np.zeros((1, 3)), rim]), faces, name="disc")


def sphere() -> Shape:
    """An icosahedron whose faces are cut in four: no direction is special."""
    vertices, faces = _ball(1)
    return Shape.from_mesh(vertices.copy(), faces, name="sphere")


def two_components() -> Shape:
    """Two cubes apart."""
    vertices, faces = _cube()
    both = np.concatenate([vertices, vertices * 0.5 + [3.0, 0.2, 0.1]])
    more = [[v + len(vertices) for v in face] for face in faces]
    return Shape.from_mesh(both, [*faces, *more], name="two_components")


def nonmanifold_edge() -> Shape:
    """Three triangles at one edge."""
    vertices = [[0, 0, 0], [0, 0, 1], [1, 0, 0.5], [-0.5, 0.9, 0.5], [-0.5, -0.8, 0.4]]
    faces = [[0, 1, 2], [0, 1, 3], [0, 1, 4]]
    return Shape.from_mesh(vertices, faces, name="nonmanifold_edge")


def duplicate_vertices() -> Shape:
    """A cube whose faces have vertices of their own, at the same places."""
    vertices, faces = _cube()
    own = vertices[np.array(faces).reshape(-1)]
    apart = np.arange(len(own)).reshape(-1, 4).tolist()
    return Shape.from_mesh(own, apart, name="duplicate_vertices")


def zero_area_face() -> Shape:
    """A square of two triangles, and one whose corners are on a line."""
    vertices = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [1, 0, 0]]
    return Shape.from_mesh(vertices, [[0, 1, 2], [0, 2, 3], [0, 4, 1]], name="zero_area_face")


def single_face() -> Shape:
    """One triangle: no more than one part."""
    return Shape.from_mesh([[0, 0, 0], [3, 0, 0], [1, 2, 0]], [[0, 1, 2]], name="single_face")


def cloud() -> Shape:
    """Points on an ellipsoid: no triangles, and nobody knows which of them touch."""
    vertices, _ = _ball(1)
    return Shape.from_points(vertices * [3.0, 2.0, 1.0], name="cloud")


def voxels() -> Shape:
    """A block of cells that fill a solid."""
    return Shape.from_voxels(np.ones((4, 3, 2), np.bool_), pitch=0.5, name="voxels")


def sample() -> Shape:
    """The hammer that comes with moseg, in super-elements, as a search sees it."""
    from moseg_core.coarse import coarsen

    return coarsen(_hammer(), 300)


def twin() -> Shape:
    """A closed surface that is its own mirror image across the plane x = 0, and across no other."""
    vertices, faces = _ball(1)
    bulge = 1.0 + 0.2 * vertices[:, 0] ** 2 + 0.15 * np.sin(2.0 * vertices[:, 1] + vertices[:, 2])
    return Shape.from_mesh(vertices * bulge[:, None] * [1.3, 2.9, 1.9], faces, name="twin")


def lump() -> Shape:
    """A closed surface in generic position, without any symmetry."""
    return Shape.from_mesh(*_lump(), name="lump")


ZOO: dict[str, Callable[[], Shape]] = {
    made.__name__: made
    for made in (
        tetrahedron,
        cube,
        disc,
        sphere,
        two_components,
        nonmanifold_edge,
        duplicate_vertices,
        zero_area_face,
        single_face,
        cloud,
        voxels,
        sample,
        twin,
        lump,
    )
}
"""All specimens by name, each a function that builds the shape."""


def shapes(*, among: Sequence[str] = tuple(ZOO)) -> SearchStrategy[Any]:
    """A hypothesis strategy: specimens, turned, scaled and moved as anybody's files are.

    Parameters
    ----------
    among : sequence of str
        Names of specimens. Those that are no meshes, and the sample, come as they are.

    Returns
    -------
    hypothesis.strategies.SearchStrategy
        Of :class:`~moseg_core.Shape`.

    Raises
    ------
    ImportError
        hypothesis is not installed.

    Examples
    --------
    >>> from hypothesis import given
    >>> @given(shapes(among=["cube", "disc"]))
    ... def test_area(shape):
    ...     assert shape.area > 0
    """
    from hypothesis import strategies as st

    def placed(name: str, seed: int, size: float, shift: float) -> Shape:
        shape = specimen(name)
        if name in _AS_THEY_ARE:
            return shape
        vertices = size * (shape.geometry.vertices @ rotation(seed).T + shift)
        return Shape.from_mesh(vertices, faces_of(shape), name=name)

    return st.builds(
        placed,
        st.sampled_from(tuple(among)),
        st.integers(0, 2**16),
        st.floats(1e-3, 1e3),
        st.floats(-10.0, 10.0),
    )


_AS_THEY_ARE = ("cloud", "voxels", "sample")


def rotation(seed: int) -> FloatArray:
    """(3, 3) float: a random proper rotation."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    turned: FloatArray = q * np.sign(np.linalg.det(q))
    return turned


def faces_of(shape: Shape) -> list[list[int]]:
    """The vertex numbers of each element."""
    geometry = shape.geometry
    ends = geometry.offsets.tolist()
    corners = geometry.corners.tolist()
    return [corners[start:end] for start, end in itertools.pairwise(ends)]


def _cube() -> Mesh:
    vertices = np.array(list(itertools.product((0.0, 1.0), repeat=3)))
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return vertices, faces


@lru_cache(maxsize=4)
def _ball(subdivisions: int) -> Mesh:
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=subdivisions)
    return np.array(ball.vertices), ball.faces.tolist()


def _lump() -> Mesh:
    vertices, faces = _ball(2)
    # Coordinates that are not small integers, and a surface that bulges nowhere twice.
    bulge = (
        1.0
        + 0.2 * np.sin(vertices @ [2.1, -1.3, 0.7] + 0.4)
        + 0.1 * np.cos(vertices @ [-0.8, 2.9, 1.7])
    )
    lumpy = vertices * bulge[:, None] * [3.1, 1.9, 1.2]
    lumpy[:, 1] += 0.12 * lumpy[:, 0] ** 2
    lumpy[:, 2] += 0.07 * lumpy[:, 0] * lumpy[:, 1]
    noise = np.random.default_rng(7).uniform(-0.01, 0.01, lumpy.shape)
    return (lumpy + noise) @ rotation(11).T + [0.3, -0.2, 0.5], faces


@lru_cache(maxsize=1)
def _hammer_mesh() -> Mesh:
    from moseg_core.io import load
    from moseg_core.samples import sample_path

    shape = load(sample_path("hammer"))
    return np.array(shape.geometry.vertices), faces_of(shape)


def _hammer() -> Shape:
    vertices, faces = _hammer_mesh()
    return Shape.from_mesh(vertices.copy(), faces, name="sample")
