"""A result with its boundaries clipped below mesh resolution (Sec. 4, Fig. 2).

:mod:`moseg_core.clipping` cuts a labelled mesh along the bisectors of given centres; here the
labels and centres are a result's.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from moseg_core.clipping.clip import check_clippable, clip_boundaries
from moseg_core.errors import UsageError

if TYPE_CHECKING:
    from moseg_core.search.result import Result
    from moseg_core.shape.shape import Shape


PARAMETERIZATION = "core:voronoi"
"""The parameterization whose boundaries are weighted bisectors."""


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
        The result was not found with weighted Voronoi partitions, or is one of several levels.
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
    check_parameterization(result.method.get("parameterization", PARAMETERIZATION))
    mesh = check_clippable(result.shape)
    space = result.partitioned if space is None else space
    return replace(
        result,
        clipped=clip_boundaries(
            mesh,
            result.labels,
            space.points,
            result.centers.positions,
            result.centers.weights,
            places=space.geometry.vertices,
        ),
    )


def check_parameterization(name: str) -> None:
    """Refuse a parameterization whose boundaries are not weighted bisectors.

    Raises
    ------
    UsageError
        With its name.
    """
    if name.partition("(")[0] != PARAMETERIZATION:
        raise UsageError(
            f"boundaries can be clipped for the parameterization '{PARAMETERIZATION}' only,"
            f" not for '{name}'"
        )
