"""What components may require of a shape: a volume, known neighbours, a surface.

An objective declares it (:class:`~moseg_core.components.objectives.Traits`), or a field
(:class:`~moseg_core.components.discovery.specs.FieldSpec`). A shape that lacks it is refused before
the search, with the words from here.
"""

from __future__ import annotations

from moseg_core.components.discovery.specs import Requirement
from moseg_core.shape.shape import Shape


def lack(shape: Shape, requirement: Requirement) -> str | None:
    """What a shape lacks and what to do about it, in words; None where it lacks nothing."""
    if requirement == "volume" and shape.volume is None:
        repair = "repair the mesh, " if shape.has_surface else ""
        remedy = shape.enclosed.remedy or "have it estimated (--volume VALUE|hull|winding)"
        return (
            f"an enclosed volume, but '{shape.name}' encloses none: {shape.volume_reason};"
            f" {repair}leave out the term or {remedy}"
        )
    if requirement == "adjacency" and shape.adjacency is None:
        return (
            f"to know which elements touch, but '{shape.name}' does not say; leave out the term"
            f" or take the nearest (--adjacency knn)"
        )
    if requirement == "surface" and not shape.has_surface:
        if shape.solid:
            return (
                f"a surface, but the cells of '{shape.name}' fill a solid; leave out the term or"
                f" read the surface alone (--voxels surface)"
            )
        return f"a surface, but '{shape.name}' is a {shape.geometry.kind}; leave out the term"
    return None
