"""The picture of a segmentation, drawn without screen, GPU or GL.

A shape is drawn upright (:mod:`moseg_core.view.upright`) from two opposite sides, or others
(:mod:`moseg_core.view.views`), next to each other, each part in its own colour
(:mod:`moseg_core.view.palette`), above a legend of names and shares of the area. Each view is one
z-buffer at three times the final size (:mod:`moseg_core.view.raster`), in which light and lines are
drawn (:mod:`moseg_core.view.shading`).

The picture is a function of its arguments: the same PNG, byte for byte, for the same input on the
same installation.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.up import checked_up
from moseg_core.types import UNLABELLED, FloatArray, IntArray
from moseg_core.view.camera import best_columns, choose_cameras
from moseg_core.view.legend import LegendEntry, draw_caption, draw_legend, draw_title
from moseg_core.view.normals import corner_normals
from moseg_core.view.palette import part_colors
from moseg_core.view.shading import draw_view
from moseg_core.view.upright import Standing, find_standing
from moseg_core.view.views import USUAL, View, rotations_of

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw

_SMALLEST, _LARGEST = (240, 160), (4000, 2000)

# Samples per pixel and direction; fewer for pictures that would take gigabytes.
_SAMPLES, _FEWER_SAMPLES, _MANY_PIXELS = 3, 2, 2_000_000

#: What has no label is called, and its colour.
_NO_LABEL, _GREY = "no label", (190, 190, 190)


class Legend(Protocol):
    """Draws the words at the bottom of a picture."""

    def __call__(self, draw: ImageDraw, /, *, size: tuple[int, int], pad: int) -> int:
        """Where the room above ends, pixels from the top."""
        ...


def render_picture(
    mesh: Geometry,
    labels: npt.ArrayLike,
    names: Sequence[str],
    *,
    title: str = "",
    size: tuple[int, int] = (1400, 700),
    areas: FloatArray | None = None,
    up: str | None = None,
    views: Sequence[View] | int = USUAL,
    transparent: bool = False,
    legend: bool = True,
) -> bytes:
    """Draw a segmented shape from two sides, or others, with a legend.

    Parameters
    ----------
    mesh : Geometry
    labels : (F,) array_like of int
        The part of each element, 0 to ``len(names) - 1``; -1 has none, and is grey.
    names : sequence of str
        One for each part; a part may be empty, and is then greyed in the legend.
    title : str
        Written at the top left.
    size : (int, int), pixels
        Width and height of the picture.
    areas : (F,) float, optional
        How much each element counts in the legend; the area of its triangles by default.
    up : {"x", "-x", "y", "-y", "z", "-z"}, optional
        The axis that points up; guessed where it is not given, which the picture says.
    views : sequence of str, or int
        From where to look, of "main", "opposite", "front", "back", "left", "right", "top" and
        "bottom"; or a number of views all around.
    transparent : bool
        Whether the background is left out instead of white.
    legend : bool
        Whether to write which colour is which part.

    Returns
    -------
    bytes
        A PNG file.

    Raises
    ------
    ShapeError
        Not one integer label per element, or a label without a name.
    UsageError
        A size below 240 x 160 or above 4000 x 2000 pixels; an axis that is none.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> square = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                                 [[0, 1, 2, 3]])
    >>> render_picture(square, [0], ["all of it"])[1:4]
    b'PNG'
    """
    return draw_parts(
        mesh,
        labels,
        names,
        title=title,
        size=size,
        areas=areas,
        standing=find_standing(mesh, None if up is None else checked_up(up)),
        views=views,
        transparent=transparent,
        legend=legend,
    )


def draw_parts(
    mesh: Geometry,
    labels: npt.ArrayLike,
    names: Sequence[str],
    *,
    title: str,
    size: tuple[int, int],
    areas: FloatArray | None,
    standing: Standing,
    views: Sequence[View] | int,
    transparent: bool,
    legend: bool,
) -> bytes:
    """The same as :func:`render_picture`, where it is settled how the shape stands."""
    label, names, colors = _with_unlabelled(mesh, labels, names)
    entries = _legend(_triangle_areas(mesh) if areas is None else areas, label, names)

    def words(draw: ImageDraw, /, *, size: tuple[int, int], pad: int) -> int:
        return draw_legend(draw, entries, colors, size=size, pad=pad) if legend else size[1]

    return draw_sides(
        mesh,
        label,
        label,
        colors,
        legend=words,
        title=title,
        size=size,
        standing=standing,
        views=views,
        transparent=transparent,
        captioned=legend,
    )


def _with_unlabelled(
    mesh: Geometry, labels: npt.ArrayLike, names: Sequence[str]
) -> tuple[IntArray, list[str], npt.NDArray[np.uint8]]:
    """Labels, names and colours, with a grey one more for elements that have no label."""
    given = np.asarray(labels)
    colors, names = part_colors(len(names)), list(names)
    without = given == UNLABELLED
    if without.any():
        given = np.where(without, len(names), given)
        names.append(_NO_LABEL)
        colors = np.concatenate([colors, np.array([_GREY], np.uint8)])
    return checked_labels(mesh, given, len(names)).astype(np.int64), names, colors


def checked_size(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height of a picture that can be drawn.

    Raises
    ------
    UsageError
        Below 240 x 160 or above 4000 x 2000 pixels.
    """
    width, height = (int(side) for side in size)
    if not (_SMALLEST[0] <= width <= _LARGEST[0] and _SMALLEST[1] <= height <= _LARGEST[1]):
        raise UsageError(
            f"a picture of {width} x {height} pixels cannot be drawn; allowed are"
            f" {_SMALLEST[0]} x {_SMALLEST[1]} to {_LARGEST[0]} x {_LARGEST[1]}"
        )
    return width, height


def draw_sides(
    mesh: Geometry,
    labels: IntArray,
    shades: IntArray,
    colors: npt.NDArray[np.uint8],
    *,
    legend: Legend,
    title: str,
    size: tuple[int, int],
    standing: Standing,
    views: Sequence[View] | int = USUAL,
    transparent: bool = False,
    captioned: bool = True,
) -> bytes:
    """Draw a shape whose elements have colours from several sides, over a legend.

    Parameters
    ----------
    mesh : Geometry
    labels : (F,) int
        Lines are drawn where they differ.
    shades : (F,) int
        The row of `colors` that each element has.
    colors : (n, 3) uint8
    legend : callable
        Draws at the bottom; returns where the room above ends.
    title : str
    size : (int, int), pixels
    standing : Standing
    views : sequence of View, or int
    transparent : bool
    captioned : bool
        Whether views that were asked for are named, and an up that was guessed is said to be.

    Returns
    -------
    bytes
        A PNG file.

    Raises
    ------
    UsageError
        A size below 240 x 160 or above 4000 x 2000 pixels.
    """
    from PIL import Image, ImageDraw

    width, height = checked_size(size)
    image = Image.new("RGBA", (width, height), (255, 255, 255, 0 if transparent else 255))
    draw = ImageDraw.Draw(image)
    pad = max(8, height // 35)
    taken = 0
    if captioned and standing.guessed:
        at = width - pad, pad
        taken = pad + draw_caption(draw, standing.said, size=(width, height), at=at, right=True)
    top = draw_title(draw, title, size=(width, height), pad=pad, beside=taken)
    bottom = legend(draw, size=(width, height), pad=pad)

    rotations = rotations_of(mesh, views, standing.up)
    room = width, max(1, bottom - top)
    columns = best_columns(mesh, rotations, width=room[0], height=room[1])
    rows = -(-len(rotations) // columns)
    pane = width // columns, max(1, room[1] // rows)
    samples = _SAMPLES if pane[0] * pane[1] * len(rotations) <= _MANY_PIXELS else _FEWER_SAMPLES
    cameras = choose_cameras(mesh, rotations, width=pane[0] * samples, height=pane[1] * samples)
    normals = corner_normals(mesh, labels)
    named = () if isinstance(views, int) or set(views) <= set(USUAL) else views
    for k, camera in enumerate(cameras):
        row, column = divmod(k, columns)
        corner = column * (width - pane[0]) // max(1, columns - 1), top + row * pane[1]
        view = draw_view(mesh, labels, shades, normals, colors, camera, samples, transparent)
        image.alpha_composite(Image.fromarray(view), corner)
        if captioned and named:
            place = corner[0] + pad, corner[1] + pad
            draw_caption(draw, named[k], size=(width, height), at=place)
    buffer = io.BytesIO()
    (image if transparent else image.convert("RGB")).save(buffer, format="PNG")
    return buffer.getvalue()


def _triangle_areas(mesh: Geometry) -> FloatArray:
    """(F,) float: areas of the elements' triangles, in units of the extent."""
    corners = mesh.vertices[mesh.triangles]
    # So that areas of tiny or huge models stay in range.
    extent = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    corners = corners / (extent if extent > 0.0 else 1.0)
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return np.bincount(mesh.triangle_polygon, areas, mesh.n_elements).astype(np.float64)


def _legend(areas: FloatArray, labels: IntArray, names: Sequence[str]) -> list[LegendEntry]:
    area = np.bincount(labels, areas, len(names))
    counts = np.bincount(labels, minlength=len(names))
    shares = 100.0 * area / max(float(area.sum()), 1e-300)
    return [
        LegendEntry(
            name=name,
            share="<1 %" if 0.0 < share < 0.5 else f"{share:.0f} %",
            absent=count == 0,
        )
        for name, share, count in zip(names, shares.tolist(), counts.tolist(), strict=True)
    ]
