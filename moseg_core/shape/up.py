"""Which way is up: one of the axes of the file, where anybody knows.

Few formats say: glTF is Y-up by its specification (2.0, section 3.3), others follow the habits of
the program that wrote them. So a shape bears what its reader or its user knows of it,
:attr:`moseg_core.shape.data.ShapeData.up`, as the name of an axis, and None where nobody does. No
measure depends on it; whoever draws a shape (:mod:`moseg_core.view`), or writes it into a format
that has an up of its own, asks.
"""

from __future__ import annotations

from typing import Literal, TypeAlias, get_args

import numpy as np

from moseg_core.errors import UsageError, unknown
from moseg_core.types import FloatArray

Up: TypeAlias = Literal["x", "-x", "y", "-y", "z", "-z"]
"""The axis that points up."""


def checked_up(name: str) -> Up:
    """The axis of a name.

    Raises
    ------
    UsageError
        There is no such axis.

    Examples
    --------
    >>> checked_up("-z")
    '-z'
    """
    known: tuple[Up, ...] = get_args(Up)
    for up in known:
        if up == name:
            return up
    raise UsageError(unknown("axis", name, known))


def up_direction(up: Up) -> FloatArray:
    """(3,) float: the unit vector that points up.

    Examples
    --------
    >>> up_direction("-z").tolist()
    [0.0, 0.0, -1.0]
    """
    direction = np.zeros(3)
    direction["xyz".index(up[-1])] = -1.0 if up.startswith("-") else 1.0
    return direction


def turn_to_y(up: Up | None) -> FloatArray:
    """(3, 3) float: the rotation that takes the axis which points up to +y, which is up in glTF.

    Its entries are 0, 1 and -1: coordinates change places and signs, and lose nothing.

    Parameters
    ----------
    up : {"x", "-x", "y", "-y", "z", "-z"} or None
        As ``Shape.up``; None, where it is not known, turns nothing.

    Examples
    --------
    >>> (turn_to_y("z") @ [1.0, 2.0, 3.0]).tolist()
    [1.0, 3.0, -2.0]
    """
    turn = np.eye(3)
    if up is None or up == "y":
        return turn
    axis, sign = "xyz".index(up[-1]), -1.0 if up[0] == "-" else 1.0
    if axis == 1:
        turn[1, 1] = turn[2, 2] = -1.0
        return turn
    # A quarter turn in the plane of the axis and y.
    turn[axis, axis] = turn[1, 1] = 0.0
    turn[1, axis], turn[axis, 1] = sign, -sign
    return turn
