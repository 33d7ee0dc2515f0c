"""Checks of embeddings: the same elements, elsewhere (Sec. 9).

The partition is found in the embedded shape and its labels are read as those of the original,
element by element. So the two must have the same elements in the same order; and where the
original is turned, or mirrored, what becomes of it must be cut the same way. The method is blind
to where an embedded shape lies, how large it is and which way round, so only the ratios of
distances between its elements are compared: a scaling of distances may come out mirrored.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.spatial.distance import pdist

from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.problems import pebble, refused, turn, unlike
from moseg_core.testing.fixtures.trial import values_for
from moseg_core.types import FloatArray

#: Of the greatest distance. Iterations that stop a little sooner or later must be allowed for.
_SAME = 1e-3


def _made(subject: Subject, shape: Shape) -> Callable[[Shape], Shape]:
    made: Callable[[Shape], Shape] = subject.load()(**values_for(subject, shape))
    return made


def _bent(subject: Subject, shape: Shape) -> Shape:
    return _embedded(_made(subject, shape), shape)


def _embedded(embedding: Callable[[Shape], Shape], shape: Shape) -> Shape:
    found, reason = refused(lambda: embedding(shape))
    if found is None:
        raise Skip(f"it refuses a closed surface in one piece: {reason}")
    made: Shape = found
    return made


def _shapes() -> Iterator[Shape]:
    yield pebble()
    yield _moved(pebble(1), np.diag([1.0, 1.0, 2.0]), "long pebble")


def _moved(shape: Shape, matrix: FloatArray, name: str) -> Shape:
    """The shape with a linear map applied to its vertices, and shifted."""
    mesh = shape.geometry
    vertices = mesh.vertices @ matrix.T + np.array([5.0, 40.0, -3.0])
    return Shape.from_mesh(vertices, mesh.triangles, name=name)


@check(
    "embedding-elements",
    kinds=["embedding"],
    why="labels of the embedded shape are taken for those of the original, element by element",
)
def _elements(subject: Subject) -> None:
    for shape in _shapes():
        found = _bent(subject, shape)
        if not isinstance(found, Shape) or found.points.shape != shape.points.shape:
            got = (
                f"a Shape of {len(found.points)} elements"
                if isinstance(found, Shape)
                else f"a {type(found).__name__}"
            )
            raise ContractFailure(
                did=f"it was given a {shape.name} of {shape.n_elements} faces",
                got=got,
                expected="a moseg_core.Shape with a point for each of them",
                fix="return shape.deformed(vertices, space='...')",
            )
        same = unlike(found.geometry.corners, shape.geometry.corners) is None
        if not same or found.adjacency is None or shape.adjacency is None:
            raise ContractFailure(
                did=f"the elements of an embedded {shape.name} were compared with the original's",
                got="others, in another order, or without their neighbours",
                expected="the same faces over the same vertices, in the same order",
                fix="return shape.deformed(vertices, space='...'), with a place for each vertex in"
                " the order of shape.geometry.vertices",
            )


@check(
    "embedding-finite",
    kinds=["embedding"],
    why="a point at no finite place is nearest to no centre",
)
def _finite(subject: Subject) -> None:
    for shape in _shapes():
        found = _bent(subject, shape)
        numbers = {"points": found.points, "areas": found.areas}
        for name, array in numbers.items():
            wrong = int((~np.isfinite(array)).sum())
            if wrong:
                raise ContractFailure(
                    did=f"it was given a {shape.name}",
                    got=f"{wrong} numbers in the {name} of the embedded shape that are not finite",
                    expected="finite numbers only",
                    fix="look for distances of 0 that are divided by, and for vertices that"
                    " nothing reaches",
                )


@check(
    "embedding-deterministic",
    kinds=["embedding"],
    why="the embedding is computed anew in each process and run; results must not hang on that",
)
def _deterministic(subject: Subject) -> None:
    for shape in _shapes():
        embedding = _made(subject, shape)
        first, second = (_embedded(embedding, shape).points for _ in range(2))
        difference = unlike(first, second)
        if difference is not None:
            raise ContractFailure(
                did=f"a {shape.name} was embedded twice",
                got=f"points that differ by up to {difference:.3g}",
                expected="the same, to the bit",
                fix="use a generator of a fixed seed and a fixed start for iterative solvers; keep"
                " nothing of one call for the next",
            )


@check(
    "embedding-isometry",
    kinds=["embedding"],
    why="a shape that was turned in its file must be cut as before",
)
def _isometry(subject: Subject) -> None:
    mirror = np.diag([1.0, -1.0, 1.0])
    # The last has more vertices than some embeddings look at one by one.
    for shape in (*_shapes(), pebble(3)):
        before = _distances(_bent(subject, shape))
        for what, matrix in (("turned", turn()), ("mirrored", mirror)):
            after = _distances(_bent(subject, _moved(shape, matrix, f"{what} {shape.name}")))
            difference = unlike(before, after, tolerance=_SAME)
            if difference is not None:
                raise ContractFailure(
                    did=f"a {shape.name} was embedded, and again after it was {what} and moved",
                    got=f"distances between elements that differ by up to {difference:.3g} of"
                    " the greatest",
                    expected="the same distances, but for their unit",
                    fix="begin from distances, or from axes of the shape; not from the file's axes"
                    " or its origin",
                )


def _distances(shape: Shape) -> FloatArray:
    """Distances of all pairs of elements, of the greatest."""
    distances = np.asarray(pdist(shape.points))
    share: FloatArray = distances / distances.max()
    return share
