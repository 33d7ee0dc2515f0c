"""A shape: surface elements of any kind, with what the method needs to know of each.

Section 4 of the paper classifies *surface elements*, faces of a mesh, points of a cloud or cells
of a voxel grid, by a point that stands for each. Everything that a part measures from its
elements, area, centroid and principal axes, follows from three numbers per element
(:mod:`moseg_core.shape.moments`):

- its area ``A``,
- its centroid, ``(1/A) int x dA``,
- its second moment ``int (x - o)(x - o)^T dA`` about the shape's centre ``o``.

These add up over the elements of a part, so that a part's PCA does not depend on how its
surface is tessellated. The geometry itself stays at hand for measures that need more. What a
shape does not know, which elements touch or what volume it encloses, the user may have estimated
(:meth:`Shape.with_adjacency`, :meth:`Shape.with_volume`).

A shape is in the user's own units. The search works in *unit coordinates*, in which the centre
of the bounding box is the origin and its diagonal is 1; :class:`Frame` goes between the two.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError, UsageError, unknown
from moseg_core.shape.adjacency import (
    NEAREST,
    Adjacency,
    grid_adjacency,
    mesh_adjacency,
    near_pairs,
)
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.data import MEASURED, AdjacencySource, Frame, ShapeData
from moseg_core.shape.extent import without_area
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.mesh import MOST_WELD, PolygonMesh
from moseg_core.shape.moments import element_moments
from moseg_core.shape.positions import WELD
from moseg_core.shape.up import Up, checked_up
from moseg_core.shape.volume.derived import deformed_volume
from moseg_core.shape.volume.enclosed import enclosed_volume
from moseg_core.shape.volume.estimated import estimated_volume
from moseg_core.shape.volume.volume import Volume
from moseg_core.shape.voxels import Elements, VoxelGrid
from moseg_core.types import FloatArray, IntArray


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Shape(ShapeData):
    """Surface elements with their areas, moments and neighbours.

    Build one with :meth:`from_mesh`, :meth:`from_points`, :meth:`from_voxels` or
    :func:`moseg_core.load`. What it holds is described in
    :class:`~moseg_core.shape.data.ShapeData`, its base.
    """

    @classmethod
    def from_mesh(
        cls,
        vertices: Any,
        faces: npt.ArrayLike | Iterable[Sequence[int]] | None = None,
        *,
        weld: float = WELD,
        name: str = "shape",
        notes: Iterable[str] = (),
    ) -> Shape:
        """From vertices and polygons, or from anything with ``vertices`` and ``faces``.

        Parameters
        ----------
        vertices : (V, 3) array_like of float, model units; or a trimesh object
        faces : (F, k) array_like of int, or an iterable of sequences, optional
            One element, and so one label, per face, in this order.
        weld : float
            How far vertices may lie apart and still be joined, as a share of the diagonal of the
            bounding box; 0 joins only those that are equal. None is moved.
        name : str
            What to call the shape in messages.
        notes : iterable of str
            What was passed over or repaired on the way, a sentence each; said once with what is
            noticed here.

        Returns
        -------
        Shape

        Raises
        ------
        ShapeError
            Empty or malformed arrays, coordinates that are not finite, no face with an area.
            Vertices that no face uses are not looked at.
        UsageError
            A tolerance that is no share from 0 to 0.1.

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
        mesh = PolygonMesh.from_faces(vertices, faces, weld=weld, notes=notes)
        return cls.from_polygon_mesh(mesh, name=name)

    @classmethod
    def from_polygon_mesh(cls, mesh: PolygonMesh, *, name: str = "shape") -> Shape:
        """From a mesh that was checked already; see :meth:`from_mesh`."""
        adjacency = mesh_adjacency(mesh)
        volume = enclosed_volume(mesh, adjacency)
        used, taken = np.zeros((2, len(mesh.vertices)), np.bool_)
        used[mesh.corners] = True
        taken[mesh.merged[used]] = True
        near = mesh.n_near
        duplicates = int(used.sum() - taken.sum()) - near
        notes = []
        if duplicates:
            notes.append(f"{duplicates} duplicate {_vertices(duplicates)}, joined by position")
        if near:
            notes.append(
                f"{near} {_vertices(near)} less than {mesh.tolerance:.2g} from another, joined"
                f" with it"
                f" (--weld 0 joins equal ones only)"
            )
        return cls._made(mesh, adjacency, volume, notes, name)

    @classmethod
    def from_points(
        cls,
        points: npt.ArrayLike,
        *,
        areas: npt.ArrayLike | None = None,
        normals: npt.ArrayLike | None = None,
        adjacency: Literal["knn"] | None = None,
        name: str = "shape",
        notes: Iterable[str] = (),
    ) -> Shape:
        """From the points of a cloud; one element, and so one label, per point.

        Parameters
        ----------
        points : (F, 3) array_like of float, model units
        areas : (F,) array_like of float, model units squared, optional
            How much surface each point stands for; estimated by default
            (:mod:`moseg_core.shape.cloud`).
        normals : (F, 3) array_like of float, optional
            Directions away from the surface, of any length; the volume can be estimated from
            them (:meth:`with_volume`).
        adjacency : "knn", optional
            See :meth:`with_adjacency`. By default it is not known which points touch.
        name : str
        notes : iterable of str
            As for :meth:`from_mesh`.

        Raises
        ------
        ShapeError
            Malformed arrays, points in one place only. A point that is not finite is an element
            without weight.

        Examples
        --------
        >>> shape = Shape.from_points([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
        >>> shape.n_elements, shape.adjacency, shape.volume
        (4, None, None)
        """
        cloud = PointCloud.from_points(points, areas=areas, normals=normals, notes=notes)
        made = cls._made(cloud, None, Volume.none("it is a point cloud"), [], name)
        return made if adjacency is None else made.with_adjacency(adjacency)

    @classmethod
    def from_voxels(
        cls,
        occupied: npt.ArrayLike,
        *,
        pitch: npt.ArrayLike = 1.0,
        origin: npt.ArrayLike = (0.0, 0.0, 0.0),
        elements: Elements = "solid",
        name: str = "shape",
        notes: Iterable[str] = (),
        header: Mapping[str, Any] | None = None,
    ) -> Shape:
        """From the occupied cells of a grid; one element, and so one label, per cell.

        Parameters
        ----------
        occupied : (nx, ny, nz) array_like of bool
        pitch : float, (3,) or (3, 3) array_like of float, model units
            Side of a cell; three for cells that are no cubes, along x, y and z; or three vectors,
            row ``a`` from a cell to the next along axis ``a`` of the array, for grids that lie at
            an angle, or whose axes run otherwise than x, y and z.
        origin : (3,) array_like of float, model units
            First corner of the cell (0, 0, 0): the least one, unless a step goes down.
        elements : {"solid", "surface"}
            Whether all occupied cells are elements, in C order, or only those with an exposed
            face; see :mod:`moseg_core.shape.voxels`.
        name : str
        notes : iterable of str
            As for :meth:`from_mesh`.
        header : mapping of str to any, optional
            What a file says of the grid beside that; kept for a writer of the same format.

        Raises
        ------
        ShapeError
            No grid in three dimensions, no occupied cell, a pitch that is not positive.
        UsageError
            Other elements.

        Examples
        --------
        >>> block = Shape.from_voxels(np.ones((3, 3, 3), bool), pitch=2.0)
        >>> block.n_elements, block.volume, block.solid
        (27, 216.0, True)
        >>> Shape.from_voxels(np.ones((3, 3, 3), bool), pitch=(0.5, 0.5, 1.0)).volume
        6.75
        """
        grid = VoxelGrid.from_occupied(
            occupied, pitch=pitch, origin=origin, elements=elements, notes=notes, header=header
        )
        return cls._made(grid, grid_adjacency(grid), Volume.exact(grid.volume), [], name)

    @classmethod
    def _made(
        cls,
        geometry: Geometry,
        adjacency: Adjacency | None,
        volume: Volume,
        notes: list[str],
        name: str,
    ) -> Shape:
        """From a geometry and what is known of it; measures the elements."""
        notes = [*geometry.notes, *notes]
        low, high = geometry.box
        scale = float(np.linalg.norm(high - low))
        frame = Frame((low + high) / 2.0, scale)
        # Of the cells of a solid measured when it is asked for: of many it takes much room.
        measured: dict[str, Any] = dict.fromkeys(MEASURED)
        degenerate = np.zeros(1, np.bool_)
        if not geometry.solid:
            moments = element_moments(geometry, frame.center)
            measured = {name: getattr(moments, what) for name, what in MEASURED.items()}
            degenerate = without_area(geometry, moments.areas, scale)
        # A bounding box of no extent, or needles only: nothing to measure areas against.
        if scale == 0.0 or degenerate.all():
            raise ShapeError(
                f"all {geometry.n_elements} {geometry.noun}s are degenerate: they have no area to"
                f" segment"
            )
        flat = int(degenerate.sum())
        if isinstance(geometry, PointCloud):
            flat -= geometry.n_unplaced  # of which the cloud has said so
        if flat:
            notes = [
                *notes,
                f"{flat} {geometry.noun}s have no area; they take part and carry no weight",
            ]
        components = 1 if adjacency is None else adjacency.components()[0]
        if components > 1:
            notes = [*notes, _in_components(components)]
        if volume.reason:
            remedy = f"; {volume.remedy}" if volume.remedy else ""
            notes = [*notes, f"{_NO_VOLUME}: {volume.reason}{remedy}"]
        if volume.note:
            notes = [*notes, volume.note]
        return cls(
            **measured,
            frame=frame,
            adjacency=adjacency,
            enclosed=volume,
            geometry=geometry,
            notes=tuple(notes),
            name=name,
        )

    def with_adjacency(self, which: str, *, nearest: int = NEAREST) -> Shape:
        """The same shape with other neighbours.

        Parameters
        ----------
        which : {"auto", "knn", "none"}
            "auto" is what the geometry says: shared edges of polygons, shared faces of cells,
            nothing of points. "knn" adds the elements that are mutually among each other's
            nearest. With "none" segments are not kept connected. What was asked for before does
            not count.
        nearest : int
            How many elements are the nearest of one.

        Raises
        ------
        UsageError
            Another word.

        Examples
        --------
        >>> pairs = Shape.from_points([[x, 0, 0] for x in (0, 1, 5, 6)])
        >>> pairs.with_adjacency("knn", nearest=1).adjacency.components()[0]
        2
        """
        source = next((word for word in get_args(AdjacencySource) if word == which), None)
        if source is None:
            raise UsageError(unknown("adjacency", which, get_args(AdjacencySource)))
        if source == self.adjacency_source == "auto":
            return self
        adjacency = None if source == "none" else self._own_adjacency()
        found = []
        if source == "knn":
            pairs = self._near_pairs(nearest)
            if adjacency is not None:
                pairs = np.concatenate([adjacency.pairs, pairs])
            adjacency = Adjacency.from_pairs(pairs, self.n_elements)
            found = [f"the {nearest} nearest {self.noun}s {_MUTUAL}"]
        components = 1 if adjacency is None else adjacency.components()[0]
        found += [_in_components(components)] if components > 1 else []
        kept = [
            note
            for note in self.notes
            if not (note.startswith(_COMPONENTS) or note.endswith(_MUTUAL))
        ]
        return replace(self, adjacency=adjacency, adjacency_source=source, notes=(*kept, *found))

    def _near_pairs(self, nearest: int) -> IntArray:
        """Mutually nearest elements; a point that is not finite is next to the one it stands by."""
        geometry = self.geometry
        if not isinstance(geometry, PointCloud) or geometry.stand_in is None:
            return near_pairs(self.points, nearest)
        placed = geometry.stand_in == geometry.corners
        real = np.flatnonzero(placed)
        aside = np.stack([np.flatnonzero(~placed), geometry.stand_in[~placed]], axis=1)
        return np.concatenate([real[near_pairs(self.points[real], nearest)], aside])

    def _own_adjacency(self) -> Adjacency | None:
        """What the geometry, as the user gave it, says of neighbours."""
        geometry = self.geometry if self.original is None else self.original.geometry
        if isinstance(geometry, PolygonMesh):
            own = mesh_adjacency(geometry)
        elif isinstance(geometry, VoxelGrid):
            own = grid_adjacency(geometry)
        else:
            return None
        if self.members is None:
            return own
        return Adjacency.from_pairs(self.members[own.pairs], self.n_elements)

    def with_volume(self, volume: float | str) -> Shape:
        """The same shape with an estimate of the volume that it encloses.

        Parameters
        ----------
        volume : float or {"hull", "winding"}
            In model units cubed; or that of the convex hull; or that of all places around which
            the surface winds more than half (:mod:`moseg_core.shape.volume.estimated`).

        Raises
        ------
        UsageError
            Another word, or a number that is not positive.
        ShapeError
            The volume cannot be estimated: a flat hull, points without normals.

        Examples
        --------
        >>> cube = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        >>> Shape.from_points(cube).with_volume("hull").volume
        1.0
        """
        estimate, words = estimated_volume(self.geometry, volume)
        if estimate.value is None:
            raise ShapeError(f"the volume of '{self.name}' cannot be estimated: {estimate.reason}")
        kept = [
            note
            for note in self.notes
            if not note.startswith((_NO_VOLUME, _ESTIMATE)) and note != self.enclosed.note
        ]
        note = f"{_ESTIMATE} {estimate.value:.6g}, {words}"
        return replace(self, enclosed=estimate, notes=(*kept, note))

    def with_up(self, up: Up | None) -> Shape:
        """The same shape with another axis pointing up; nothing is turned.

        Parameters
        ----------
        up : {"x", "-x", "y", "-y", "z", "-z"} or None
            An axis of the shape's own coordinates; None where it is not known.

        Raises
        ------
        UsageError
            There is no such axis.

        Examples
        --------
        >>> shape = Shape.from_points([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
        >>> shape.up, shape.with_up("-z").up
        (None, '-z')
        """
        axis = None if up is None else checked_up(up)
        if axis == self.up:
            return self
        turned = copy(self)  # what a grid has not made yet is not made for this
        for known in set(vars(self)) - {each.name for each in fields(self)}:
            # What was found out of the shape may depend on it; some of it a copy has not.
            vars(turned).pop(known, None)
        object.__setattr__(turned, "up", axis)
        return turned

    def with_weld(self, weld: float) -> Shape:
        """The same mesh, its vertices joined within another distance.

        Parameters
        ----------
        weld : float
            As for :meth:`from_mesh`. Neighbours and the volume are found anew; what was asked for
            before does not count.

        Raises
        ------
        ShapeError
            The shape is no mesh.
        UsageError
            A tolerance that is no share from 0 to 0.1.

        Examples
        --------
        >>> crack = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1e-6, 0], [0, 1, 0], [1, 1, 0]]
        >>> tile = Shape.from_mesh(crack, [[0, 1, 2], [3, 5, 4]])
        >>> tile.adjacency.indices.tolist(), tile.with_weld(1e-5).adjacency.indices.tolist()
        ([], [1, 0])
        """
        if not isinstance(self.geometry, PolygonMesh):
            raise ShapeError(
                f"'{self.name}' is a {self.geometry.kind}; only of a mesh can vertices be joined"
            )
        welded = Shape.from_polygon_mesh(self.geometry.welded(weld), name=self.name)
        return replace(welded, up=self.up, file=self.file)

    def with_elements(self, elements: Elements) -> Shape:
        """The same voxel grid with all cells as elements, or only those of its surface.

        Parameters
        ----------
        elements : {"solid", "surface"}

        Raises
        ------
        ShapeError
            The shape is no voxel grid.
        UsageError
            Other elements.
        """
        grid = self._grid(f"can the elements be '{elements}'")
        made = Shape.from_voxels(
            grid.occupied,
            pitch=grid.steps,
            origin=grid.origin,
            elements=elements,
            name=self.name,
            notes=grid.notes,
            header=grid.header,
        )
        return replace(made, up=self.up, file=self.file)

    def with_pitch(self, pitch: npt.ArrayLike) -> Shape:
        """The same voxel grid with cells of other sides, which its file did not know.

        Parameters
        ----------
        pitch : float, (3,) or (3, 3) array_like of float, model units
            As for :meth:`from_voxels`. The origin stays; neighbours and the volume are found anew,
            what was asked for before does not count, nor does what the file said of the grid.

        Raises
        ------
        ShapeError
            The shape is no voxel grid, or the pitch is not positive.

        Examples
        --------
        >>> slices = Shape.from_voxels(np.ones((2, 2, 2), bool))
        >>> slices.with_pitch((0.5, 0.5, 3.0)).volume
        6.0
        """
        grid = self._grid("can cells have a pitch")
        made = Shape.from_voxels(
            grid.occupied,
            pitch=pitch,
            origin=grid.origin,
            elements=grid.elements,
            name=self.name,
            notes=grid.notes,
        )
        return replace(made, up=self.up, file=self.file)

    def _grid(self, what: str) -> VoxelGrid:
        """The geometry, where it is a voxel grid, of which alone something can be asked."""
        if not isinstance(self.geometry, VoxelGrid):
            raise ShapeError(
                f"'{self.name}' is a {self.geometry.kind}; only of a voxel grid {what}"
            )
        return self.geometry

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
            of this one. Where this one has a volume, that of the deformed surface is its absolute
            signed volume, its holes capped, so that what folds over counts with its sign; where
            its faces are not known to be oriented alike, it is an estimate afresh, or there is
            none (:mod:`moseg_core.shape.volume.derived`). Which way is up is not known of it: an
            embedding may turn.

        Raises
        ------
        ShapeError
            Not one finite place for every vertex, or nothing has an area any more; or the shape
            is no mesh.

        Examples
        --------
        >>> flat = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> flat.deformed(2 * flat.geometry.vertices, space="twice").areas.tolist()
        [2.0]
        """
        if not isinstance(self.geometry, PolygonMesh):
            raise ShapeError(
                f"'{self.name}' is a {self.geometry.kind}; only a polygon mesh can be deformed"
            )
        places = np.array(vertices, dtype=np.float64)
        if places.shape != self.geometry.vertices.shape or not np.isfinite(places).all():
            raise ShapeError(
                f"a deformation of '{self.name}' needs a finite place for each of its"
                f" {len(self.geometry.vertices)} vertices, not an array of shape {places.shape}"
            )
        # Embeddings have units of their own: vertices are joined within the same share of these.
        share = min(self.geometry.tolerance / self.geometry.diagonal, MOST_WELD)
        mesh = replace(self.geometry, vertices=places).welded(share)
        deformed = Shape.from_polygon_mesh(mesh, name=self.name)
        volume = deformed_volume(
            mesh,
            original=self.geometry,
            original_volume=self.enclosed,
            space=space,
            diagonal=deformed.frame.scale,
        )
        return replace(
            deformed,
            adjacency=self.adjacency,
            adjacency_source=self.adjacency_source,
            enclosed=volume,
            notes=self.notes,
            space=space,
            original=self,
        )


# How notes begin or end that no longer hold of a shape with another adjacency or volume.
_COMPONENTS = "the surface has"
_MUTUAL = "count as neighbours, where mutually so"
_NO_VOLUME = "encloses no volume"
_ESTIMATE = "the enclosed volume is taken to be"


def _vertices(count: int) -> str:
    return "vertex" if count == 1 else "vertices"


def _in_components(count: int) -> str:
    return f"{_COMPONENTS} {count} connected components"
