"""One file for each part: ``parts/{part}.stl``, as cut out, closed or as convex hulls.

A path with ``{part}`` in its name stands for as many files as there are parts, each called by its
label (:mod:`moseg_core.io.write.names`) and written by :mod:`moseg_core.io.write.part_meshes`. What
of a part is written, its *form*, is its piece of the surface, polygon for polygon, clipped where
the result was; that piece made a closed solid (:mod:`moseg_core.shape.closing`); or its convex hull
(:mod:`moseg_core.shape.convex`).

A part that cannot be closed is written as far as it can be, and it is said why: the search may have
taken hours, and programs that mend meshes exist. Parts without elements have no file.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from moseg_core.errors import ShapeError, UsageError, unknown
from moseg_core.io.whole_file import check_destination
from moseg_core.io.write.names import safe_file_names
from moseg_core.io.write.part_meshes import OF_POINTS, PART_SUFFIXES, PartMesh, encode_part
from moseg_core.search.result import Result
from moseg_core.shape.closing.close import close
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.convex import FEWEST, convex_hull
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import restricted
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import IntArray
from moseg_core.view.palette import part_colors

PLACE = "{part}"
"""What stands for the label in the name of a file."""

#: Single precision moves points; by more than this share of a part's diagonal it is said.
_COARSE = 1e-5


@dataclass(frozen=True, kw_only=True)
class PartForm:
    """What is written of each part.

    Parameters
    ----------
    close : bool
        Its piece of the surface as a closed solid.
    hulls : bool
        Its convex hull instead.
    hull_vertices : int, optional
        The greatest number of vertices of a hull, here and in formats that hold hulls.

    Raises
    ------
    UsageError
        Combinations without a sense, or fewer than 4 vertices.
    """

    close: bool = False
    hulls: bool = False
    hull_vertices: int | None = None

    def __post_init__(self) -> None:
        if self.close and self.hulls:
            raise UsageError("parts are closed, or convex hulls, which are closed; ask for one")
        if self.hull_vertices is not None and self.hull_vertices < FEWEST:
            raise UsageError(f"a hull has {FEWEST} vertices or more, not {self.hull_vertices}")

    @property
    def asked(self) -> str:
        """What is asked for beyond the surface, as options say it; empty for nothing."""
        return "close" if self.close else "hulls" if self.hulls else ""


def is_for_parts(path: Path) -> bool:
    """Whether a path stands for one file for each part.

    Raises
    ------
    UsageError
        Something else than the part in braces, or the part in the name of a folder.

    Examples
    --------
    >>> is_for_parts(Path("parts/{part}.stl")), is_for_parts(Path("parts.json"))
    (True, False)
    """
    named = re.findall(r"\{([^{}]*)\}", path.name)
    for name in named:
        if name != "part":
            raise UsageError(f"'{path}': {unknown('name in braces', name, ['part'])}")
    if path.name.count(PLACE) * 2 != sum(map(path.name.count, "{}")):
        raise UsageError(f"'{path}': braces stand around 'part' only, as in 'parts/{PLACE}.stl'")
    if not named and PLACE in str(path.parent):
        raise UsageError(
            f"'{path}': {PLACE} stands in the name of the file, not of a folder, as in"
            f" 'parts/{PLACE}.stl'"
        )
    return bool(named)


def check_part_files(path: Path) -> None:
    """Refuse a path for parts that cannot be written, now rather than after a long search.

    The last folder of the path need not exist; it is made.

    Raises
    ------
    UsageError
        A format that is not for single parts, or no such folder.
    MosegError
        The folder takes no files; the disk is full.
    """
    if path.suffix.lower() not in PART_SUFFIXES:
        suffix = "".join(path.suffixes[-2:]) if path.suffix.lower() == ".gz" else path.suffix
        asked = f"as '{suffix}'" if suffix else "without a suffix"
        raise UsageError(
            f"cannot write one file per part {asked}; formats: {', '.join(PART_SUFFIXES)}"
        )
    folder = path.parent
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"cannot write '{path}': '{folder}' is no folder")
    if not folder.exists() and not folder.parent.is_dir():
        raise UsageError(f"cannot write '{path}': there is no folder '{folder.parent}'")
    check_destination(path if folder.exists() else folder)


def check_part_form(path: Path, shape: Shape, form: PartForm) -> None:
    """Refuse what parts of a shape cannot be written as.

    Raises
    ------
    ShapeError
        The shape is a point cloud, the parts of which have neither faces nor an inside.
    """
    if not isinstance(shape.geometry, PointCloud) or form.hulls:
        return
    if form.close:
        raise ShapeError(
            f"'{shape.name}' is a point cloud: its parts have no surface that could be closed; ask"
            f" for hulls instead"
        )
    if path.suffix.lower() not in OF_POINTS:
        raise ShapeError(
            f"'{shape.name}' is a point cloud: its parts have no faces to write as"
            f" '{path.suffix}'; points can be written as {', '.join(OF_POINTS)}, or ask for hulls"
        )


def part_paths(path: Path, labels: Iterable[str]) -> tuple[Path, ...]:
    """The file of each label.

    Examples
    --------
    >>> [str(path) for path in part_paths(Path("out/{part}.stl"), ["head", "head/ear1"])]
    ['out/head.stl', 'out/head-ear1.stl']
    """
    return tuple(path.with_name(path.name.replace(PLACE, name)) for name in safe_file_names(labels))


def part_files(result: Result, path: Path, form: PartForm) -> tuple[dict[Path, bytes], list[str]]:
    """The files of all parts with their contents, and what a user should know; nothing is written.

    Parameters
    ----------
    result : Result
    path : Path
        With ``{part}`` in its name.
    form : PartForm

    Raises
    ------
    UsageError, ShapeError
        The path, or the shape with this form, is refused.
    """
    check_part_files(path)
    check_part_form(path, result.shape, form)
    suffix = path.suffix.lower()
    labels = result.problem.labels
    colors = part_colors(len(labels))
    parts = part_meshes(
        result, close=form.close, hulls=form.hulls, hull_vertices=form.hull_vertices
    )
    files, notes = {}, []
    for part, file, color in zip(parts, part_paths(path, labels), colors, strict=True):
        if part.note:
            notes.append(f"part '{part.label}' {part.note}")
        if part.geometry is not None:
            files[file] = encode_part(part, suffix, color)
    notes += _about_shortfall(parts, form)
    if suffix == ".stl":
        notes += _about_precision(parts)
    return files, notes


def part_meshes(
    result: Result,
    *,
    close: bool = False,
    hulls: bool = False,
    hull_vertices: int | None = None,
) -> tuple[PartMesh, ...]:
    """What each part is, as a mesh of its own.

    Parameters
    ----------
    result : Result
        Of a clipped one the pieces of faces.
    close : bool
        Each part as a closed solid, its rims capped.
    hulls : bool
        The convex hull of each part instead of its surface.
    hull_vertices : int, optional
        The greatest number of vertices of a hull, 4 or more.

    Returns
    -------
    tuple of PartMesh
        One for each label of the problem, in that order.

    Raises
    ------
    UsageError
        Combinations without a sense, or fewer than 4 vertices.
    ShapeError
        Parts of a point cloud are to be closed.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> parts = moseg.part_meshes(result, close=True)  # doctest: +SKIP
    >>> [part.label for part in parts if not part.closed]  # doctest: +SKIP
    []
    """
    form = PartForm(close=close, hulls=hulls, hull_vertices=hull_vertices)
    geometry, labels = result.surface
    if close and isinstance(geometry, PointCloud):
        check_part_form(Path(), result.shape, form)
    up = result.shape.up
    return tuple(
        replace(_part_mesh(geometry, np.flatnonzero(labels == number), label, form), up=up)
        for number, label in enumerate(result.problem.labels)
    )


def _part_mesh(geometry: Geometry, elements: IntArray, label: str, form: PartForm) -> PartMesh:
    if len(elements) == 0:
        return PartMesh(label=label, geometry=None, note="is empty, and has no file")
    if form.hulls:
        return _hull(geometry, elements, label, form.hull_vertices)
    if isinstance(geometry, PointCloud):
        return PartMesh(label=label, geometry=_points(geometry, elements))
    if isinstance(geometry, PolygonMesh):
        mesh = restricted(geometry, elements)
    else:
        if form.close and isinstance(geometry, VoxelGrid) and geometry.solid:
            geometry, elements = _cells(geometry, elements)
        chosen = np.isin(geometry.triangle_polygon, elements)
        if not chosen.any():
            return PartMesh(
                label=label,
                geometry=None,
                note="lies within the solid, where nothing of it is seen, and has no file; ask for"
                " closed parts",
            )
        mesh = PolygonMesh.from_faces(geometry.vertices, geometry.triangles[chosen])
    if not form.close:
        return PartMesh(label=label, geometry=mesh)
    closed = close(mesh)
    return PartMesh(
        label=label,
        geometry=closed.mesh if closed.mesh.n_polygons else mesh,
        closed=not closed.reason,
        note=f"is no closed solid: {closed.reason}" if closed.reason else "",
    )


def _hull(geometry: Geometry, elements: IntArray, label: str, most: int | None) -> PartMesh:
    corners = np.zeros(geometry.n_elements, np.bool_)
    corners[elements] = True
    used = np.repeat(corners, np.diff(geometry.offsets))
    hull = convex_hull(geometry.vertices[np.unique(geometry.corners[used])], most=most)
    if hull is None:
        return PartMesh(label=label, geometry=None, note="is a single point, and has no hull")
    return PartMesh(
        label=label,
        geometry=PolygonMesh.from_faces(hull.vertices, hull.triangles, weld=0.0),
        closed=True,
        note="is flat: its hull is given a thousandth of its length as thickness"
        if hull.thickened
        else "",
        shortfall=hull.shortfall,
    )


def _points(cloud: PointCloud, elements: IntArray) -> PointCloud:
    return PointCloud.from_points(
        cloud.vertices[elements],
        areas=cloud.areas[elements],
        normals=None if cloud.normals is None else cloud.normals[elements],
    )


def _cells(grid: VoxelGrid, elements: IntArray) -> tuple[VoxelGrid, IntArray]:
    """Some cells of a solid as a solid of their own."""
    kept = np.zeros_like(grid.occupied)
    kept[tuple(grid.cells[elements].T)] = True
    alone = VoxelGrid.from_occupied(kept, pitch=grid.steps, origin=grid.origin)
    return alone, np.arange(alone.n_elements)


def _about_shortfall(parts: Iterable[PartMesh], form: PartForm) -> list[str]:
    """How much is lost where hulls have few vertices."""
    worst = max(parts, key=lambda part: part.shortfall)
    if worst.shortfall == 0.0:
        return []
    assert worst.geometry is not None  # it has a hull
    diagonal = float(np.linalg.norm(np.ptp(worst.geometry.vertices, axis=0)))
    return [
        f"hulls of at most {form.hull_vertices} vertices: parts stick out by"
        f" {worst.shortfall:.3g} at most, {100 * worst.shortfall / diagonal:.2g} % of the length of"
        f" '{worst.label}'"
    ]


def _about_precision(parts: Iterable[PartMesh]) -> list[str]:
    """Which parts lose in single precision what matters."""
    found = []
    for part in parts:
        if part.geometry is None:
            continue
        vertices = part.geometry.vertices
        step = float(np.spacing(np.float32(np.abs(vertices).max())))
        if step > _COARSE * float(np.linalg.norm(np.ptp(vertices, axis=0))):
            found.append(part.label)
    if not found:
        return []
    return [
        f"{', '.join(repr(label) for label in found)}: far from the origin, where .stl holds"
        f" places {step:.1g} apart; .ply, .obj and .glb keep them"
    ]
