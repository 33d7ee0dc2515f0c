"""One surface laid onto another by turning, scaling and moving it.

Where nothing is known of how two shapes lie, the axes of their second moments (PCA) say it up to
the axes' directions, and up to their order where moments are alike. Each of these ways is tried, of
shapes whose moments hardly differ the rotations of the octahedron turned by further steps as well;
the best few are improved by matching nearest points (iterated closest points, Besl and McKay 1992,
doi:10.1109/34.121791, in both directions, with the similarity of least squares of Umeyama 1991,
doi:10.1109/34.88573), and the one with the least mean distance between the surfaces, there and
back, is taken. Mirror images are no candidates unless asked for: the left leg would become the
right one.

Everything is computed on points that are spread evenly over the surfaces, so that it does not
matter how either is meshed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray

#: How many samples are taken, and about how many of them candidates are judged by at first, and
#: improved by.
SAMPLES, _FEW, _SOME = 12_000, 250, 500
#: Radians between rotations that are worth to be improved both.
_NEAR = 0.35
#: How many of the candidates are improved, in how many steps.
_IMPROVED, _STEPS = 8, 20
#: Share of the matches of a step that are used: the nearest ones.
_USED = 0.9
#: Second moments whose ratio is below this may belong to each other's axes.
_ALIKE = 1.3
#: How many times as far away as the best, and as samples are from each other, the best of the other
#: rotations must be, to be no rival; and how far apart (radians) rotations are others.
_RIVAL, _OTHER = 1.15, 0.6


@dataclass(frozen=True, eq=False, kw_only=True)
class Similarity:
    """A similarity ``x -> scale * rotation @ x + shift``, and how near it brings two surfaces.

    Parameters
    ----------
    rotation : (3, 3) float
        Orthogonal; of determinant 1 unless mirror images were allowed.
    scale : float
        Positive.
    shift : (3,) float, model units of the target
    distance : float
        Mean distance of points of either surface from the other, as a share of the diagonal of the
        target's samples; 0 is best.
    spacing : float
        How far samples are from each other, likewise: what a distance is uncertain by.
    """

    rotation: FloatArray
    scale: float
    shift: FloatArray
    distance: float
    spacing: float

    def apply(self, points: FloatArray) -> FloatArray:
        """(P, 3) points of the source where they come to lie, model units of the target."""
        moved: FloatArray = self.scale * points @ self.rotation.T + self.shift
        return moved

    def rivals(self, other: Similarity) -> bool:
        """Whether another lays the surfaces onto each other nearly as well."""
        return other.distance < _RIVAL * max(self.distance, self.spacing)


def surface_samples(shape: Shape, count: int = SAMPLES) -> FloatArray:
    """Points spread evenly over a surface; the same for the same shape in every run.

    Parameters
    ----------
    shape : Shape
    count : int

    Returns
    -------
    (count, 3) float, model units
        Of a shape without triangles some of its elements' points, by their areas.
    """
    geometry = shape.geometry
    at = (np.arange(count) + 0.5) / count
    if not len(geometry.triangles):
        sums = np.cumsum(shape.areas)
        chosen: FloatArray = shape.points[np.searchsorted(sums, at * sums[-1])]
        return chosen
    corners = geometry.vertices[geometry.triangles]
    sides = (corners[:, 1:] - corners[:, :1]) / shape.frame.scale
    sums = np.cumsum(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1))
    if not sums[-1] > 0.0:
        return surface_samples_of_points(corners.mean(axis=1), count)
    of = corners[np.searchsorted(sums, at * sums[-1])]
    # An additive sequence of low discrepancy in the unit square, folded into the triangle (Roberts
    # 2018, "The unreasonable effectiveness of quasirandom sequences").
    u, v = np.modf(np.outer([0.7548776662466927, 0.5698402909980532], np.arange(count)))[0]
    folded = u + v > 1.0
    u, v = np.where(folded, 1.0 - u, u), np.where(folded, 1.0 - v, v)
    points: FloatArray = (
        (1.0 - u - v)[:, None] * of[:, 0] + u[:, None] * of[:, 1] + v[:, None] * of[:, 2]
    )
    return points


def surface_samples_of_points(points: FloatArray, count: int) -> FloatArray:
    """(count, 3) some of the points, at equal distances in their order."""
    chosen: FloatArray = points[np.linspace(0, len(points) - 1, count).round().astype(np.int64)]
    return chosen


def align_points(
    source: FloatArray, target: FloatArray, *, mirrored: bool = False
) -> list[Similarity]:
    """Ways to lay one surface onto another, of different rotations, the nearest first.

    Parameters
    ----------
    source, target : (P, 3) float, model units of each
        Points spread evenly over either, such as :func:`surface_samples`.
    mirrored : bool
        Whether mirror images are candidates too.

    Examples
    --------
    >>> corner = np.array([[0.0, 0, 0], [3, 0, 0], [2, 0, 0], [1, 0, 0], [0, 2, 0], [0, 1, 0],
    ...                    [0, 0, 1]])
    >>> turned = 5 * corner[:, [1, 2, 0]] + 7
    >>> best, *others = align_points(corner, turned)
    >>> bool(np.allclose(best.apply(corner), turned)), round(best.scale, 6)
    (True, 5.0)
    """
    one, own = _normed(source)
    other, its = _normed(target)
    few, many = _thinned(one, _FEW), _thinned(other, _FEW)
    tree = cKDTree(many)
    candidates = _rotations(one, other, mirrored=mirrored)
    judged = [_distance(few @ rotation.T, many, tree) for rotation in candidates]
    best = candidates[np.argsort(judged, kind="stable")]
    some, others = _thinned(one, _SOME), _thinned(other, _SOME)
    near, whole, back = cKDTree(others), cKDTree(other), cKDTree(one)
    apart = np.asarray(whole.query(others, k=min(2, len(other)))[0]).reshape(len(others), -1)
    diagonal = float(np.linalg.norm(np.ptp(target, axis=0))) or 1.0
    share = its[1] / diagonal
    found = []
    for start in _distinct(best, _IMPROVED * (2 if mirrored else 1)):
        rotation, scale, shift = _improved(some, others, near, start)
        # Of few points to all of the other surface, so that little of it is how these lie.
        there = np.mean(whole.query(scale * some @ rotation.T + shift)[0])
        here = scale * np.mean(back.query((others - shift) @ rotation / scale)[0])
        # From normed coordinates to the user's.
        factor = its[1] / own[1] * scale
        found.append(
            Similarity(
                rotation=rotation,
                scale=factor,
                shift=its[0] + its[1] * shift - factor * rotation @ own[0],
                distance=float(there + here) / 2.0 * share,
                spacing=float(apart[:, -1].mean()) * share,
            )
        )
    found.sort(key=lambda each: each.distance)
    kept: list[Similarity] = []
    for each in found:
        if all(_angle(each.rotation, one.rotation) > _OTHER for one in kept):
            kept.append(each)
    return kept


def _thinned(points: FloatArray, count: int) -> FloatArray:
    return points[:: max(1, len(points) // count)]


def _distinct(rotations: FloatArray, count: int) -> list[FloatArray]:
    """The first rotations of which none is near another."""
    kept: list[FloatArray] = []
    for rotation in rotations:
        if all(_angle(rotation, other) > _NEAR for other in kept):
            kept.append(rotation)
        if len(kept) == count:
            break
    return kept


def _normed(points: FloatArray) -> tuple[FloatArray, tuple[FloatArray, float]]:
    """Points about their middle, with a mean square distance of 1 from it; middle and size."""
    middle = points.mean(axis=0)
    away = points - middle
    largest = float(np.abs(away).max()) or 1.0
    size = largest * float(np.sqrt(((away / largest) ** 2).sum(axis=1).mean())) or 1.0
    return away / size, (middle, size)


def _rotations(one: FloatArray, other: FloatArray, *, mirrored: bool) -> FloatArray:
    """(k, 3, 3) float: ways to lay the axes of the one onto those of the other."""
    (moments, axes), (_, its) = np.linalg.eigh(one.T @ one), np.linalg.eigh(other.T @ other)
    for frame in (axes, its):
        frame[:, 2] *= np.sign(np.linalg.det(frame))
    turns: npt.NDArray[np.float64] = np.asarray(Rotation.create_group("O").as_matrix())
    # Axes of like moments lie anywhere in their plane.
    least = np.maximum(moments, 1e-9 * moments[2])
    steps = Rotation.from_euler("z", [[0], [30], [60]], degrees=True).as_matrix()
    if moments[2] < _ALIKE * least[0]:
        icosahedron = Rotation.create_group("I").as_matrix()
        quarter = Rotation.from_euler("z", 90, degrees=True).as_matrix()
        turns = np.concatenate([icosahedron, icosahedron @ quarter])
    elif moments[1] < _ALIKE * least[0]:  # the first two, about the third
        turns = (turns[:, None] @ steps).reshape(-1, 3, 3)
    elif moments[2] < _ALIKE * least[1]:  # the last two, about the first
        about_x = Rotation.from_euler("x", [[0], [30], [60]], degrees=True).as_matrix()
        turns = (turns[:, None] @ about_x).reshape(-1, 3, 3)
    if mirrored:
        turns = np.concatenate([turns, turns * np.array([1.0, 1.0, -1.0])])
    found: FloatArray = its @ turns @ axes.T
    return found


def _distance(one: FloatArray, other: FloatArray, tree: cKDTree) -> float:
    """Mean distance of the points of either set from the other."""
    there, back = tree.query(one)[0], cKDTree(one).query(other)[0]
    return float(np.mean(there) + np.mean(back)) / 2.0


def _improved(
    one: FloatArray, other: FloatArray, tree: cKDTree, rotation: FloatArray
) -> tuple[FloatArray, float, FloatArray]:
    """The best similarity near a rotation: rotation, scale and shift."""
    scale, shift = 1.0, np.zeros(3)
    best = _distance(one @ rotation.T, other, tree), rotation, scale, shift
    mirror = np.sign(np.linalg.det(rotation))
    for _ in range(_STEPS):
        moved = scale * one @ rotation.T + shift
        away, near = tree.query(moved)
        back, nearest = cKDTree(moved).query(other)
        both = np.concatenate([away, back])
        used = np.argsort(both, kind="stable")[: int(_USED * len(both))]
        left = np.concatenate([one, one[nearest]])[used]
        right = np.concatenate([other[near], other])[used]
        rotation, scale, shift = _fitted(left, right, mirror)
        distance = _distance(scale * one @ rotation.T + shift, other, tree)
        if distance < best[0] * (1.0 - 1e-3):
            best = distance, rotation, scale, shift
        else:
            break
    return best[1:]


def _fitted(
    left: FloatArray, right: FloatArray, mirror: float
) -> tuple[FloatArray, float, FloatArray]:
    """The similarity of least squares from points to points (Umeyama 1991)."""
    middle, its = left.mean(axis=0), right.mean(axis=0)
    spread = (right - its).T @ (left - middle)
    u, sizes, v = np.linalg.svd(spread)
    signs = np.ones(3)
    if np.linalg.det(u @ v) * mirror < 0:
        signs[2] = -1.0
    rotation = (u * signs) @ v
    total = float(((left - middle) ** 2).sum())
    scale = float((sizes * signs).sum()) / total if total > 0.0 else 1.0
    scale = min(max(scale, 0.5), 2.0)  # about that of equal second moments
    return rotation, scale, its - scale * rotation @ middle


def _angle(one: FloatArray, other: FloatArray) -> float:
    """By how much two rotations differ, radians; pi where one of them mirrors."""
    turn = one @ other.T
    if np.linalg.det(turn) < 0:
        return np.pi
    return float(np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0)))
