"""How a shape is read: what is assumed of it that its file does not say.

The command line fills in a :class:`Reading` from its options, and a batch sends one to other
processes; it is plain data, and reads a path the same way wherever it is asked to.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from moseg_core.io.files import load
from moseg_core.io.read.limits import ReadLimits
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.shape.up import Up


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How to read a shape.

    Parameters
    ----------
    adjacency : {"auto", "knn", "none"}
        Which elements touch: what the shape knows of it, the nearest as well, or none.
    volume : str or None
        How the enclosed volume is estimated: a number, "hull" or "winding"; None for not at all.
    weld : float or None
        How far vertices of a mesh may lie apart and still be joined, as a share of the bounding
        box's diagonal; None for the default.
    voxels : {"solid", "surface"}
        Which cells of a voxel grid are elements.
    pitch : tuple of float or None
        Three sides of the cells of a voxel grid whose file does not know them.
    up : str or None
        Which axis points up: "x", "-x", "y", "-y", "z" or "-z".
    limit : tuple of str
        How much a file may become: "cells=2e7", "cells=none" or "none", as
        :meth:`moseg_core.ReadLimits.read` takes them.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> moseg.Reading(up="z").read(moseg.sample_path("hammer")).n_elements > 5000
    True
    """

    adjacency: str = "auto"
    volume: str | None = None
    weld: float | None = None
    voxels: str = "solid"
    pitch: tuple[float, ...] | None = None
    up: Up | None = None
    limit: tuple[str, ...] = ()

    def read(self, path: str | Path) -> Shape:
        """The shape in a file.

        Raises
        ------
        ShapeError
            The file cannot be read, or its volume not be estimated; a pitch is given for what is
            no voxel grid.
        UsageError
            No reader for the suffix, or a value that makes no sense.
        """
        shape = load(path, limits=ReadLimits.read(self.limit))
        if self.weld is not None and isinstance(shape.geometry, PolygonMesh):
            shape = shape.with_weld(self.weld)
        if self.voxels == "surface" and shape.solid:
            shape = shape.with_elements("surface")
        if self.pitch is not None:
            shape = shape.with_pitch(list(self.pitch))
        if self.up is not None:
            shape = shape.with_up(self.up)
        shape = shape.with_adjacency(self.adjacency)
        return shape if self.volume is None else shape.with_volume(self.volume)

    def document(self) -> dict[str, Any]:
        """The same as plain data, what is as by default left out.

        Examples
        --------
        >>> Reading(up="z", pitch=(1, 1, 3)).document()
        {'pitch': [1, 1, 3], 'up': 'z'}
        """
        plain = {field.name: getattr(self, field.name) for field in fields(self)}
        if plain["pitch"] is not None:
            plain["pitch"] = list(plain["pitch"])
        changed = {key: value for key, value in plain.items() if value != getattr(Reading(), key)}
        return changed | ({"limit": list(self.limit)} if self.limit else {})

    @classmethod
    def of(cls, document: dict[str, Any]) -> Reading:
        """Inverse of :meth:`document`."""
        pitch = document.get("pitch")
        limit = tuple(document.get("limit", ()))
        pitch = None if pitch is None else tuple(pitch)
        return cls(**{**document, "pitch": pitch, "limit": limit})
