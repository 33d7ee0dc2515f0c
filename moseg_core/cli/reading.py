"""From a file and the options on how to read it to a shape; the same for all commands."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

from moseg_core.errors import UsageError, unknown
from moseg_core.io import load
from moseg_core.shape.shape import Shape
from moseg_core.shape.voxels import Elements


def read_shape(
    path: Path, *, voxels: str = "solid", adjacency: str = "auto", volume: str | None = None
) -> Shape:
    """Read a shape and estimate what it does not know of itself, as far as that is asked for.

    Parameters
    ----------
    path : Path
    voxels : str
        "solid" or "surface": which cells of a voxel grid are elements; nothing to other shapes.
    adjacency : str
        See :meth:`moseg_core.shape.shape.Shape.with_adjacency`.
    volume : str or None
        See :meth:`moseg_core.shape.shape.Shape.with_volume`.

    Raises
    ------
    UsageError
        An option's word is none of those allowed.
    ShapeError
        The file cannot be read, or its volume not be estimated.
    """
    elements = next((kind for kind in get_args(Elements) if kind == voxels), None)
    if elements is None:
        raise UsageError(f"--voxels: {unknown('kind of elements', voxels, get_args(Elements))}")
    shape = load(path)
    if elements == "surface" and shape.solid:
        shape = shape.with_elements(elements)
    shape = shape.with_adjacency(adjacency)
    return shape if volume is None else shape.with_volume(volume)
