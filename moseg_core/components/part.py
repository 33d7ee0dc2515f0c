"""A part: the elements of one label, and what can be measured of them (Sec. 10).

An objective sees parts and nothing else of the segmentation. A part does not know its label: the
same set of elements measures the same whatever it is called. Area, centroid and principal axes
come from exact sums over the elements; vertices and triangles are at hand for everything else.

Measures that need a library of their own (a hull volume, a distance to a surface) are provided
by plugins and asked for by id, ``part.measure("basic:hull_volume")``. They are computed once per
part and shared by all objectives. So are fields, numbers that every element of the shape has
(:mod:`moseg_core.components.field`), and boundaries (:mod:`moseg_core.components.boundary`).

During a search on a coarse shape (:mod:`moseg_core.shape.coarse`) a part is a union of
super-elements. All that it says of itself is still about the user's shape and its elements;
:attr:`Part.level` alone is the coarse one.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from moseg_core.components.boundary import Boundary
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import FieldSummary
from moseg_core.components.memo import Memo
from moseg_core.components.part_tables import PartTables, pair_of_one_labelling
from moseg_core.components.requirements import demand
from moseg_core.errors import MosegError
from moseg_core.shape.shape import Shape
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import BoolArray, FloatArray, Int32Array, IntArray, frozen

if TYPE_CHECKING:
    import trimesh


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Part:
    """The elements that bear one label.

    Made by :class:`moseg_core.components.segmentation.Segmentation`; objectives receive it ready.

    Parameters
    ----------
    level : Shape
        The shape whose elements were labelled: the user's own, or a coarse one made from it.
    _level_labels : (F of `level`,) int32
        The labelling, of which the part is the elements equal to `_index`. Private to the core:
        values are remembered by the set of elements, whatever label it bears. To number parts,
        enumerate :attr:`Segmentation.parts`.
    _index : int
    n_elements : int
        Number of the user's elements.
    membership : (int, int)
        128-bit hash of the elements' numbers.
    moments : (10,) float
        Area, first and second moments about the shape's centre, summed over the elements.
    memo : Memo
    lookup : Lookup
        Where measures and fields are found.
    _tables : PartTables
        Shared with the other parts of the labelling.

    Examples
    --------
    >>> import numpy as np
    >>> from moseg_core.components.segmentation import Segmentation
    >>> shape = Shape.from_mesh([[0, 0, 0], [3, 0, 0], [3, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> part = Segmentation.from_labels(shape, [0], 1).parts[0]
    >>> part.area, part.centroid.tolist()
    (3.0, [1.5, 0.5, 0.0])
    >>> bool(np.allclose(part.scales, [3 / 12**0.5, 1 / 12**0.5, 0]))
    True
    """

    level: Shape
    _level_labels: Int32Array
    _index: int
    n_elements: int
    membership: tuple[int, int]
    moments: FloatArray
    memo: Memo
    lookup: Lookup
    _tables: PartTables

    @property
    def shape(self) -> Shape:
        """The whole that this is a part of, the user's shape."""
        return self.level.input

    @property
    def area(self) -> float:
        """Surface area, model units squared; of a solid's part its volume."""
        return float(self.moments[0])

    def __repr__(self) -> str:
        return f"Part({self.n_elements} elements of {self.shape.name}, area {self.area:.6g})"

    def _require_area(self) -> None:
        if not self.moments[0] > 0:
            raise MosegError("an empty part, or one without area, has no centroid and no axes")

    @property
    def centroid(self) -> FloatArray:
        """(3,) float, model units: the paper's ``P.c``, the area-weighted mean of the surface."""
        self._require_area()
        return self._tables.centroid(self._index)

    @property
    def scales(self) -> FloatArray:
        """(3,) float, descending, model units: the paper's ``P.scale_i``.

        Square roots of the eigenvalues of the surface's covariance, exact over each triangle.
        """
        self._require_area()
        return self._tables.scales(self._index)

    @property
    def axes(self) -> FloatArray:
        """(3, 3) float: row ``i`` is the unit vector ``P.axis_i`` that belongs to ``scales[i]``.

        The sign of an axis means nothing, nor do axes whose scales coincide.
        """
        self._require_area()
        return self._tables.axes(self._index)

    @cached_property
    def elements(self) -> IntArray:
        """(n_elements,) int: numbers of the part's elements in the shape, ascending."""
        return frozen(self.level.expand(self.level_elements))

    @cached_property
    def level_elements(self) -> IntArray:
        """(k,) int: numbers of the part's elements in :attr:`level`, ascending."""
        return frozen(np.flatnonzero(self._level_labels == self._index))

    @property
    def points(self) -> FloatArray:
        """(n_elements, 3) float, model units: where the elements are."""
        return self.shape.points[self.elements]

    @property
    def areas(self) -> FloatArray:
        """(n_elements,) float, model units squared."""
        return self.shape.areas[self.elements]

    @cached_property
    def _used(self) -> BoolArray:
        """(V,) bool: the vertices that the part's elements use."""
        return self.shape.geometry.used_by(self.elements)

    @cached_property
    def vertices(self) -> FloatArray:
        """(v, 3) float, model units: the vertices that the part's elements use."""
        return frozen(self.shape.geometry.vertices[self._used])

    @cached_property
    def triangles(self) -> IntArray:
        """(t, 3) int: what is seen of the part as triangles over :attr:`vertices`.

        None on a point cloud. On a voxel grid the exposed faces of its cells, not the cuts.
        """
        geometry = self.shape.geometry
        if geometry.is_triangular:
            triangles = geometry.triangles[self.elements]
        else:
            inside = np.zeros(geometry.n_elements, np.bool_)
            inside[self.elements] = True
            triangles = geometry.triangles[inside[geometry.triangle_polygon]]
        return frozen((np.cumsum(self._used) - 1)[triangles])

    @cached_property
    def merged(self) -> IntArray:
        """(v,) int: number of each vertex's position in the shape; those at one place share it."""
        return frozen(self.shape.geometry.merged[self._used])

    @cached_property
    def extreme_vertices(self) -> FloatArray:
        """(k, 3) float, model units: vertices with the same convex hull as all of them.

        Enough for hulls, extents and whatever else only depends on what is furthest out; fewer
        than :attr:`vertices` on a part of a coarse shape and on one of a voxel grid, else the same.
        """
        corners, geometry = self.level.hull_corners, self.shape.geometry
        if corners is not None:
            return frozen(geometry.vertices[corners.of(self.level_elements)])
        if not isinstance(geometry, VoxelGrid):
            return self.vertices
        groups = np.where(self._level_labels == self._index, 0, -1)
        return frozen(geometry.vertices[geometry.outer_corners(groups)[1]])

    @cached_property
    def box_diagonal(self) -> float:
        """Diagonal of the bounding box in the part's own PCA axes, model units."""
        # One row per axis: along rows numpy finds extremes some ten times as fast.
        return float(np.linalg.norm(np.ptp(self.axes @ self.extreme_vertices.T, axis=1)))

    @cached_property
    def n_components(self) -> int:
        """Number of connected pieces; 1 where the shape's adjacency is not known."""
        if self.shape.adjacency is None:
            return 1
        return self.shape.adjacency.components(self.elements)[0]

    @cached_property
    def _own_measures(self) -> dict[Any, Any]:
        return {}

    def measure(self, name: str, **parameters: float) -> Any:
        """The value of a measure, computed at most once.

        Parameters
        ----------
        name : str
            ``bundle:name``, or the name alone where it is unique.
        **parameters
            The measure's own parameters.

        Raises
        ------
        ShapeError
            The shape lacks what the measure requires.
        PluginError
            The measure's bundle is missing or broken.
        UsageError
            No installed bundle has the measure.
        """
        found = self.lookup.measure(name)
        key = (found.id, tuple(sorted(parameters.items())))
        own = self._own_measures
        if key not in own:
            demand(self.shape, found.requires, f"measure '{found.id}'")
            if found.keep:
                whole = measure_key(self.membership, self.level, *key)
                own[key] = self.memo.get(whole, lambda: _shared(found.function(self, **parameters)))
            else:
                own[key] = _shared(found.function(self, **parameters))
        return own[key]

    def field(self, name: str, **parameters: Any) -> FieldSummary[float]:
        """A field over the part: mean, spread, least and greatest value, weighted by area.

        Parameters
        ----------
        name : str
            ``bundle:name`` of the field, or the name alone where it is unique.
        **parameters
            The field's own parameters.

        Raises
        ------
        MosegError
            The part has no area.
        ShapeError, UsageError, PluginError
            As for :func:`moseg_core.field_values`.
        """
        self._require_area()
        return self._tables.field(name, parameters, self._index)

    def field_of_shape(self, name: str, **parameters: Any) -> float:
        """A field's mean over the whole shape by area, with which the part's can be compared.

        Parameters
        ----------
        name : str
            ``bundle:name`` of the field, or the name alone where it is unique.
        **parameters
            The field's own parameters.

        Raises
        ------
        ShapeError, UsageError, PluginError
            As for :func:`moseg_core.field_values`.
        """
        return self._tables.mean_of_all(name, parameters)

    @property
    def boundary(self) -> Boundary:
        """Where the part meets all others.

        Raises
        ------
        ShapeError
            It is not known which elements touch.
        """
        return self._tables.boundary(self._index)

    def boundary_with(self, other: Part) -> Boundary:
        """Where the part meets another part of the same segmentation.

        Raises
        ------
        MosegError
            The other is of another segmentation.
        ShapeError
            It is not known which elements touch.
        """
        tables = pair_of_one_labelling(self._tables, other._tables)
        return tables.between(self._index, other._index)

    def boundary_lengths(self, others: Sequence[Part]) -> FloatArray:
        """How long the boundary with each of several parts of the same segmentation is.

        Of many pairs of parts most do not touch; this is faster than :meth:`boundary_with` of each.

        Returns
        -------
        (n,) float, model units

        Raises
        ------
        MosegError, ShapeError
            As for :meth:`boundary_with`.

        Examples
        --------
        >>> from moseg_core import Segmentation, Shape
        >>> strip = Shape.from_mesh([[x, y, 0] for x in range(4) for y in (0, 3)],
        ...                         [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(3)])
        >>> first, *others = Segmentation.from_labels(strip, [0, 1, 2], 3).parts
        >>> first.boundary_lengths(others).tolist()
        [3.0, 0.0]
        """
        for other in others:
            pair_of_one_labelling(self._tables, other._tables)
        return self._tables.lengths_between(self._index, [other._index for other in others])

    def distance_to(self, other: Part) -> float:
        """The least distance between the middles of elements of two parts, model units.

        Straight, through the air where need be; of parts of a coarse shape between those of
        super-elements. Infinite where one of the two is empty.

        Raises
        ------
        MosegError
            The other is of another segmentation.
        """
        from moseg_core.shape.gaps import least_distance

        pair_of_one_labelling(self._tables, other._tables)
        points = self.level.points
        return float(least_distance(points, self._level_labels, self._index, other._index))

    def to_mesh(self) -> trimesh.Trimesh:
        """The part's surface as a trimesh object, triangulated, open where it was cut.

        Examples
        --------
        >>> result.parts["handle"].to_mesh().export("handle.stl")  # doctest: +SKIP
        """
        import trimesh

        return trimesh.Trimesh(vertices=self.vertices, faces=self.triangles, process=False)


def measure_key(
    membership: tuple[int, int], level: Shape, measure: str, parameters: tuple[Any, ...] = ()
) -> Hashable:
    """Under which the value of a measure of a part is remembered."""
    return (membership, *level.key, measure, parameters)


def _shared(value: Any) -> Any:
    """A measure's value with its arrays read-only, since all objectives share it."""
    for array in value if isinstance(value, tuple) else (value,):
        if isinstance(array, np.ndarray):
            frozen(array)
    return value
