"""The parts of a result as rigid bodies: what is seen, what collides, what it weighs.

Simulators collide convex bodies. A part is seen as its piece of the surface and collides as its
convex hull, of at most 64 vertices, which is what collision on graphics cards takes; how far the
part sticks out of it is told. The mass is that of the part as a closed solid of density 1, its
cuts capped, where it can be closed, else of its hull. Parts that are flat have a hull that is
given some thickness (:func:`moseg_core.part_meshes`).

A body's frame lies in its centre of mass, with the axes of the shape. Meshes are written relative
to it, so that single precision loses nothing of a shape that is far from the origin. Simulators
have z up: where it is known that another axis of the shape points up, the whole is turned.
:mod:`urdf <moseg_robotics.urdf>` and :mod:`mjcf <moseg_robotics.mjcf>` write the bodies.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
import trimesh
from trimesh.exchange.stl import export_stl

from moseg_core import (
    Geometry,
    PartMesh,
    Result,
    UsageError,
    part_colors,
    part_meshes,
    safe_file_names,
)

Floats: TypeAlias = npt.NDArray[np.float64]
Ints: TypeAlias = npt.NDArray[np.int64]

MOST_VERTICES = 64
"""The greatest number of vertices of a hull."""

#: In a body's inertia no principal moment exceeds the sum of the others, but for rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """A part as a rigid body.

    Parameters
    ----------
    label : str
        As the problem has it.
    name, hull_name : str
        Safe as names in XML and as those of files, different from all others of the result.
    color : (3,) float
        Red, green and blue, 0 to 1.
    center : (3,) float, model units
        The centre of mass.
    surface : trimesh.Trimesh
        What is seen, relative to the centre.
    hull : trimesh.Trimesh
        What collides, relative to the centre.
    shortfall : float, model units
        How far the part sticks out of the hull.
    mass : float, model units cubed
        For density 1.
    inertia : (3, 3) float
        About the centre, along the shape's axes.
    solid : bool
        Whether mass and inertia are those of the closed part, not of its hull.
    """

    label: str
    name: str
    hull_name: str
    color: Floats
    center: Floats
    surface: trimesh.Trimesh
    hull: trimesh.Trimesh
    shortfall: float
    mass: float
    inertia: Floats
    solid: bool

    @property
    def remark(self) -> str:
        """How mass and hull came about."""
        weighed = "of the part, its cuts capped" if self.solid else "of the hull"
        missed = f"; the part sticks out by {self.shortfall:.3g}" if self.shortfall else ""
        return f"mass {weighed}; hull of {len(self.hull.vertices)} vertices{missed}"


def bodies_of(
    result: Result, *, root: str, hull_vertices: int = MOST_VERTICES
) -> tuple[str, list[Body]]:
    """The parts that have elements, as rigid bodies.

    Parameters
    ----------
    result : Result
    root : str
        What to call the whole.
    hull_vertices : int
        The greatest number of vertices of a hull.

    Returns
    -------
    root : str
        Its name, safe and different from those of the bodies.
    bodies : list of Body
        In the order of the labels.

    Raises
    ------
    UsageError
        No part has any extent.
    """
    labels = result.problem.labels
    names = safe_file_names([*labels, root, *(f"{label}_hull" for label in labels)])
    hulls = part_meshes(result, hulls=True, hull_vertices=hull_vertices)
    surfaces, solids = hulls, hulls
    if result.shape.has_surface:
        surfaces, solids = part_meshes(result), part_meshes(result, close=True)
    bodies = []
    colors = part_colors(len(labels)) / 255.0
    for place, (hull, surface, solid) in enumerate(zip(hulls, surfaces, solids, strict=True)):
        if hull.geometry is not None:
            name, hull_name = names[place], names[len(labels) + 1 + place]
            bodies.append(_body(hull, surface, solid, name, hull_name, colors[place]))
    if not bodies:
        raise UsageError(f"no part of '{result.shape.name}' has an extent that a body could have")
    return names[len(labels)], bodies


def mesh_files(bodies: Iterable[Body], folder: str) -> dict[str, bytes]:
    """The meshes of bodies in files: surfaces as OBJ, hulls as binary STL.

    Parameters
    ----------
    bodies : iterable of Body
    folder : str
        Where they are, relative to the file that names them.

    Returns
    -------
    dict of str to bytes
    """
    files = {}
    for body in bodies:
        text = body.surface.export(file_type="obj", header="", include_normals=False)
        files[f"{folder}/{body.name}.obj"] = str(text).encode()
        files[f"{folder}/{body.hull_name}.stl"] = export_stl(body.hull)
    return files


def turn_upright(up: str | None) -> tuple[float, float, float]:
    """Roll, pitch and yaw, radians, that turn an axis of a shape to +z.

    Parameters
    ----------
    up : {"x", "-x", "y", "-y", "z", "-z"} or None
        As :attr:`moseg_core.Shape.up`; nothing is turned where it is not known.

    Examples
    --------
    >>> turn_upright("z"), turn_upright(None)
    ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    """
    quarter = math.pi / 2.0
    turns = {
        "x": (0.0, -quarter, 0.0),
        "-x": (0.0, quarter, 0.0),
        "y": (quarter, 0.0, 0.0),
        "-y": (-quarter, 0.0, 0.0),
        "-z": (math.pi, 0.0, 0.0),
    }
    return turns.get(up or "z", (0.0, 0.0, 0.0))


def number(*values: float) -> str:
    """Numbers as XML attributes have them, with twelve digits.

    Examples
    --------
    >>> number(1.0, 0.1 + 0.2, -0.0)
    '1 0.3 0'
    """
    return " ".join(f"{value + 0.0:.12g}" for value in values)


def _body(
    hull: PartMesh,
    surface: PartMesh,
    solid: PartMesh,
    name: str,
    hull_name: str,
    color: Floats,
) -> Body:
    collides = _mesh(hull.geometry)
    weighed = _mesh(solid.geometry) if solid.closed and solid is not hull else collides
    if not _is_physical(weighed):
        weighed = collides
    center = np.array(weighed.center_mass)
    shown = surface.geometry
    seen = collides if shown is None or not len(shown.triangles) else _mesh(shown)
    return Body(
        label=hull.label,
        name=name,
        hull_name=hull_name,
        color=color,
        center=center,
        surface=_moved(seen, -center),
        hull=_moved(collides, -center),
        shortfall=hull.shortfall,
        mass=float(weighed.volume),
        inertia=np.array(weighed.moment_inertia),
        solid=weighed is not collides,
    )


def _mesh(geometry: Geometry | None) -> trimesh.Trimesh:
    assert geometry is not None  # asked for by the caller
    used, faces = np.unique(geometry.triangles, return_inverse=True)
    return trimesh.Trimesh(geometry.vertices[used], faces.reshape(-1, 3), process=False)


def _moved(mesh: trimesh.Trimesh, by: Floats) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices + by, mesh.faces, process=False)


def _is_physical(mesh: trimesh.Trimesh) -> bool:
    """Whether a mesh has mass and an inertia that a body can have; one that crosses itself may not.

    Of a body that can be, no principal moment is greater than the sum of the other two.
    """
    low, middle, high = np.linalg.eigvalsh(mesh.moment_inertia)
    return bool(mesh.volume > 0 and low > 0 and low + middle >= high * (1.0 - _ROUNDING))
