"""Axes of symmetry: about which a shape is the same after a part of a turn, or after any turn.

As for planes (:mod:`moseg_symmetry.plane_detection`), axes in all directions are judged by a grid
of distances, and the best improved against the surface (:mod:`moseg_symmetry.refine`). They begin
at the centroid, through which every exact axis goes. Tried are turns by ``360 / n`` degrees for
``n`` from 2 to 12, and for surfaces of revolution three angles at once that no prism of few sides
allows. A found axis is judged by all the turns of its kind.

An axis of many sides is one of few, too: a hexagonal prism has 2, 3 and 6 about one axis. Said is
the greatest number whose residual is as small as any; and *any angle* where that is as small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from moseg_core import Shape
from moseg_symmetry.motions import Turns
from moseg_symmetry.plane_detection import ENOUGH, NEAR, half_sphere
from moseg_symmetry.planes import tidy
from moseg_symmetry.refine import SIGMA, loss, refined
from moseg_symmetry.surface import DistanceGrid, Surface, surface_of

FloatArray = npt.NDArray[np.float64]

#: The most sides that are counted.
MOST = 12

#: Far from the turns that leave a regular prism of two to twelve sides as it is.
_ROUND: FloatArray = np.radians([25.0, 55.0, 105.0])

_DIRECTIONS = 1000
_COARSE_POINTS, _FEW_POINTS, _MANY_POINTS = 200, 500, 3000
_COARSE_SIGMA = 0.03
_PROMISING = 0.6
_CANDIDATES = {2: 9, 3: 4, 4: 3}
_FIRST = ((0.04, 6), (SIGMA, 10))
_ROUGHLY = 1e-2
_APART = np.sin(np.radians(12.0))
_SAME = 0.04
_AS_GOOD = 1e-3


@dataclass(frozen=True, eq=False, kw_only=True)
class AxisSymmetry:
    """An axis, and how well turns about it map the surface onto itself.

    Parameters
    ----------
    point : (3,) float, model units
        The point of the axis nearest to the centroid.
    direction : (3,) float
        Of length 1, its component of greatest size positive.
    fold : int or None
        The surface is the same `fold` times in a full turn; None after any turn, as a surface of
        revolution.
    residual : float
        Root mean square distance of turned points from the surface, in sizes, each counted as 2 %
        at most; over all turns by ``360 / fold`` degrees, or over three for all. 0 is best.
    share : float
        Share of the area that is mapped to within 1 % of the size of the surface. 1 is best.
    """

    point: FloatArray
    direction: FloatArray
    fold: int | None
    residual: float
    share: float

    @property
    def holds(self) -> bool:
        """Whether this is an axis of symmetry."""
        return self.share >= ENOUGH


def detect_axes(shape: Shape) -> list[AxisSymmetry]:
    """Axes of symmetry of a shape: those of revolution first, then by the number of sides.

    Parameters
    ----------
    shape : Shape
        Its input elements count.

    Returns
    -------
    list of AxisSymmetry
        Those that hold; empty where there is none.

    Examples
    --------
    >>> import trimesh
    >>> brick = Shape.from_mesh(trimesh.creation.box(extents=(2, 2, 5)))
    >>> [axis.fold for axis in detect_axes(brick)]
    [4, 2, 2, 2, 2]
    >>> (np.abs(detect_axes(brick)[0].direction).round(3) + 0.0).tolist()
    [0.0, 0.0, 1.0]
    """
    surface = surface_of(shape)
    few, many = surface.samples(_FEW_POINTS), surface.samples(_MANY_POINTS)
    found: list[tuple[Turns, AxisSymmetry]] = []
    for fold, start in _candidates(surface):
        motion = refined(surface, start, few, schedule=_FIRST, worth=_ROUGHLY)
        if loss(surface.distances(motion.images(few).reshape(-1, 3)), SIGMA) > _PROMISING:
            continue
        motion = refined(surface, motion, many, schedule=[(SIGMA, 6)])
        judged = _judged(surface, motion, fold, many)
        if judged.holds:
            found.append((motion, judged))
    groups: list[list[tuple[Turns, AxisSymmetry]]] = []
    for pair in found:
        for group in groups:
            if pair[0].apart(group[0][0]) < _SAME:
                group.append(pair)
                break
        else:
            groups.append([pair])
    best = [_greatest([judged for _, judged in group]) for group in groups]
    if sum(axis.fold is None for axis in best) > 1:  # a ball: all other axes say less
        best = [axis for axis in best if axis.fold is None]
    return sorted(best, key=lambda axis: (-_rank(axis), round(axis.residual, 6)))


def _rank(axis: AxisSymmetry) -> int:
    return MOST + 1 if axis.fold is None else axis.fold


def _greatest(axes: Sequence[AxisSymmetry]) -> AxisSymmetry:
    """The one with the most sides whose residual is as small as any."""
    least = min(axis.residual for axis in axes)
    return max((a for a in axes if a.residual <= least + _AS_GOOD), key=_rank)


def _candidates(surface: Surface) -> list[tuple[int | None, Turns]]:
    """For every number of sides the most promising axes, far from each other.

    As many as there can be: a cube has four axes of 3 and three of 4.
    """
    grid, points = DistanceGrid.of(surface), surface.samples(_COARSE_POINTS)
    principal = np.linalg.eigh(points.T @ points)[1].T
    directions = np.concatenate([principal, np.eye(3), half_sphere(_DIRECTIONS)])
    kinds: list[int | None] = [None, *range(MOST, 1, -1)]
    angles = np.concatenate([_ROUND, [2.0 * np.pi / fold for fold in kinds if fold]])
    losses = np.empty((len(directions), len(angles)))
    for i, direction in enumerate(directions):
        images = Turns(direction, np.zeros(3), angles).images(points)
        losses[i] = loss(grid.distances(images), _COARSE_SIGMA)
    by_kind = np.column_stack([losses[:, : len(_ROUND)].mean(axis=1), losses[:, len(_ROUND) :]])
    found: list[tuple[int | None, Turns]] = []
    for fold, column in zip(kinds, by_kind.T, strict=True):
        chosen: list[int] = []
        most = _CANDIDATES.get(fold or 0, 2)
        for i in np.argsort(column, kind="stable"):
            if column[i] > _PROMISING or len(chosen) == most:
                break
            cosines = directions[chosen] @ directions[i]
            if (1.0 - cosines**2 >= _APART**2).all():
                chosen.append(int(i))
        turn = _ROUND if fold is None else np.array([2.0 * np.pi / fold])
        found += [(fold, Turns(directions[i], np.zeros(3), turn)) for i in chosen]
    return found


def _judged(surface: Surface, motion: Turns, fold: int | None, points: FloatArray) -> AxisSymmetry:
    """An axis with its values over all the turns of its kind."""
    # A turn and its inverse say about the same.
    turns = _ROUND
    if fold is not None:
        turns = 2.0 * np.pi / fold * np.arange(1, fold // 2 + 1, dtype=np.float64)
    whole = Turns(motion.direction, motion.point, turns)
    distances = surface.distances(whole.images(points).reshape(-1, 3))
    direction = whole.direction
    sign = np.sign(direction[np.argmax(np.abs(direction))])
    foot = whole.point - (whole.point @ direction) * direction
    return AxisSymmetry(
        point=tidy(surface.center + surface.size * foot, surface.size),
        direction=tidy(sign * direction, 1.0),
        fold=fold,
        residual=SIGMA * float(np.sqrt(loss(distances, SIGMA))),
        share=float((distances <= NEAR).mean()),
    )
