"""Names that carry over: an earlier result of another shape as the start of a search.

Which of four legs is ``leg1`` no objective says. From one specimen to the next names stay with
their parts where a search does not begin with seeds, but with the centres of an earlier result,
laid onto the new shape: the surfaces are aligned (:mod:`moseg_core.shape.alignment`), the centres
go along, and the optimizer goes on from there (Sec. 7), as it does from a result of the same shape.

A :class:`Template` is what that takes of the earlier result, points of its surface instead of the
shape: so one is made once for many shapes, and handed to other processes. Where the partition is in
an embedding (Sec. 9), embedded surfaces are aligned; there a mirror image is as good as what it
mirrors, since distances say no more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Centers
from moseg_core.errors import ShapeError, UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.search.checked_partition import make_partition
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.restarts import searched_shape
from moseg_core.search.result import Result
from moseg_core.shape.alignment import Similarity, align_points, surface_samples
from moseg_core.shape.pins import NO_PINS
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, frozen

#: Super-elements that costs of ways are compared on, as many as a search has by default.
_RESOLUTION = 2000
#: Above this share of the diagonal two surfaces have little in common.
_FAR = 0.05


@dataclass(frozen=True, eq=False, kw_only=True)
class Template:
    """What a result says of other shapes of its kind.

    Parameters
    ----------
    name : str
        Of the shape.
    labels : tuple of str
    centers : Centers
        In units of the shape that was partitioned.
    samples : (P, 3) float, model units
        Points of that shape's surface.
    embedding : str or None
        That of the result.
    parameterization : str
        What its centres are centres of.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> problem = moseg.Problem(["handle", "head"], "narrow(handle)")
    >>> result = moseg.segment(hammer, problem, optimizer="pattern_search(max_evaluations=20)")
    >>> moseg.Template.of(result).labels
    ('handle', 'head')
    """

    name: str
    labels: tuple[str, ...]
    centers: Centers
    samples: FloatArray
    embedding: str | None
    parameterization: str = "voronoi"

    def __post_init__(self) -> None:
        for array in (self.samples, self.centers.positions, self.centers.weights):
            frozen(array)

    @classmethod
    def of(cls, result: Result) -> Template:
        """That of a result.

        Raises
        ------
        UsageError
            It is of several levels, whose centres belong to different partitions.
        """
        if not isinstance(result, Result):
            raise UsageError(
                f"a Result is needed, from moseg.load_result(path), not {result!r:.60}"
            )
        if isinstance(result.problem, Hierarchy):
            raise UsageError(
                "the result to start from is of several levels, whose centres belong to different"
                " partitions; start from a result of one level, such as result.levels['']"
            )
        embedding = result.problem.embedding
        return cls(
            name=result.shape.name,
            labels=tuple(result.problem.labels),
            centers=result.centers,
            samples=surface_samples(result.partitioned),
            embedding=None if embedding is None else str(embedding),
            parameterization=result.method.get("parameterization", "voronoi"),
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Alignment:
    """The centres of an earlier result, laid onto another shape: a start for a search.

    Parameters
    ----------
    labels : tuple of str
        What the parts are called, in the order of the earlier result.
    centers : Centers
        In units of the shape that is partitioned.
    similarity : Similarity
        From the earlier shape to this one: rotation, scale, shift, and how near they come.
    embedding : str or None
        In which both are partitioned.
    warnings : tuple of str
        What a user should know of it.
    """

    labels: tuple[str, ...]
    centers: Centers
    similarity: Similarity
    embedding: str | None = None
    warnings: tuple[str, ...] = ()

    @property
    def distance(self) -> float:
        """Mean distance between the surfaces, as a share of the diagonal; 0 is best."""
        return self.similarity.distance


def align(earlier: Result | Template, shape: Shape, problem: Problem | None = None) -> Alignment:
    """Lay the centres of an earlier result onto another shape of its kind.

    Parameters
    ----------
    earlier : Result or Template
        Of one level. For many shapes make one :class:`Template` of it.
    shape : Shape
    problem : Problem, optional
        What is asked for; by default that of the result. Where surfaces can be laid onto each other
        in several ways that are nearly as good, it decides: the way whose partition costs least.

    Returns
    -------
    Alignment
        For ``segment(shape, problem, start=alignment)``, which finds its labels by their names.

    Raises
    ------
    UsageError
        A result of several levels, or of another embedding than that of the problem.
    ShapeError
        The shape has no extent.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> problem = moseg.Problem(["handle", "head"], "narrow(handle)")
    >>> result = moseg.segment(hammer, problem, optimizer="pattern_search(max_evaluations=20)")
    >>> mesh = hammer.geometry
    >>> lying = moseg.Shape.from_mesh(3 * mesh.vertices[:, [2, 0, 1]], mesh.triangles)
    >>> alignment = moseg.align(result, lying)
    >>> round(alignment.similarity.scale, 3), alignment.distance < 1e-3
    (3.0, True)
    >>> found = moseg.segment(lying, problem, start=alignment)
    >>> moved = 3 * result.centers.positions[:, [2, 0, 1]]
    >>> bool(abs(alignment.centers.positions - moved).max() < 0.01 * lying.frame.scale)
    True
    """
    template = earlier if isinstance(earlier, Template) else Template.of(earlier)
    if problem is None and isinstance(earlier, Result) and isinstance(earlier.problem, Problem):
        problem = earlier.problem
    if not isinstance(shape, Shape):
        raise UsageError(f"align takes a Shape, from moseg.load(path), not {shape!r:.60}")
    embedding = None if problem is None or problem.embedding is None else str(problem.embedding)
    if embedding != template.embedding:
        raise UsageError(
            f"the result to start from was found in the embedding"
            f" '{template.embedding or 'none'}', and the problem is to be solved in"
            f" '{embedding or 'none'}'; give the same to both (--embedding"
            f" {template.embedding or 'none'})"
        )
    searched = shape if problem is None else problem.embed(shape)
    if not searched.frame.scale > 0.0:
        raise ShapeError(f"'{shape.name}' has no extent, so that nothing can be laid onto it")
    ways = align_points(template.samples, surface_samples(searched), mirrored=embedding is not None)
    rivals = [way for way in ways[1:] if ways[0].rivals(way)]
    similarity = ways[0]
    if problem is not None and rivals and sorted(template.labels) == sorted(problem.labels):
        similarity = _least_costly([similarity, *rivals], template, problem, searched)
    moved = _moved(template.centers, similarity)
    return Alignment(
        labels=template.labels,
        centers=moved,
        similarity=similarity,
        embedding=template.embedding,
        warnings=tuple(_warnings(similarity, rivals, template.name, shape.name)),
    )


def _moved(centers: Centers, similarity: Similarity) -> Centers:
    return replace(centers, positions=similarity.apply(centers.positions))


def _least_costly(
    ways: Sequence[Similarity], template: Template, problem: Problem, searched: Shape
) -> Similarity:
    """The way whose partition costs least, on super-elements of a large shape."""
    level = searched_shape(searched, _RESOLUTION, NO_PINS)
    choice = Choice.read(template.parameterization, "parameterization")
    ready = prepare(choice, "parameterization", problem.registry)
    evaluator = ProblemEvaluator(level, problem, make_partition(ready, level, problem))
    order = np.array([template.labels.index(name) for name in problem.labels])

    def cost(way: Similarity) -> Cost:
        centers = _moved(template.centers, way).ordered(order)
        return evaluator.evaluate(evaluator.parameterization.encode(centers)).cost

    return min(ways, key=cost)


def _warnings(
    similarity: Similarity, rivals: Sequence[Similarity], earlier: str, name: str
) -> list[str]:
    found = []
    if similarity.distance > _FAR:
        found.append(
            f"'{name}' is unlike '{earlier}': laid onto each other their surfaces are"
            f" {100 * similarity.distance:.2g} % of the diagonal apart; names may stand for other"
            " parts than there"
        )
    if rivals:
        found.append(
            f"'{earlier}' can be laid onto '{name}' in several ways that are nearly as good; names"
            " may have changed places"
        )
    return found
