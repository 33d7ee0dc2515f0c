"""A result with its boundaries clipped below mesh resolution (Sec. 4, Fig. 2).

:mod:`moseg_core.clipping` cuts a labelled mesh along the boundaries of a partition of space; here
labels and centres are a result's, and its parameterization says where the boundaries are. One that
does not know is refused by name, and so are boundaries that a refiner has moved
(:mod:`moseg_core.search.refinement`): they are no longer where the centres say.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from moseg_core.clipping.bisector import Bisectors
from moseg_core.clipping.boundaries import Boundaries, DistanceField
from moseg_core.clipping.clip import check_clippable, clip_along
from moseg_core.components.chosen import Choice, PreparedComponent, prepare
from moseg_core.components.discovery.registry import NOT_INSTALLED
from moseg_core.components.discovery.specs import Kind
from moseg_core.errors import UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import SearchOptions
from moseg_core.search.checked_partition import make_partition
from moseg_core.search.request import prepare_components

if TYPE_CHECKING:
    from moseg_core.search.result import Result
    from moseg_core.shape.shape import Shape


def check_clipping(tasks: Iterable[Hierarchy], options: SearchOptions) -> None:
    """Refuse problems whose results cannot be clipped.

    Raises
    ------
    UsageError
        One of them is of several levels, or its components give nothing to clip by.
    """
    for task in tasks:
        check_components(prepare_components(task.problem, options.settled(task.search)))
        if task.children:
            raise UsageError("boundaries can be clipped for results of one level only, so far")


def clip(result: Result, *, space: Shape | None = None) -> Result:
    """The result with its boundaries clipped below mesh resolution.

    Labels, parts and cost stay those of the input faces; :attr:`Result.clipped` is added, which
    the formats that show the surface (``.ply``, ``.glb``, ``.png``) then use.

    Parameters
    ----------
    result : Result
    space : Shape, optional
        The shape, face for face and vertex for vertex, in the space where the partition lives,
        whose units the centres are in; by default :attr:`Result.partitioned`.

    Raises
    ------
    UsageError
        The result was found with a parameterization that does not know where parts meet between
        elements, a refiner has moved its boundaries, parts of different numbers of centres have
        exchanged their labels, or it is one of several levels.
    ShapeError
        The shape is no mesh, or `space` does not have its faces and vertices.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> shape = moseg.load(moseg.sample_path("hammer"))
    >>> problem = moseg.Problem(["handle", "head"], "narrow(handle)")
    >>> result = moseg.segment(shape, problem, optimizer="pattern_search(max_evaluations=20)")
    >>> clipped = moseg.clip(result).clipped
    >>> clipped.mesh.n_polygons > shape.n_elements
    True
    """
    if result.levels:
        raise UsageError(
            "boundaries can be clipped for results of one level only, so far; clip one of"
            " result.levels, such as result.levels['']"
        )
    if result.refined:
        raise _moved(f"refiner '{result.method['refiner']}'")
    name = result.method["parameterization"].partition("(")[0]
    if result.versions.get(name) == NOT_INSTALLED:
        raise UsageError(
            f"boundaries cannot be clipped: the parameterization '{name}' is not installed; put it"
            " into a bundle (moseg plugin new)"
        )
    choice = Choice.read(result.method["parameterization"], "parameterization")
    ready = prepare(choice, "parameterization", result.problem.registry)
    check_parameterization(ready)
    mesh = check_clippable(result.shape)
    space = result.partitioned if space is None else space
    clipped = clip_along(
        mesh,
        result.labels,
        space.points,
        _boundaries(ready, space, result),
        n_parts=len(result.problem.labels),
        places=space.geometry.vertices,
    )
    return replace(result, clipped=clipped)


def _boundaries(ready: PreparedComponent, space: Shape, result: Result) -> Boundaries:
    """Where the parts of a partition meet: in closed form where it says how, else by distances.

    Parts of several centres have no bisector of their own; the nearest of these counts.
    """
    centers = result.centers
    if getattr(ready.factory, "weighted_bisectors", False) and centers.parts is None:
        return Bisectors(centers.positions, centers.weights)
    assert isinstance(result.problem, Problem)  # results of several levels are refused
    partition = make_partition(ready, space, result.problem)
    vector = partition.encode(centers)
    if centers.parts is not None and (partition.labels(vector[None])[0] != result.labels).any():
        raise UsageError(
            "boundaries of parts that have exchanged their labels, and have different numbers of"
            " centres, cannot be clipped: clipping follows the centres; leave the clipping out, or"
            " give each part one centre"
        )
    return DistanceField(partial(partition.distances, vector))


def check_components(ready: Mapping[Kind, PreparedComponent]) -> None:
    """Refuse the components of a run whose boundaries cannot be clipped afterwards.

    Parameters
    ----------
    ready : mapping of kind to PreparedComponent

    Raises
    ------
    UsageError
        With the name of the parameterization or the refiner.
    """
    check_parameterization(ready["parameterization"])
    if "refiner" in ready:
        raise _moved(ready["refiner"].who)


def _moved(who: str) -> UsageError:
    """Why boundaries that a refiner moves cannot be clipped."""
    return UsageError(
        f"boundaries that the {who} moves cannot be clipped: clipping follows the centres, and they"
        " are no longer where the centres say; leave the clipping out, or the refiner"
        " (--refiner none)"
    )


def check_parameterization(ready: PreparedComponent) -> None:
    """Refuse a parameterization that does not know where its parts meet between elements.

    Raises
    ------
    UsageError
        With its name.
    """
    known = getattr(ready.factory, "weighted_bisectors", False)
    if not known and not hasattr(ready.factory, "distances"):
        raise UsageError(
            f"boundaries of the {ready.who} cannot be clipped: it does not say how far points are"
            " from its parts; leave the clipping out, or use another parameterization"
        )
