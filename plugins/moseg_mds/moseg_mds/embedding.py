"""A shape stretched out: the embedding of Sec. 9, in which bent limbs lie apart.

A weighted Voronoi partition cannot separate two limbs that wind around each other. Distances along
the surface do not know of the winding; so the shape is deformed until its distances in space are
about those along its surface, and partitioned there. Face by face the labels are those of the
original.

How the vertices get their places::

    Surface.of        each position once                          surface.py
    farthest_points   a few hundred landmarks, distances from     landmarks.py
                      each to every vertex                        geodesics.py, paths.py
    classical_mds     landmarks by their distances                scaling.py
    majorize          landmarks by less stress                    majorize.py
    carry_along       all other vertices with the landmarks       carry.py
    place             these by less stress                        majorize.py

Stress knows no inside and outside: a limb turned inside out, like a glove, has the same. What keeps
the surface from turning is where the search for less stress begins: at the shape's own pose, from
which limbs unbend as they are. Where that gets stuck, the landmarks begin at classical scaling
instead. The result is turned so that it lies as the original does, mirrored where needed to keep
the sign of the enclosed volume.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import numpy.typing as npt

from moseg_core import Interval, Shape, UsageError
from moseg_mds.carry import carry_along, handedness, turned_like
from moseg_mds.geodesics import METHODS, distance_solver
from moseg_mds.landmarks import farthest_points
from moseg_mds.majorize import majorize, place, stress, stress_weights
from moseg_mds.scaling import classical_mds, landmark_mds, normalized_stress
from moseg_mds.surface import Surface

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

#: The pose's own start is kept unless the other ends with a stress this much lower.
_BETTER = 0.98

#: Steps for the vertices between the landmarks: more of them lower the stress by nothing that
#: shows, and crumple thin limbs.
_STEPS = 8

_LANDMARKS = Interval(4, 2000)
_STEPS_ALLOWED = Interval(0, 100_000)
_EXPONENTS = Interval(0, 4)


@dataclass(frozen=True, eq=False, kw_only=True)
class Embedded:
    """An embedding, and what there is to say of it.

    Parameters
    ----------
    shape : Shape
        In the space ``mds``: its box has its centre at 0 and the diagonal 1.
    stress : float
        :func:`~moseg_mds.scaling.normalized_stress` between landmarks and all vertices.
    method : str
        How distances were computed: ``exact``, ``heat`` or ``graph``.
    landmarks : int
        How many.
    """

    shape: Shape
    stress: float
    method: str
    landmarks: int


class MDS:
    """The embedding ``mds``: multidimensional scaling of distances along the surface (Sec. 9).

    Parameters
    ----------
    geodesics : {"auto", "exact", "heat", "graph"}
        How distances along the surface are computed (:mod:`moseg_mds.geodesics`).
    landmarks : int
        Vertices from which they are computed, 4 to 2000; all where the shape has no more. The
        time grows in proportion, and from about 500 on with the third power.
    refine : int
        Steps of stress majorisation at most; 0 for plain landmark scaling.
    exponent : float
        The weight of a distance d in the stress is ``d**-exponent``: at 0 long distances rule, at
        2 limbs keep their thickness.

    Raises
    ------
    UsageError
        There are no such geodesics, or a number is out of bounds.

    Examples
    --------
    A strip bent to a right angle is flat again, and lies along one axis:

    >>> x, y, z = [0, 1, 2, 2, 2], [0, 0, 0, 0, 0], [0, 0, 0, 1, 2]
    >>> left, right = np.c_[x, y, z], np.c_[x, np.add(y, 1), z]
    >>> quads = [[k, k + 1, k + 6, k + 5] for k in range(4)]
    >>> bent = Shape.from_mesh(np.r_[left, right], quads)
    >>> flat = MDS()(bent)
    >>> length, width, height = np.linalg.svd(flat.geometry.vertices)[1]
    >>> bool(height < 1e-6 * length)
    True
    """

    def __init__(
        self,
        *,
        geodesics: str = "auto",
        landmarks: Annotated[int, _LANDMARKS] = 200,
        refine: Annotated[int, _STEPS_ALLOWED] = 1000,
        exponent: Annotated[float, _EXPONENTS] = 2.0,
    ) -> None:
        if geodesics not in METHODS:
            raise UsageError(f"geodesics='{geodesics}' is unknown; known: {', '.join(METHODS)}")
        for name, value, allowed in (
            ("landmarks", landmarks, _LANDMARKS),
            ("refine", refine, _STEPS_ALLOWED),
            ("exponent", exponent, _EXPONENTS),
        ):
            if value not in allowed:
                raise UsageError(f"{name} is {value:g}; allowed is {allowed}")
        self.geodesics = geodesics
        self.landmarks = landmarks
        self.refine = refine
        self.exponent = exponent

    def __call__(self, shape: Shape) -> Shape:
        """Embed a shape; see :func:`embed`."""
        return self.embed(shape).shape

    def embed(self, shape: Shape) -> Embedded:
        """Embed a shape, and say how.

        Parameters
        ----------
        shape : Shape
            In one piece. It may be open, and no volume is needed.

        Returns
        -------
        Embedded

        Raises
        ------
        ShapeError
            It is in several pieces; or unfit for the geodesics that were asked for.
        """
        surface = Surface.of(shape)
        solver = distance_solver(surface.vertices, surface.triangles, self.geodesics)
        # The order of vertices changes when a shape is turned; which one is far out does not.
        out = np.linalg.norm(surface.vertices - surface.vertices.mean(axis=0), axis=1)
        landmarks, table = farthest_points(solver.distances, self.landmarks, near=int(out.argmax()))
        if self.refine:
            places = self._refined(surface, landmarks, table)
        else:
            places = landmark_mds(table, landmarks)
        places = _turned(places, surface, closed=shape.volume_source == "exact")
        found = normalized_stress(table, places[landmarks], places)
        middle = (places.max(axis=0) + places.min(axis=0)) / 2.0
        unit = (places - middle) / np.linalg.norm(np.ptp(places, axis=0))
        return Embedded(
            shape=shape.deformed(unit[surface.origin], space="mds"),
            stress=found,
            method=solver.method,
            landmarks=len(landmarks),
        )

    def _refined(self, surface: Surface, landmarks: IntArray, table: FloatArray) -> FloatArray:
        """(N, 3) float: places of little stress."""
        among = table[:, landmarks]
        among = (among + among.T) / 2.0
        own = surface.vertices[landmarks]
        moved = self._moved(among, own)
        if len(landmarks) == len(surface.vertices):
            places = np.empty_like(surface.vertices)
            places[landmarks] = moved
            return places
        start = carry_along(surface.vertices, table, own, moved)
        weights = stress_weights(table, self.exponent)
        return place(table, moved, start, weights=weights, steps=_STEPS)

    def _moved(self, among: FloatArray, own: FloatArray) -> FloatArray:
        """(k, 3) float: places of little stress for the landmarks, given their own."""
        weights = stress_weights(among, self.exponent)
        # Distances in space are too short: enlarged, the pose has the least stress that it can.
        apart = np.linalg.norm(own[:, None] - own, axis=2)
        size = float((weights * among * apart).sum() / (weights * apart**2).sum())
        starts = [own * size, classical_mds(among)]
        ends = [majorize(among, start, weights=weights, steps=self.refine) for start in starts]
        unbent, scaled = (stress(among, end, weights) for end in ends)
        if scaled >= _BETTER * unbent:
            return ends[0]
        mirrored = handedness(among, own, ends[1]) < 0.0
        return -ends[1] if mirrored else ends[1]


def _turned(places: FloatArray, surface: Surface, *, closed: bool) -> FloatArray:
    """Places turned as the shape is; mirrored if it would be inside out."""
    if closed:
        before, after = (_signed_volume(v, surface.triangles) for v in (surface.vertices, places))
        if before * after < 0.0:
            places = -places
    return turned_like(places, surface.vertices)


def _signed_volume(vertices: FloatArray, triangles: IntArray) -> float:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)))
