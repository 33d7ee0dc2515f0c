"""Planes of symmetry: looked for everywhere, then improved where it pays.

1. A thousand normals over the half sphere, the principal axes and the axes of the file, each at
   eleven offsets from the centroid: an asymmetric limb pulls the centroid aside. Each of these
   planes is judged by some hundred points in a grid of distances.
2. The best, no two of them close together, are improved against the surface itself
   (:mod:`moseg_symmetry.refine`), first with few points and tolerantly, then with many.
3. A plane is one of symmetry if it maps at least :data:`ENOUGH` of the area to within
   :data:`NEAR` of the surface.

All of it is deterministic. Which plane is *the* plane is decided by :func:`preferred`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from moseg_core import Shape, ShapeError
from moseg_symmetry.motions import Reflection
from moseg_symmetry.planes import Plane, tidy
from moseg_symmetry.refine import SIGMA, loss, refined
from moseg_symmetry.surface import DistanceGrid, Surface, surface_of

FloatArray = npt.NDArray[np.float64]

#: A point is mapped onto the surface if its image is within this of it, in sizes.
NEAR = 0.01

#: Share of the area that a plane of symmetry maps onto the surface (docs/symmetry.md has why).
ENOUGH = 0.67

_NORMALS = 1000
_OFFSETS = np.linspace(-0.12, 0.12, 11)
_COARSE_POINTS, _FEW_POINTS, _MANY_POINTS = 300, 600, 4000
_COARSE_SIGMA = 0.03
_CANDIDATES = 16
_FINALISTS = 12
_PROMISING = 0.35
_FIRST = ((0.04, 8), (SIGMA, 8))
_ROUGHLY = 5e-3
_FINISHED = 4
_APART = np.sin(np.radians(12.0))
_SAME = 0.04
_AS_GOOD = 2e-4


@dataclass(frozen=True, eq=False, kw_only=True)
class PlaneSymmetry:
    """A plane and how well it maps the surface onto itself.

    Parameters
    ----------
    plane : Plane
        In model units.
    residual : float
        Root mean square distance of mirrored points from the surface, in sizes, each counted as
        2 % at most (:mod:`moseg_symmetry.refine`). 0 is best.
    share : float
        Share of the area that is mapped to within 1 % of the size of the surface. 1 is best.
    spread : float
        Root mean square distance of the surface from the plane, in sizes.
    """

    plane: Plane
    residual: float
    share: float
    spread: float

    @property
    def holds(self) -> bool:
        """Whether this is a plane of symmetry."""
        return self.share >= ENOUGH


def detect_planes(shape: Shape) -> list[PlaneSymmetry]:
    """Planes at which a shape is nearest to its mirror image, the best first.

    Parameters
    ----------
    shape : Shape
        Its input elements count.

    Returns
    -------
    list of PlaneSymmetry
        Up to twelve, at least one, no two of them nearly the same. Ask each whether it
        :attr:`~PlaneSymmetry.holds`. They are in the order of :func:`preferred`.

    Examples
    --------
    >>> import trimesh
    >>> brick = Shape.from_mesh(trimesh.creation.box(extents=(4, 2, 1)))
    >>> for found in detect_planes(brick):
    ...     if found.holds:
    ...         print(np.abs(found.plane.normal).round(6) + 0.0, round(found.share, 2))
    [1. 0. 0.] 1.0
    [0. 1. 0.] 1.0
    [0. 0. 1.] 1.0
    """
    surface = surface_of(shape)
    left = [_judged(surface, motion) for motion in reflections(surface)]
    found = []
    while left:
        found.append(preferred(left))
        left.remove(found[-1])
    return found


def require_plane(shape: Shape) -> PlaneSymmetry:
    """The plane of symmetry of a shape.

    Raises
    ------
    ShapeError
        It has none; says how far the best one is from being one.
    """
    found = detect_planes(shape)
    holding = [symmetry for symmetry in found if symmetry.holds]
    if holding:
        return holding[0]
    best = max(found, key=lambda symmetry: symmetry.share)
    raise ShapeError(
        f"'{shape.name}' has no plane of symmetry: the best one maps only {100 * best.share:.0f} %"
        f" of the surface onto itself within {100 * NEAR:.0f} % of its size, and"
        f" {100 * ENOUGH:.0f} % are asked for (residual {100 * best.residual:.2f} %,"
        f" plane {best.plane}); a plane can also be given"
    )


def preferred(found: Sequence[PlaneSymmetry]) -> PlaneSymmetry:
    """The one that ``auto`` means: the least residual; of those as good, the halves furthest apart.

    Residuals are as good if they differ by no more than 0.02 % of the size. Then the plane
    from which the surface spreads furthest is taken, which cuts a long table across; and of planes
    alike in this too (a cube's) the one whose normal is nearest to the x axis of the file, or to
    the y axis.
    """
    least = min(symmetry.residual for symmetry in found)
    left = [symmetry for symmetry in found if symmetry.residual <= least + _AS_GOOD]
    widest = max(symmetry.spread for symmetry in left)
    left = [symmetry for symmetry in left if symmetry.spread >= 0.995 * widest]
    for axis in range(3):
        along = max(abs(symmetry.plane.normal[axis]) for symmetry in left)
        left = [s for s in left if abs(s.plane.normal[axis]) >= along - 1e-3]
    return left[0]


def reflections(surface: Surface) -> list[Reflection]:
    """The best reflections of a surface, in the order of their residuals."""
    few, many = surface.samples(_FEW_POINTS), surface.samples(_MANY_POINTS)
    improved = [
        refined(surface, start, few, schedule=_FIRST, worth=_ROUGHLY)
        for start in _candidates(surface)
    ]
    losses, different = _different(surface, improved, few)
    # Some at least, so that the best can be named where none is good.
    count = min(max(_FINISHED, int((losses < _PROMISING).sum())), _FINALISTS)
    ended = [refined(surface, motion, many, schedule=[(SIGMA, 12)]) for motion in different[:count]]
    return _different(surface, ended, many)[1]


def half_sphere(n: int) -> FloatArray:
    """(n, 3) float: directions spread evenly over half of the unit sphere, along a spiral."""
    k = np.arange(n)
    z = (k + 0.5) / n
    turn = np.pi * (1.0 + np.sqrt(5.0)) * k  # the golden angle
    across = np.sqrt(1.0 - z * z)
    return np.stack([across * np.cos(turn), across * np.sin(turn), z], axis=1)


def _candidates(surface: Surface) -> list[Reflection]:
    """The most promising reflections by the grid of distances, far from each other."""
    grid, points = DistanceGrid.of(surface), surface.samples(_COARSE_POINTS)
    principal = np.linalg.eigh(points.T @ points)[1].T
    normals = np.concatenate([principal, np.eye(3), half_sphere(_NORMALS)])
    offsets, losses = np.empty(len(normals)), np.empty(len(normals))
    for i, normal in enumerate(normals):
        heights = points @ normal - _OFFSETS[:, None]
        images = points - 2.0 * heights[:, :, None] * normal
        by_offset = loss(grid.distances(images), _COARSE_SIGMA)
        least = int(by_offset.argmin())
        offsets[i], losses[i] = _OFFSETS[least], by_offset[least]
    chosen: list[int] = []
    for i in np.argsort(losses, kind="stable"):
        cosines = normals[chosen] @ normals[i]
        if (1.0 - cosines**2 >= _APART**2).all():
            chosen.append(int(i))
            if len(chosen) == _CANDIDATES:
                break
    return [Reflection(normals[i], float(offsets[i])) for i in chosen]


def _different(
    surface: Surface, motions: Sequence[Reflection], points: FloatArray
) -> tuple[FloatArray, list[Reflection]]:
    """The motions with their losses, best first, without those that are nearly a better one."""
    losses = np.array([loss(surface.distances(m.images(points)[0]), SIGMA) for m in motions])
    kept: list[int] = []
    for i in np.argsort(losses, kind="stable"):
        if all(motions[i].apart(motions[k]) > _SAME for k in kept):
            kept.append(int(i))
    return losses[kept], [motions[i] for i in kept]


def _judged(surface: Surface, motion: Reflection) -> PlaneSymmetry:
    points = surface.samples(_MANY_POINTS)
    distances = surface.distances(motion.images(points)[0])
    plane = motion.plane
    return PlaneSymmetry(
        plane=Plane.through(
            tidy(surface.center + surface.size * plane.point, surface.size), tidy(plane.normal, 1.0)
        ),
        residual=SIGMA * float(np.sqrt(loss(distances, SIGMA))),
        share=float((distances <= NEAR).mean()),
        spread=float(np.sqrt((plane.heights(points) ** 2).mean())),
    )
