"""The formats that a result is saved in: functions of a result that return bytes.

They add nothing that depends on when or where they run: equal results give equal bytes.
"""

from __future__ import annotations

from moseg_core.io.labels.writing import encode_seg
from moseg_core.io.write.arrays import check_grid, encode_npy, encode_npz
from moseg_core.io.write.glb import encode_glb
from moseg_core.io.write.line_names import line_names
from moseg_core.io.write.obj import encode_obj
from moseg_core.io.write.ply import encode_ply, encode_points_ply
from moseg_core.io.write.threemf import check_solids
from moseg_core.io.write.vtu import encode_vtu
from moseg_core.search.result import Result
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.moments import element_moments
from moseg_core.shape.shape import Shape
from moseg_core.view.palette import part_colors
from moseg_core.view.point_bodies import drawable


def write_seg(result: Result) -> bytes:
    """One label number a line, element by element."""
    return encode_seg(result.labels)


def write_ply(result: Result) -> bytes:
    """The input's polygons, or a clipped result's pieces; else a point for every element.

    Each with its colour and label.
    """
    names, (surface, labels) = result.problem.labels, result.surface
    colors = part_colors(len(names))
    if not isinstance(surface, PolygonMesh):
        return encode_points_ply(result.shape, labels, names, colors)
    source = None if result.clipped is None else result.clipped.source
    return encode_ply(surface, labels, names, colors, source=source)


def write_obj(result: Result, *, name: str) -> dict[str, bytes]:
    """The input's polygons as one object per part, with materials in a file beside it.

    Of voxels the exposed faces, of points small octahedra.
    """
    names, (mesh, labels) = result.problem.labels, result.surface
    # Not every program reads all of a line that names a file with blanks.
    stem = line_names([name.rpartition(".")[0]], also=" #\\/:")[0]
    materials = f"{stem}.mtl"
    obj, mtl = encode_obj(
        drawable(mesh), labels, names, part_colors(len(names)), materials_file=materials
    )
    return {name: obj, materials: mtl}


def write_vtu(result: Result) -> bytes:
    """An unstructured grid of VTK: a cell for every element, with its label and area."""
    names, (geometry, labels) = result.problem.labels, result.surface
    shape, clipped = result.shape, result.clipped
    measure = "volume" if shape.solid else "area"
    if clipped is None:
        return encode_vtu(geometry, labels, names, {measure: shape.areas})
    areas = element_moments(geometry, shape.frame.center).areas
    return encode_vtu(geometry, labels, names, {measure: areas, "source": clipped.source})


def write_npz(result: Result) -> bytes:
    """Labels, names, places and areas as arrays."""
    return encode_npz(result.shape, result.labels, result.problem.labels)


def write_npy(result: Result) -> bytes:
    """The voxel grid with the label of each cell."""
    return encode_npy(result.shape, result.labels, result.problem.labels)


def check_writable(suffix: str, shape: Shape) -> None:
    """Refuse before the search what the writer of a suffix would refuse after it.

    Parameters
    ----------
    suffix : str
        Such as ".npy".
    shape : Shape

    Raises
    ------
    UsageError
        The format cannot hold such a shape.
    """
    if suffix.lower() == ".npy":
        check_grid(shape)
    if suffix.lower() == ".3mf":
        check_solids(shape)


def output_note(suffix: str, shape: Shape) -> str:
    """What a user should know of a file that is to be written; empty for nothing.

    Parameters
    ----------
    suffix : str
        Such as ".glb".
    shape : Shape

    Examples
    --------
    >>> shape = Shape.from_points([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> output_note(".glb", shape.with_up("z"))
    "turned so that the shape's z points up in glTF too, where y does; labels still fit the shape"
    >>> output_note(".glb", shape), output_note(".ply", shape.with_up("z"))
    ('', '')
    """
    if suffix.lower() != ".glb" or shape.up in (None, "y"):
        return ""
    return (
        f"turned so that the shape's {shape.up} points up in glTF too, where y does; labels still"
        " fit the shape"
    )


def write_glb(result: Result) -> bytes:
    """A scene with one coloured node per part, named by its label."""
    names, (mesh, labels) = result.problem.labels, result.surface
    colors = part_colors(len(names))
    return encode_glb(drawable(mesh), labels, names, colors, up=result.shape.up)
