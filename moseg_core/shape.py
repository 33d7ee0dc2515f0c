"""A shape: surface elements of any kind, with what the method needs to know of each.

Section 4 of the paper classifies *surface elements* (mesh faces here; cloud points or voxels
through the same type) by a point that stands for each. Everything that a part measures from its
elements, area, centroid and principal axes, follows from three exact numbers per element:

- its area ``A``,
- its centroid, ``(1/A) int x dA``,
- its second moment ``int (x - o)(x - o)^T dA`` about the shape's centre ``o``.

These add up over the elements of a part, so that a part's PCA does not depend on how its
surface is tessellated. The geometry itself stays at hand for measures that need more.

A shape is in the user's own units. The search works in *unit coordinates*, in which the centre
of the bounding box is the origin and its diagonal is 1; :class:`Frame` goes between the two.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.adjacency import (
    Adjacency,
    enclosed_volume,
    mesh_adjacency,
    ranges,
)
from moseg_core.capped import capped_volume
from moseg_core.errors import ShapeError
from moseg_core.extreme import Extremes, find_extremes
from moseg_core.mesh import PolygonMesh
from moseg_core.types import FloatArray, IntArray, frozen


@dataclass(frozen=True, eq=False)
class Frame:
    """Unit coordinates: ``unit = (x - center) / scale``.

    Parameters
    ----------
    center : (3,) float, model units
        Centre of the bounding box.
    scale : float, model units
        Length of the bounding box's diagonal.
    """

    center: FloatArray
    scale: float

    def to_unit(self, points: FloatArray) -> FloatArray:
        """Model units to unit coordinates."""
        return (points - self.center) / self.scale

    def to_model(self, points: FloatArray) -> FloatArray:
        """Unit coordinates to model units."""
        return points * self.scale + self.center


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Shape:
    """Surface elements with their areas, moments and neighbours.

    Build one with :meth:`from_mesh` or :func:`moseg_core.load`.

    Parameters
    ----------
    points : (F, 3) float, model units
        Where each element is: the centroid of a face.
    areas : (F,) float, model units squared
    first_moments : (F, 3) float
        Area times centroid of each element, about ``frame.center``.
    second_moments : (F, 6) float
        xx, xy, xz, yy, yz, zz of each element's second moment about ``frame.center``.
    frame : Frame
    adjacency : Adjacency or None
        None where it is not known: segments cannot then be kept connected.
    volume : float or None, model units cubed
        Enclosed volume; None where the surface encloses none.
    volume_reason : str
        Why there is no volume; empty where there is one.
    geometry : PolygonMesh
        The faces that the elements stand for.
    notes : tuple of str
        What was noticed on the way in: degenerate faces, several components, holes.
    space, resolution : str
        Which version of the user's shape this is; part of every memo key.
    original : Shape or None
        The shape that this one was deformed from (:meth:`deformed`), of the same resolution;
        None where it lies as the user gave it.
    fine : Shape or None
        The shape whose elements are grouped here (:func:`moseg_core.coarse.coarsen`); None where
        the elements are those of the input.
    members : (F of `fine`,) int or None
        For each element of `fine` the element here that it belongs to.
    """

    points: FloatArray
    areas: FloatArray
    first_moments: FloatArray
    second_moments: FloatArray
    frame: Frame
    adjacency: Adjacency | None
    volume: float | None
    volume_reason: str = ""
    geometry: PolygonMesh
    notes: tuple[str, ...] = ()
    space: str = "original"
    resolution: str = "full"
    original: Shape | None = None
    fine: Shape | None = None
    members: IntArray | None = None
    name: str = field(default="shape")

    def __post_init__(self) -> None:
        for array in (self.points, self.areas, self.first_moments, self.second_moments):
            frozen(array)
        frozen(self.frame.center)

    @classmethod
    def from_mesh(
        cls,
        vertices: Any,
        faces: npt.ArrayLike | Iterable[Sequence[int]] | None = None,
        *,
        name: str = "shape",
    ) -> Shape:
        """From vertices and polygons, or from anything with ``vertices`` and ``faces``.

        Parameters
        ----------
        vertices : (V, 3) array_like of float, model units; or a trimesh object
        faces : (F, k) array_like of int, or an iterable of sequences, optional
            One element, and so one label, per face, in this order.
        name : str
            What to call the shape in messages.

        Returns
        -------
        Shape

        Raises
        ------
        ShapeError
            Empty or malformed arrays, coordinates that are not finite, no face with an area.

        Examples
        --------
        >>> shape = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> shape.n_elements, shape.areas.tolist()
        (1, [0.5])
        """
        if faces is None:
            if not (hasattr(vertices, "vertices") and hasattr(vertices, "faces")):
                raise ShapeError("from_mesh takes vertices and faces, or a trimesh object")
            vertices, faces = np.asarray(vertices.vertices), np.asarray(vertices.faces)
        mesh = PolygonMesh.from_faces(vertices, faces)
        return cls.from_polygon_mesh(mesh, name=name)

    @classmethod
    def from_polygon_mesh(cls, mesh: PolygonMesh, *, name: str = "shape") -> Shape:
        """From a mesh that was checked already; see :meth:`from_mesh`."""
        used = mesh.vertices[mesh.corners]
        low, high = used.min(axis=0), used.max(axis=0)
        scale = float(np.linalg.norm(high - low))
        frame = Frame((low + high) / 2.0, scale)
        points, areas, first, second = _element_moments(mesh, frame.center)
        # A bounding box of no extent, or needles only: nothing to measure areas against.
        degenerate = areas <= 1e-14 * scale**2
        if scale == 0.0 or degenerate.all():
            raise ShapeError(
                f"all {mesh.n_polygons} faces are degenerate: they have no area to segment"
            )
        adjacency = mesh_adjacency(mesh)
        volume, reason = enclosed_volume(mesh, adjacency)
        return cls(
            points=points,
            areas=areas,
            first_moments=first,
            second_moments=second,
            frame=frame,
            adjacency=adjacency,
            volume=volume,
            volume_reason=reason,
            geometry=mesh,
            notes=_notes(mesh, adjacency, int(degenerate.sum()), reason),
            name=name,
        )

    def deformed(self, vertices: FloatArray, *, space: str) -> Shape:
        """The same elements with their vertices elsewhere, as in an embedding (Sec. 9).

        Parameters
        ----------
        vertices : (V, 3) float
            A new place for every vertex of :attr:`geometry`, in units of its own. Vertices at
            one position should stay together.
        space : str
            What to call the deformed version; part of every memo key.

        Returns
        -------
        Shape
            Its areas, moments and frame are those of the deformed surface, its neighbours those
            of this one. Its volume is the absolute signed volume of the deformed surface, its
            holes capped, where this one has a volume: parts that fold over each other count with
            their sign.

        Raises
        ------
        ShapeError
            Not one finite place for every vertex, or nothing has an area any more.

        Examples
        --------
        >>> flat = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> flat.deformed(2 * flat.geometry.vertices, space="twice").areas.tolist()
        [2.0]
        """
        places = np.array(vertices, dtype=np.float64)
        if places.shape != self.geometry.vertices.shape or not np.isfinite(places).all():
            raise ShapeError(
                f"a deformation of '{self.name}' needs a finite place for each of its"
                f" {len(self.geometry.vertices)} vertices, not an array of shape {places.shape}"
            )
        mesh = replace(self.geometry, vertices=places)
        bent = Shape.from_polygon_mesh(mesh, name=self.name)
        corners = places[mesh.triangles]
        volume, reason = self.volume, self.volume_reason
        if volume is not None:
            volume = capped_volume(places - corners.reshape(-1, 3).mean(axis=0), mesh.triangles)
            if volume <= 1e-12 * bent.frame.scale**3:
                volume, reason = None, f"it is flat in the space '{space}'"
        return replace(
            bent,
            adjacency=self.adjacency,
            volume=volume,
            volume_reason=reason,
            notes=self.notes,
            space=space,
            original=self,
        )

    @property
    def n_elements(self) -> int:
        """Number of surface elements, F."""
        return len(self.areas)

    def in_space(self, space: str) -> Shape:
        """The version of this shape in a space: itself, or the one it was deformed from.

        Raises
        ------
        ShapeError
            It is not known in that space.
        """
        if space == self.space:
            return self
        if self.original is not None and space == self.original.space:
            return self.original
        raise ShapeError(f"'{self.name}' is not known in the space '{space}'")

    @property
    def input(self) -> Shape:
        """The shape of input elements: `fine`, or the shape itself."""
        return self if self.fine is None else self.fine

    @cached_property
    def sizes(self) -> IntArray:
        """(F,) int: how many input elements each element stands for."""
        if self.members is None:
            return np.ones(self.n_elements, np.int64)
        return np.bincount(self.members, minlength=self.n_elements)

    @cached_property
    def element_hashes(self) -> npt.NDArray[np.uint64]:
        """(F, 2) uint64: membership hash of each element, the sum over its input elements."""
        from moseg_core.kernels.moments import hash_elements

        hashes = np.zeros((self.n_elements, 2), np.uint64)
        if self.fine is None or self.members is None:
            hash_elements(hashes)
        else:
            np.add.at(hashes, self.members, self.fine.element_hashes)
        return hashes

    @cached_property
    def _ranked(self) -> tuple[IntArray, IntArray]:
        """Input elements in the order of the elements here, and where each of these begins."""
        assert self.members is not None  # asked of coarse shapes only
        order = np.argsort(self.members, kind="stable")
        return order, np.concatenate([[0], np.cumsum(self.sizes)])

    def expand(self, elements: IntArray) -> IntArray:
        """Numbers of the input elements, ascending, that certain elements stand for.

        Parameters
        ----------
        elements : (k,) int

        Returns
        -------
        (l,) int
            The elements themselves where the shape is not a coarse one.
        """
        if self.members is None:
            return elements
        order, starts = self._ranked
        return np.sort(order[ranges(starts, elements)])

    @cached_property
    def extremes(self) -> Extremes | None:
        """Vertices that matter to the hull of each element; None where elements are the input's."""
        if self.members is None:
            return None
        return find_extremes(self.geometry, self.members, self.points)

    @cached_property
    def unit_points(self) -> FloatArray:
        """(F, 3) float: the elements in unit coordinates, in which the search works."""
        return frozen(self.frame.to_unit(self.points))

    @cached_property
    def area(self) -> float:
        """Total surface area, model units squared."""
        return float(self.areas.sum())

    @cached_property
    def box_diagonal(self) -> float:
        """Diagonal of the bounding box in the shape's own PCA axes, model units.

        Unlike ``frame.scale``, the diagonal in the file's axes, it does not change when the
        shape is rotated.
        """
        first = self.first_moments.sum(axis=0) / self.area
        xx, xy, xz, yy, yz, zz = self.second_moments.sum(axis=0) / self.area
        second = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        _, axes = np.linalg.eigh(second - np.outer(first, first))
        corners = self.geometry.vertices[np.unique(self.geometry.corners)] @ axes
        return float(np.linalg.norm(np.ptp(corners, axis=0)))

    @cached_property
    def fingerprint(self) -> str:
        """Hexadecimal digest of the geometry; equal for equal files, whatever their names."""
        digest = hashlib.sha256()
        for array in (self.geometry.vertices, self.geometry.corners, self.geometry.offsets):
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()[:16]

    @property
    def key(self) -> tuple[object, ...]:
        """What tells this shape from all others in the key of a remembered value."""
        return (self.fingerprint, self.volume, self._links, self.space, self.resolution)

    @cached_property
    def _links(self) -> str:
        if self.adjacency is None:
            return ""
        digest = hashlib.sha256(np.ascontiguousarray(self.adjacency.indices).tobytes())
        return digest.hexdigest()[:16]

    def __repr__(self) -> str:
        volume = "no volume" if self.volume is None else f"volume {self.volume:.6g}"
        return f"Shape({self.name}: {self.n_elements} elements, area {self.area:.6g}, {volume}" + (
            f", {self.resolution})" if self.resolution != "full" else ")"
        )


def _element_moments(
    mesh: PolygonMesh, origin: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Centroid (F, 3), area (F,), first (F, 3) and second (F, 6) moments of each polygon.

    Moments are about `origin`, and kept rather than derived from the centroids: those are
    rounded in the file's coordinates, which may lie far away.

    Over a triangle with corners a, b, c and area A, ``int x x^T dA`` is
    ``A/12 (a a^T + b b^T + c c^T + s s^T)`` with ``s = a + b + c``.
    """
    corners = mesh.vertices[mesh.triangles] - origin
    edge1, edge2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.linalg.norm(np.cross(edge1, edge2), axis=1) / 2.0
    total = corners.sum(axis=1)
    i, j = np.array([0, 0, 0, 1, 1, 2]), np.array([0, 1, 2, 1, 2, 2])
    second = (corners[:, :, i] * corners[:, :, j]).sum(axis=1) + total[:, i] * total[:, j]
    second *= area[:, None] / 12.0
    first = total * area[:, None] / 3.0
    middle = total / 3.0

    starts = np.searchsorted(mesh.triangle_polygon, np.arange(mesh.n_polygons))
    areas = np.add.reduceat(area, starts)
    first = np.add.reduceat(first, starts, axis=0)
    # A polygon of no area has no centroid by area: the mean of its triangles' stands in.
    count = np.diff(np.append(starts, len(area)))
    mean = np.add.reduceat(middle, starts, axis=0) / count[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        points = np.where(areas[:, None] > 0, first / areas[:, None], mean)
    return points + origin, areas, first, np.add.reduceat(second, starts, axis=0)


def _notes(
    mesh: PolygonMesh, adjacency: Adjacency, degenerate: int, volume_reason: str
) -> tuple[str, ...]:
    notes = []
    duplicates = len(mesh.vertices) - int(mesh.merged.max()) - 1
    if duplicates:
        notes.append(f"{duplicates} duplicate vertices, joined by position")
    if degenerate:
        notes.append(f"{degenerate} faces have no area; they take part and carry no weight")
    components, _ = adjacency.components()
    if components > 1:
        notes.append(f"the surface has {components} connected components")
    if volume_reason:
        notes.append(f"encloses no volume: {volume_reason}")
    return tuple(notes)
