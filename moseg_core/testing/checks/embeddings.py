"""Checks of embeddings: the same elements, elsewhere (Sec. 9).

The partition is found in the embedded shape and its labels are read as those of the original,
element by element. So the two must have the same elements in the same order; and where the
original is turned, mirrored, or has its faces turned inward, as those of many files are, what
becomes of it must be cut the same way. The method is blind to where an embedded shape lies, how
large it is and which way round, so only the ratios of distances between its elements are compared:
a scaling of distances may come out mirrored.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.spatial.distance import pdist

from moseg_core.errors import MosegError
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.comparison import expect_equal, unlike
from moseg_core.testing.fixtures.shapes import faces_of, lump, mapped, rotation
from moseg_core.testing.fixtures.trial import made
from moseg_core.types import FloatArray

#: Of the greatest distance. Iterations that stop a little sooner or later must be allowed for.
_SAME = 1e-3
_ELSEWHERE = (5.0, 40.0, -3.0)


def _embedded(
    subject: Subject, shape: Shape, embedding: Callable[..., Shape] | None = None
) -> Shape:
    try:
        return (embedding or made(subject, meets=(shape,)))(shape)
    except MosegError as error:
        raise Skip(f"it refuses a closed surface in one piece: {error}") from error


def _shapes() -> Iterator[Shape]:
    yield lump()
    yield mapped(lump(1), np.diag([1.0, 1.0, 2.0]), _ELSEWHERE, name="long lump")


@check("embedding-elements", kinds=["embedding"])
def _elements(subject: Subject) -> None:
    """Labels of the embedded shape are taken for those of the original, element by element."""
    for shape in _shapes():
        found = _embedded(subject, shape)
        own = isinstance(found, Shape)
        if not own or found.points.shape != shape.points.shape:
            count = f" of {len(found.points)} elements" if own else ""
            raise ContractFailure(
                did=f"it was given a {shape.name} of {shape.n_elements} faces",
                got=f"a {type(found).__name__}{count}",
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


@check("embedding-finite", kinds=["embedding"])
def _finite(subject: Subject) -> None:
    """A point at no finite place is nearest to no centre."""
    for shape in _shapes():
        found = _embedded(subject, shape)
        for name, array in {"points": found.points, "areas": found.areas}.items():
            if wrong := int((~np.isfinite(array)).sum()):
                raise ContractFailure(
                    did=f"it was given a {shape.name}",
                    got=f"{wrong} numbers in the {name} of the embedded shape that are not finite",
                    expected="finite numbers only",
                    fix="look for distances of 0 that are divided by, and for vertices that"
                    " nothing reaches",
                )


@check("embedding-deterministic", kinds=["embedding"])
def _deterministic(subject: Subject) -> None:
    """The embedding is computed anew in each process and run; results must not hang on that."""
    for shape in _shapes():
        embedding = made(subject, meets=(shape,))
        first, second = (_embedded(subject, shape, embedding).points for _ in range(2))
        expect_equal(
            first,
            second,
            did=f"a {shape.name} was embedded twice",
            got="points that differ by up to {}",
            expected="the same, to the bit",
            fix="use a generator of a fixed seed and a fixed start for iterative solvers; keep"
            " nothing of one call for the next",
        )


@check("embedding-isometry", kinds=["embedding"])
def _isometry(subject: Subject) -> None:
    """A shape that was turned in its file must be cut as before."""
    # The last has more vertices than some embeddings look at one by one.
    for shape in (*_shapes(), lump(3)):
        before = _distances(_embedded(subject, shape))
        for what, other in _alike(shape):
            expect_equal(
                before,
                _distances(_embedded(subject, other)),
                tolerance=_SAME,
                did=f"a {shape.name} was embedded, and again after it was {what}",
                got="distances between elements that differ by up to {} of the greatest",
                expected="the same distances, but for their unit",
                fix="begin from distances, or from axes of the shape; not from the file's axes,"
                " its origin or the side to which its faces are turned",
            )


def _alike(shape: Shape) -> Iterator[tuple[str, Shape]]:
    """The same surface in other words, and what was done to it."""
    motions = {"turned": rotation(3), "mirrored": np.diag([1.0, -1.0, 1.0])}
    for what, matrix in motions.items():
        yield f"{what} and moved", mapped(shape, matrix, _ELSEWHERE, name=f"{what} {shape.name}")
    inward = [face[::-1] for face in faces_of(shape)]
    vertices = shape.geometry.vertices
    yield "turned inside out", Shape.from_mesh(vertices, inward, name=f"inward {shape.name}")


def _distances(shape: Shape) -> FloatArray:
    """Distances of all pairs of elements, of the greatest."""
    distances = np.asarray(pdist(shape.points))
    share: FloatArray = distances / distances.max()
    return share
