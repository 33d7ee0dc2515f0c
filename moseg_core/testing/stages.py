"""What the pieces of the method are tried on: shapes in generic position, and a problem on them.

Seeders and labelers see an evaluator, parameterizations and constraints a shape. Here are small
ones, whose results can be told apart: no two elements are alike, none is equally far from two
others, and no two costs are equal, so that a component has no ties to break and *equivariant*
means *equal*. They stand far from the origin and askew, since a component that takes model units
for unit coordinates, or axes of the file for those of the shape, does well on anything that does
not.

The drivers in :mod:`moseg_core.testing.drivers` run a component of any kind for the checks that
all kinds share; what is here serves the checks of one kind.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.cost import Cost
from moseg_core.errors import MosegError
from moseg_core.evaluation import Evaluator
from moseg_core.objectives import objective
from moseg_core.part import Part
from moseg_core.problem import Problem
from moseg_core.protocols import Centers, Progress
from moseg_core.segmentation import Segmentation
from moseg_core.shape import Shape
from moseg_core.types import FloatArray, IntArray

_OCTAHEDRON = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
_FAR = np.array([30.0, -12.0, 7.0])
_SIDES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


def pebble(splits: int = 2, *, order: IntArray | None = None) -> Shape:
    """A closed, bumpy surface in one piece, askew and far from the origin.

    Parameters
    ----------
    splits : int
        It has ``8 * 4**splits`` faces.
    order : (F,) int, optional
        The faces in another order.

    Examples
    --------
    >>> pebble().n_elements, pebble(0).adjacency.components()[0]
    (128, 1)
    """
    if order is None:
        return _pebble(splits)
    vertices, faces = _stone(splits, even=False)
    return Shape.from_mesh(_askew(vertices), faces[order], name="pebble")


def even_pebble(splits: int = 2) -> Shape:
    """A pebble that is its own mirror image in the plane ``x`` through its middle."""
    return _even_pebble(splits)


def horseshoe() -> Shape:
    """A long pebble bent until its ends are near: what is near in space is far on the surface."""
    return _horseshoe()


def dots(*, order: IntArray | None = None) -> Shape:
    """The vertices of a pebble as a cloud of points, of which nobody knows which touch."""
    points = _askew(_stone(2, even=False)[0])
    return Shape.from_points(points if order is None else points[order], name="dots")


@cache
def _pebble(splits: int) -> Shape:
    vertices, faces = _stone(splits, even=False)
    return Shape.from_mesh(_askew(vertices), faces, name="pebble")


@cache
def _even_pebble(splits: int) -> Shape:
    vertices, faces = _stone(splits, even=True)
    return Shape.from_mesh(vertices + _FAR, faces, name="even pebble")


@cache
def _horseshoe() -> Shape:
    vertices, faces = _stone(2, even=False)
    x, y, z = vertices.T
    angle, radius = 1.25 * x, 3.0 + y
    bent = np.column_stack([radius * np.sin(angle), radius * np.cos(angle), 1.7 * z + 0.11 * y])
    return Shape.from_mesh(_askew(bent), faces, name="horseshoe")


def _stone(splits: int, *, even: bool) -> tuple[FloatArray, IntArray]:
    """Vertices and faces of an octahedron, split and blown up to a ball, then squeezed."""
    vertices = [np.array(corner, dtype=np.float64) for corner in _OCTAHEDRON]
    faces = list(_SIDES)
    for _ in range(splits):
        middles: dict[tuple[int, int], int] = {}
        finer: list[tuple[int, int, int]] = []
        for a, b, c in faces:
            ab, bc, ca = (_middle(vertices, middles, i, j) for i, j in ((a, b), (b, c), (c, a)))
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = finer
    ball = np.array(vertices)
    x = np.abs(ball[:, 0]) if even else ball[:, 0]
    y, z = ball[:, 1], ball[:, 2]
    bumps = 1.0 + 0.13 * np.sin(2.9 * x + 1.7 * y + 0.3) + 0.11 * np.sin(3.7 * z - 2.3 * y + 1.1)
    noise = 0.0 if even else np.random.default_rng(3).uniform(-0.02, 0.02, ball.shape)
    return ball * bumps[:, None] * [2.0, 1.31, 0.83] + noise, np.array(faces)


def _askew(vertices: FloatArray) -> FloatArray:
    turned: FloatArray = vertices @ turn().T + _FAR
    return turned


def _middle(vertices: list[FloatArray], middles: dict[tuple[int, int], int], i: int, j: int) -> int:
    key = (min(i, j), max(i, j))
    if key not in middles:
        between = vertices[i] + vertices[j]
        middles[key] = len(vertices)
        vertices.append(between / np.linalg.norm(between))
    return middles[key]


def turn() -> FloatArray:
    """(3, 3) float: a rotation about no axis in particular."""
    a, b = np.array([1.0, 2.0, -0.5]), np.array([1.3, -0.4, 1.0])
    for axis in (a, b):
        axis /= np.linalg.norm(axis)
    identity = np.eye(3)
    # The product of two reflections.
    turned: FloatArray = (identity - 2 * np.outer(a, a)) @ (identity - 2 * np.outer(b, b))
    return turned


@objective(range=(0, 1))
def slim(part: Part) -> float:
    """How thick a part is for its length."""
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


@objective(range=(0, 100))
def area(part: Part) -> float:
    """Area of a part, model units squared."""
    return float(part.area)


@objective(range=(0, 1))
def tilted(part: Part) -> float:
    """How far a part's longest axis is from a direction that is no other's."""
    return 1.0 - abs(float(part.axes[0] @ np.array([0.48, 0.6, 0.64])))


@objective(range=(0, 100))
def apart(first: Part, second: Part) -> float:
    """Distance of two parts' centroids, model units."""
    return float(np.linalg.norm(first.centroid - second.centroid))


@objective(range=(0, 100))
def uneven(segmentation: Segmentation) -> float:
    """Spread of the areas, model units squared."""
    return float(np.std([part.area for part in segmentation.parts]))


OBJECTIVES = {"slim": slim, "area": area, "tilted": tilted, "apart": apart, "uneven": uneven}

#: Unary terms that tell all labels apart; then terms that the unary ones know nothing of.
_UNARY = "slim({0}) + 0.13*area({1}) + tilted({2}) - 0.07*area({3}) + 0.3*tilted({1})"
_OTHERS = " + 3*apart({0}, {2}) - 2*apart({1}, {3}) + 0.2*uneven"


def evaluator(n: int, shape: Shape | None = None) -> Evaluator:
    """A problem of `n` labels on a shape, with Voronoi partitions.

    Up to 4 labels have terms of their own, unary ones and ones that make the optimum of the unary
    terms differ from that of all.

    Parameters
    ----------
    n : int
    shape : Shape, optional
        A pebble by default.
    """
    labels = [f"part{k}" for k in range(n)]
    if n == 4:
        text = (_UNARY + _OTHERS).format(*labels)
    else:
        text = " + ".join(f"{0.1 + 0.07 * k:.2f}*slim({label})" for k, label in enumerate(labels))
        text += "" if n == 1 else " + 0.1*uneven"
    on = pebble() if shape is None else shape
    return Evaluator(on, Problem(labels, text, objectives=OBJECTIVES), Voronoi(on, n))


def vectors(stage: Evaluator, count: int, seed: int = 0) -> FloatArray:
    """(B, m) float: partitions at random without an empty part."""
    rng = np.random.default_rng(seed)
    shape, partition = stage.shape, stage.parameterization
    n = partition.n_parts
    found: list[FloatArray] = []
    while len(found) < count:
        chosen = shape.points[rng.choice(shape.n_elements, n, replace=False)]
        vector = partition.encode(Centers(positions=chosen, weights=rng.uniform(0.8, 1.25, n)))
        if len(np.unique(stage.labels(vector))) == n:
            found.append(vector)
    return np.array(found)


def silent(progress: Progress) -> bool:
    """A listener who never asks to stop."""
    return False


def refused(make: Callable[[], Any]) -> tuple[Any, str]:
    """What a call returns, or why moseg's own errors say that it cannot be had."""
    try:
        return make(), ""
    except MosegError as error:
        return None, str(error)


def as_numbers(given: Any) -> FloatArray:
    """An array of float, of no rows where it cannot be one."""
    try:
        return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        return np.empty(0)


def unlike(first: Any, second: Any, *, tolerance: float = 0.0) -> float | None:
    """The greatest difference of two arrays, infinite for other shapes; None where within."""
    a, b = as_numbers(first), as_numbers(second)
    if a.shape != b.shape:
        return math.inf
    if not a.size or np.array_equal(a, b):
        return None
    difference = float(np.abs(a - b).max())
    return None if difference <= tolerance else difference


def clean(cost: Cost) -> Cost:
    """The cost, with NaN as bad as can be."""
    return cost if cost.value == cost.value else Cost(cost.empty, math.inf)
