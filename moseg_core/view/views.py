"""From which sides to look at a shape that stands before the viewer.

How it stands, :mod:`moseg_core.view.camera` says. The main view is a three-quarter view, a fixed
yaw and pitch away, which shows three faces of a box. The opposite one looks exactly the other way,
so that the two together show all of a convex shape. A number of views go round the shape in equal
steps from the main one.

Front is where a plane of symmetry is seen edge on, between a left and a right: across a person's
shoulders, but along a horse's back. Nothing tells front from back: of the two, front is the side
that sticks out. Left and right are the viewer's, as he stands in front.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias, get_args

import numpy as np

from moseg_core.errors import UsageError, unknown
from moseg_core.shape.geometry import Geometry
from moseg_core.types import FloatArray
from moseg_core.view.camera import standing_axes
from moseg_core.view.upright import mirror_errors

View: TypeAlias = Literal["main", "opposite", "front", "back", "left", "right", "top", "bottom"]
"""What a view is called."""

USUAL: tuple[View, ...] = ("main", "opposite")
"""What is drawn where nobody asks for others."""

_YAW, _PITCH = np.radians(-30.0), np.radians(20.0)
#: As many views around a shape are plenty.
_MOST = 36
#: Degrees to turn about the upright axis from the front.
_AROUND = {"front": 0.0, "right": 90.0, "back": 180.0, "left": 270.0}


def read_views(text: str) -> tuple[View, ...] | int:
    """Views from a text: names separated by commas, or a number of views all around.

    Raises
    ------
    UsageError
        A name that is no view, or a number that is none.

    Examples
    --------
    >>> read_views("front, top"), read_views("4")
    (('front', 'top'), 4)
    """
    text = text.strip()
    if text.isdecimal():
        if len(text) > 9 or not 1 <= int(text) <= _MOST:
            raise UsageError(f"{text:.20} views cannot be drawn; allowed are 1 to {_MOST}")
        return int(text)
    known: tuple[View, ...] = get_args(View)
    by_name: dict[str, View] = {view: view for view in known}
    chosen = []
    for word in text.split(","):
        name = word.strip().lower()
        if name not in by_name:
            raise UsageError(f"{unknown('view', name, known)}; or a number of views all around")
        chosen.append(by_name[name])
    return tuple(chosen)


def rotations_of(
    mesh: Geometry, views: Sequence[View] | int, up: FloatArray | None
) -> list[FloatArray]:
    """For each view what is to the right, up and towards the viewer there, as rows.

    Parameters
    ----------
    mesh : Geometry
        With triangles.
    views : sequence of View, or int
        Names, or how many views all around.
    up : (3,) float or None
        The unit direction that is up; found by the shape alone where there is none.

    Returns
    -------
    list of (3, 3) float

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> tile = PolygonMesh.from_faces([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> top, = rotations_of(tile, ["top"], np.array([0.0, 0.0, 1.0]))
    >>> (top[2].round(9) + 0.0).tolist()
    [0.0, 0.0, 1.0]
    """
    corners = mesh.vertices[mesh.triangles]
    axes = standing_axes(corners, up)
    if isinstance(views, int):
        steps = 2.0 * np.pi * np.arange(views) / views
        return [_pitched(_PITCH) @ _yawed(_YAW + step) @ axes for step in steps]
    front = axes
    if set(views) - set(USUAL):
        across, toward = mirror_errors(corners, axes[[0, 2]])
        if toward < across:  # the left and the right side are in front of and behind each other
            front = _yawed(np.pi / 2.0) @ axes
    return [_rotation(view, axes, front) for view in views]


def _rotation(view: View, axes: FloatArray, front: FloatArray) -> FloatArray:
    main = _pitched(_PITCH) @ _yawed(_YAW) @ axes
    if view == "main":
        return main
    if view == "opposite":
        # Towards the viewer is away from the other; up stays up, so that right becomes left.
        opposite: FloatArray = main * np.array([[-1.0], [1.0], [-1.0]])
        return opposite
    if view in _AROUND:
        return _yawed(np.radians(_AROUND[view])) @ front
    return _pitched(np.pi / 2.0 if view == "top" else -np.pi / 2.0) @ front


def _yawed(angle: float) -> FloatArray:
    """(3, 3) the turn about the upright axis, to see more of what was on the right."""
    c, s = np.cos(angle), np.sin(angle)
    turn: FloatArray = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    return turn


def _pitched(angle: float) -> FloatArray:
    """(3, 3) the turn about the level axis, to see more of what was above."""
    c, s = np.cos(angle), np.sin(angle)
    turn: FloatArray = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    return turn
