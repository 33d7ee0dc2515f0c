"""``moseg symmetry SHAPE``: the planes and axes of symmetry of a shape, and how good they are."""

from __future__ import annotations

import json as json_format
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from moseg_core import Shape
    from moseg_symmetry.axis_detection import AxisSymmetry
    from moseg_symmetry.plane_detection import PlaneSymmetry


def symmetry(shape: Path, /, *, json: bool = False) -> None:
    """Show the planes and axes of symmetry of a shape.

    Residuals are root mean square distances of mirrored or turned points from the surface, each
    counted as 2 % at most, in percent of the shape's size, which is the diameter of the ball
    around its centroid that holds it. 0 is best. The share is that of the area which is mapped to
    within 1 % of the size of the surface. The first plane is that of --plane auto.

    Examples
    --------
    moseg symmetry horse.off

    moseg segment horse.off --recipe paper_bulldog --plane 0,0,0,1,0,0

    Parameters
    ----------
    shape
        Mesh: OFF, PLY, OBJ, STL or GLB.
    json
        Print JSON instead of tables.
    """
    from moseg_core import load, printable

    found = symmetries(load(shape))
    if json:
        print(json_format.dumps(document(found), indent=2, ensure_ascii=False, allow_nan=False))
    else:
        print("\n".join(map(printable, report(found))))


@dataclass(frozen=True, eq=False, kw_only=True)
class Symmetries:
    """All that was found on a shape.

    Parameters
    ----------
    shape : Shape
    size : float, model units
        Diameter of the ball around the centroid that holds the shape.
    planes : sequence of PlaneSymmetry
        Those that hold, or else the best one.
    axes : sequence of AxisSymmetry
        Those that hold.
    """

    shape: Shape
    size: float
    planes: Sequence[PlaneSymmetry]
    axes: Sequence[AxisSymmetry]


def symmetries(shape: Shape) -> Symmetries:
    """The planes and axes of symmetry of a shape."""
    from moseg_symmetry.axis_detection import detect_axes
    from moseg_symmetry.plane_detection import detect_planes
    from moseg_symmetry.surface import surface_of

    planes = detect_planes(shape)
    holding = [plane for plane in planes if plane.holds]
    if not holding:
        holding = [max(planes, key=lambda plane: plane.share)]
    size = surface_of(shape).size
    return Symmetries(shape=shape, size=size, planes=holding, axes=detect_axes(shape))


def report(found: Symmetries) -> list[str]:
    """The lines to print."""
    shape = found.shape
    lines = [f"{shape.name}: {shape.n_elements} faces, size {found.size:.6g}", ""]
    if found.planes[0].holds:
        rows = [("plane (for --plane)", "residual", "share", "")]
        for place, plane in enumerate(found.planes):
            values = (_percent(plane.residual, 3), _percent(plane.share, 1))
            rows.append((str(plane.plane), *values, "auto" if place == 0 else ""))
        lines += _aligned(rows)
    else:
        best = found.planes[0]
        lines.append(
            f"no plane of symmetry; the best one maps {_percent(best.share, 1)} of the surface onto"
            f" itself (residual {_percent(best.residual, 3)}): {best.plane}"
        )
    lines.append("")
    if found.axes:
        rows = [("axis (point and direction)", "residual", "share", "the same")]
        for axis in found.axes:
            values = (_percent(axis.residual, 3), _percent(axis.share, 1))
            rows.append((_numbers([*axis.point, *axis.direction]), *values, _times(axis.fold)))
        lines += _aligned(rows)
    else:
        lines.append("no axis of symmetry")
    if sum(axis.fold is None for axis in found.axes) > 1:
        lines.append(
            "several axes of revolution: it is a ball, the same after any turn about its middle"
        )
    return lines


def document(found: Symmetries) -> dict[str, Any]:
    """The same as a JSON document; lengths in model units, residuals as shares of the size."""
    return {
        "shape": found.shape.name,
        "size": found.size,
        "planes": [
            {
                "plane": str(symmetry.plane),
                "point": symmetry.plane.point.tolist(),
                "normal": symmetry.plane.normal.tolist(),
                "residual": symmetry.residual,
                "share": symmetry.share,
                "holds": symmetry.holds,
            }
            for symmetry in found.planes
        ],
        "axes": [
            {
                "point": axis.point.tolist(),
                "direction": axis.direction.tolist(),
                "fold": axis.fold,
                "residual": axis.residual,
                "share": axis.share,
            }
            for axis in found.axes
        ],
    }


def _times(fold: int | None) -> str:
    return "after any turn" if fold is None else f"{fold} times in a full turn"


def _percent(value: float, digits: int) -> str:
    return f"{100.0 * value:.{digits}f} %"


def _numbers(numbers: Sequence[float]) -> str:
    return ",".join(f"{number + 0.0:.6g}" for number in numbers)


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of a table, with the numbers in the middle columns flush right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        cells = [row[0].ljust(widths[0])]
        cells += [cell.rjust(width) for cell, width in zip(row[1:3], widths[1:3], strict=True)]
        lines.append("  ".join([*cells, row[3]]).rstrip())
    return lines
