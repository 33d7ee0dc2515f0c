"""What the columns of a table of points mean: places, normals, areas, and the rest.

Where columns have names, these say it: ``x y z``, ``nx ny nz``, ``area``, in any order and among
others, or as some programs call them (``Points:0``, ``normal_x``, ``easting``). Without names the
first three columns are the place. Behind them come colours, intensities, normals and labels in an
order of every program's own; three columns side by side are a normal where every row of them is
of length 0 or about 1. What is neither is passed over, and the shape's notes say so.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from moseg_core.io.read.checked import quoted
from moseg_core.types import BoolArray, FloatArray

_SYNONYMS = {
    "x": ("x", "x_coord", "x coordinate", "coord_x", "pos_x", "position_x", "px", "points:0",
          "points_0", "coordinates:0", "easting"),
    "y": ("y", "y_coord", "y coordinate", "coord_y", "pos_y", "position_y", "py", "points:1",
          "points_1", "coordinates:1", "northing"),
    "z": ("z", "z_coord", "z coordinate", "coord_z", "pos_z", "position_z", "pz", "points:2",
          "points_2", "coordinates:2", "elevation", "height", "altitude"),
    "nx": ("nx", "normal_x", "normalx", "n_x", "normals:0", "normals_0", "normal x"),
    "ny": ("ny", "normal_y", "normaly", "n_y", "normals:1", "normals_1", "normal y"),
    "nz": ("nz", "normal_z", "normalz", "n_z", "normals:2", "normals_2", "normal z"),
    "area": ("area",),
}  # fmt: skip
_PLACE, _NORMAL = ("x", "y", "z"), ("nx", "ny", "nz")


def named_columns(names: Sequence[str]) -> dict[str, int]:
    """Where the columns stand that mean something, by name.

    Parameters
    ----------
    names : sequence of str
        In small letters.

    Returns
    -------
    dict of str to int
        Of "x", "y", "z", "nx", "ny", "nz", "area" those that there are.

    Examples
    --------
    >>> named_columns(["id", "points:0", "points:1", "points:2"])
    {'x': 1, 'y': 2, 'z': 3}
    """
    found = {}
    for meaning, synonyms in _SYNONYMS.items():
        place = next((names.index(name) for name in synonyms if name in names), None)
        if place is not None:
            found[meaning] = place
    return found


def unnamed_columns(width: int, column: Callable[[int], FloatArray | None]) -> dict[str, int]:
    """Where the place stands and, if columns look like it, the normal, as :func:`named_columns`.

    Parameters
    ----------
    width : int
        How many columns there are, three at least.
    column : callable
        The numbers of a column; None where it has others than numbers.

    Examples
    --------
    >>> table = np.array([[0, 0, 0, 9, 0, 0, 1.0], [1, 0, 0, 8, 0, 0.6, 0.8]])
    >>> unnamed_columns(7, lambda k: table[:, k])
    {'x': 0, 'y': 1, 'z': 2, 'nx': 4, 'ny': 5, 'nz': 6}
    """
    places = dict(zip(_PLACE, range(3), strict=True))
    columns = [column(k) for k in range(3, width)]
    for first in range(len(columns) - 2):
        three = [values for values in columns[first : first + 3] if values is not None]
        if len(three) == 3 and _unit(np.stack(three, axis=1), whole=first == 0):
            return places | dict(zip(_NORMAL, range(first + 3, first + 6), strict=True))
    return places


def _unit(rows: FloatArray, *, whole: bool) -> bool:
    """Whether all rows are of length 0 or about 1, not all of them 0.

    Labels and colours may be 0 and 1, so that whole numbers count only where normals mostly are.
    """
    rows = rows[np.isfinite(rows).all(axis=1)]
    with np.errstate(over="ignore"):
        length = np.sqrt((rows**2).sum(axis=1))
    unit: BoolArray = (length == 0.0) | (np.abs(length - 1.0) < 0.1)
    return bool(unit.all() and length.any() and (whole or (rows != np.round(rows)).any()))


def passed_over(width: int, used: Sequence[int], names: Sequence[str] = ()) -> list[str]:
    """The note about columns that mean nothing here; none where there are no such.

    Examples
    --------
    >>> passed_over(7, [0, 1, 2])
    ['passed over: columns 4, 5, 6, 7']
    >>> passed_over(4, [1, 2, 3], ["id", "x", "y", "z"])
    ["passed over: column 'id'"]
    """
    left = sorted(set(range(width)) - set(used))
    if not left:
        return []
    words = [quoted(names[k]) if names else str(k + 1) for k in left[:12]]
    more = f" and {len(left) - 12} more" if len(left) > 12 else ""
    return [f"passed over: column{'s' * (len(left) > 1)} {', '.join(words)}{more}"]
