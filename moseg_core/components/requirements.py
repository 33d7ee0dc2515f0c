"""What components may require of a shape: a volume, known neighbours, a surface.

An objective declares it (:class:`~moseg_core.components.objectives.Traits`), or the spec of a
field, a measure or a parameterization (:mod:`moseg_core.components.discovery.specs`). A shape that
lacks it is refused before the search, with the words from here; where an objective takes a measure
or a field that it has not declared, when it does.
"""

from __future__ import annotations

from collections.abc import Iterable

from moseg_core.components.discovery.specs import Requirement
from moseg_core.errors import ShapeError
from moseg_core.shape.shape import Shape

LEAVE_OUT = "leave out the term"


class LackError(ShapeError):
    """A shape lacks what a component requires; nobody's code is to blame."""


def demand(
    shape: Shape, requires: Iterable[Requirement], who: str, *, instead: str = LEAVE_OUT
) -> None:
    """Refuse a shape that lacks something.

    Parameters
    ----------
    shape : Shape
    requires : iterable of {"volume", "adjacency", "surface"}
    who : str
        Who requires it, for the message.
    instead : str
        What to do where the shape cannot be helped.

    Raises
    ------
    LackError
        With what it lacks, and what to do.
    """
    for requirement in sorted(requires):
        missing = lack(shape, requirement, instead=instead)
        if missing is not None:
            raise LackError(f"{who} needs {missing}")


def lack(shape: Shape, requirement: Requirement, *, instead: str = LEAVE_OUT) -> str | None:
    """What a shape lacks and what to do about it, in words; None where it lacks nothing."""
    if requirement == "volume" and shape.volume is None:
        repair = "repair the mesh, " if shape.has_surface else ""
        remedy = shape.enclosed.remedy or "have it estimated (--volume VALUE|hull|winding)"
        return (
            f"an enclosed volume, but '{shape.name}' encloses none: {shape.volume_reason};"
            f" {repair}{instead} or {remedy}"
        )
    if requirement == "adjacency" and shape.adjacency is None:
        return (
            f"to know which elements touch, but '{shape.name}' does not say; {instead}"
            f" or take the nearest (--adjacency knn)"
        )
    if requirement == "surface" and not shape.has_surface:
        if shape.solid:
            return (
                f"a surface, but the cells of '{shape.name}' fill a solid; {instead} or"
                f" read the surface alone (--voxels surface)"
            )
        return f"a surface, but '{shape.name}' is a {shape.geometry.kind}; {instead}"
    return None
