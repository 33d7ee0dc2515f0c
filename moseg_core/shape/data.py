"""What is known of a shape's elements, and what follows from it: sums, names, keys.

The data half of :class:`moseg_core.shape.shape.Shape`, of which the other half says how a shape
comes about. Every element, whatever it is, has a place, an area and moments
(:mod:`moseg_core.shape.moments`); the whole has a frame, maybe neighbours and a volume, both with
where they came from (:mod:`moseg_core.shape.volume`). A coarse version holds sums over groups of
elements of a fine one (:mod:`moseg_core.shape.coarse`) and remembers which; nothing else tells the
two apart.
"""

from __future__ import annotations

import hashlib
from collections.abc import Hashable
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from typing import Any, Literal, Self, TypeAlias

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.shape.adjacency import Adjacency
from moseg_core.shape.geometry import Geometry, ranges
from moseg_core.shape.hull_corners import HullCorners, find_hull_corners
from moseg_core.shape.inscribed import FarthestVertices
from moseg_core.shape.links import Links, find_links
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.moments import cell_measure
from moseg_core.shape.up import Up
from moseg_core.shape.volume.volume import Source, Volume
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import FloatArray, IntArray, frozen

AdjacencySource: TypeAlias = Literal["auto", "knn", "none"]

#: What every search asks of a shape; and what some do, which takes long to make.
_ALWAYS = ("element_hashes", "key")
_SOMETIMES = ("hull_corners", "links")


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


#: What is measured of elements, and what it is called in their moments.
MEASURED: dict[str, Literal["points", "areas", "first", "second"]] = {
    "points": "points",
    "areas": "areas",
    "first_moments": "first",
    "second_moments": "second",
}


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class ShapeData:
    """Surface elements with their areas, moments and neighbours.

    Parameters
    ----------
    points : (F, 3) float, model units
        Where each element is: the centroid of a face, the point, the middle of a cell.
    areas : (F,) float, model units squared
        Of cells that fill a solid the volume, model units cubed.
    first_moments : (F, 3) float
        Area times centroid of each element, about ``frame.center``.
    second_moments : (F, 6) float
        xx, xy, xz, yy, yz, zz of each element's second moment about ``frame.center``.
    frame : Frame
    adjacency : Adjacency or None
        None where it is not known: segments cannot then be kept connected.
    adjacency_source : {"auto", "knn", "none"}
        Whether it is what the geometry says, or what the user asked for.
    enclosed : Volume
        The volume that the elements enclose, with its source.
    geometry : Geometry
        What the elements stand for: a mesh, a point cloud or a voxel grid.
    notes : tuple of str
        What was noticed on the way in: degenerate faces, several components, holes.
    space, resolution : str
        Which version of the user's shape this is; part of every memo key.
    original : Shape or None
        The shape that this one was deformed from (:meth:`deformed`), of the same resolution;
        None where it lies as the user gave it.
    fine : Shape or None
        The shape whose elements are grouped here (:func:`moseg_core.shape.coarse.coarsen`); None
        where the elements are those of the input.
    members : (F of `fine`,) int or None
        For each element of `fine` the element here that it belongs to.
    up : {"x", "-x", "y", "-y", "z", "-z"} or None
        The axis that points up, where a file or the user says so (:mod:`moseg_core.shape.up`).
    name : str
        What to call the shape in messages.
    file : str
        The path of the file that it was read from, as it was given; empty where it was none.
        Results say it, so that the shape is found again.
    """

    points: FloatArray
    areas: FloatArray
    first_moments: FloatArray
    second_moments: FloatArray
    frame: Frame
    adjacency: Adjacency | None
    adjacency_source: AdjacencySource = "auto"
    enclosed: Volume
    geometry: Geometry
    notes: tuple[str, ...] = ()
    space: str = "original"
    resolution: str = "full"
    original: Self | None = None
    fine: Self | None = None
    members: IntArray | None = None
    up: Up | None = None
    name: str = field(default="shape")
    file: str = ""

    def __post_init__(self) -> None:
        for name in MEASURED:
            array = getattr(self, name)
            if array is None:  # measured when it is first asked for
                object.__delattr__(self, name)
            else:
                frozen(array)
        frozen(self.frame.center)

    def __getattr__(self, name: str) -> Any:
        # Asked only for what is not there: of the cells of a solid, moments are a hundred bytes.
        grid = self.__dict__.get("geometry")
        if name not in MEASURED or not isinstance(grid, VoxelGrid):
            raise AttributeError(f"'{type(self).__name__}' has no attribute '{name}'")
        array = frozen(cell_measure(grid, self.frame.center, MEASURED[name]))
        object.__setattr__(self, name, array)
        return array

    @property
    def n_elements(self) -> int:
        """Number of surface elements, F."""
        return len(self.areas) if "areas" in self.__dict__ else self.geometry.n_elements

    @property
    def volume(self) -> float | None:
        """Enclosed volume, model units cubed; None where there is none."""
        return self.enclosed.value

    @property
    def volume_source(self) -> Source | None:
        """Where the volume came from, "exact", "user", "hull" or "winding"; None without one."""
        return self.enclosed.source

    @property
    def volume_reason(self) -> str:
        """Why there is no volume; empty where there is one."""
        return self.enclosed.reason

    def with_file(self, file: str, *, name: str) -> Self:
        """The same shape, with the path of the file that it was read from, and a name."""
        made = copy(self)
        object.__setattr__(made, "file", file)
        object.__setattr__(made, "name", name)
        return made

    def in_space(self, space: str) -> Self:
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
    def noun(self) -> str:
        """What an element is called: face, point or cell."""
        return self.geometry.noun

    @property
    def solid(self) -> bool:
        """Whether the elements fill a solid, so that areas are volumes and scales its own."""
        return self.geometry.solid

    @property
    def has_surface(self) -> bool:
        """Whether the elements are pieces of a surface made of triangles."""
        return len(self.geometry.triangles) > 0 and not self.solid

    @property
    def input(self) -> Self:
        """The shape of input elements: `fine`, or the shape itself."""
        return self if self.fine is None else self.fine

    @cached_property
    def made_from(self) -> dict[Hashable, Any]:
        """What was made of this shape and lasts as long as it does, by what made it.

        Whatever refers back to its shape, as an embedded shape does to its original, is kept here:
        a table elsewhere would keep both alive for good.
        """
        return {}

    def make_ready(self, like: Self | None = None) -> None:
        """Make what a search will ask for, so that processes that are copies of this one have it.

        Parameters
        ----------
        like : ShapeData, optional
            Another version of the shape: what has been asked of it, and takes long, is made too.
        """
        asked = [name for name in _SOMETIMES if like is not None and name in vars(like)]
        for name in (*_ALWAYS, *asked):
            getattr(self, name)

    def __getstate__(self) -> dict[str, Any]:
        # What was made of the shape is large, and made anew where it is needed.
        return {key: value for key, value in self.__dict__.items() if key != "made_from"}

    @cached_property
    def sizes(self) -> IntArray:
        """(F,) int: how many input elements each element stands for."""
        if self.members is None:
            return np.ones(self.n_elements, np.int64)
        return np.bincount(self.members, minlength=self.n_elements)

    @cached_property
    def element_hashes(self) -> npt.NDArray[np.uint64]:
        """(F, 2) uint64: membership hash of each element, the sum over its input elements."""
        from moseg_core.shape.part_sums import hash_elements

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
    def hull_corners(self) -> HullCorners | None:
        """Corners of the convex hull of each element; None where elements are the input's."""
        if self.members is None:
            return None
        return find_hull_corners(self.geometry, self.members, self.points)

    @property
    def farthest_vertices(self) -> FarthestVertices | None:
        """How far elements reach in all directions; None where there are too many for a table.

        It is not sent along with the shape, being large: each process makes it where it is asked.
        """
        key = "farthest vertices"
        if key not in self.made_from:
            corners, starts = self.geometry.corners, self.geometry.offsets
            if self.hull_corners is not None:
                corners, starts = self.hull_corners.vertices, self.hull_corners.starts
            vertices = self.geometry.vertices - self.frame.center
            self.made_from[key] = FarthestVertices.of(self.points, vertices, corners, starts)
        found: FarthestVertices | None = self.made_from[key]
        return found

    @cached_property
    def links(self) -> Links:
        """Which elements touch and along which length, each pair once.

        Raises
        ------
        ShapeError
            It is not known which elements touch.
        """
        if self.adjacency is None:
            raise ShapeError(
                f"'{self.name}' has no boundaries between parts: it does not say which elements"
                f" touch; take the nearest (--adjacency knn)"
            )
        if self.fine is not None and self.members is not None:
            fine = self.fine.links
            return fine.grouped(self.members, fine.lengths, self.n_elements)
        return find_links(
            self.geometry if self.original is None else self.original.geometry,
            self.adjacency,
            points=self.points,
            areas=self.areas,
            places=self.geometry.vertices,
            near=self.adjacency_source == "knn",
        )

    @cached_property
    def unit_points(self) -> FloatArray:
        """(F, 3) float: the elements in unit coordinates, in which the search works."""
        # Row by row, as the kernels go through them; points of a grid are not.
        return frozen(np.ascontiguousarray(self.frame.to_unit(self.points)))

    @cached_property
    def area(self) -> float:
        """Total surface area, model units squared; of a solid its volume."""
        return float(self.areas.sum())

    @cached_property
    def centroid(self) -> FloatArray:
        """(3,) float, model units: the area-weighted mean of the surface."""
        return frozen(self.first_moments.sum(axis=0) / self.area + self.frame.center)

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
        corners = self.geometry.used_vertices @ axes
        return float(np.linalg.norm(np.ptp(corners, axis=0)))

    @cached_property
    def fingerprint(self) -> str:
        """Hexadecimal digest of the geometry; equal for equal files, whatever their names."""
        if self.fine is not None:
            return self.fine.fingerprint
        geometry, digest = self.geometry, hashlib.sha256()
        arrays = chain([geometry.vertices], geometry.corners_in_pieces(), [geometry.offsets])
        for array in arrays:
            digest.update(_buffer(array))
        if not isinstance(geometry, PolygonMesh):
            # Equal points may have other areas, and equal cells be solid or not.
            digest.update(geometry.kind.encode())
            digest.update(_buffer(self.areas))
        return digest.hexdigest()[:16]

    @cached_property
    def key(self) -> tuple[object, ...]:
        """What tells this shape from all others in the key of a remembered value."""
        volume = (self.enclosed.value, self.enclosed.source)
        return (self.fingerprint, *volume, self._links, self.space, self.resolution, self.up)

    @cached_property
    def _links(self) -> str:
        if self.adjacency is None:
            return ""
        digest = hashlib.sha256(_buffer(self.adjacency.indices))
        return digest.hexdigest()[:16]

    def __repr__(self) -> str:
        volume = "no volume" if self.volume is None else f"volume {self.volume:.6g}"
        return f"Shape({self.name}: {self.n_elements} elements, area {self.area:.6g}, {volume}" + (
            f", {self.resolution})" if self.resolution != "full" else ")"
        )


def _buffer(array: npt.NDArray[Any]) -> memoryview:
    """The bytes of an array in C order, without a copy where they are so already."""
    return np.ascontiguousarray(array).reshape(-1).view(np.uint8).data
