"""Files of closed solids: all parts of a result in one file, each as a solid of its own.

What single files per part may be asked for (:mod:`moseg_core.io.part_files`, ``--close``) a format
for printing wants always: here parts are closed, and handed to the encoder.
"""

from __future__ import annotations

import numpy as np

from moseg_core.io.part_files import part_meshes
from moseg_core.io.write.threemf import Solid, check_solids, encode_3mf
from moseg_core.search.result import Result
from moseg_core.view.palette import part_colors


def write_3mf(result: Result) -> bytes:
    """One object for each part, closed by caps where it was cut out; for printing.

    Raises
    ------
    UsageError
        The shape is a point cloud, which encloses nothing.
    """
    check_solids(result.shape)
    parts = part_meshes(result, close=True)
    colors = part_colors(len(parts))
    solids, shades = [], []
    for part, color in zip(parts, colors, strict=True):
        mesh = part.geometry
        if mesh is not None:
            solids.append(Solid(name=part.label, vertices=mesh.vertices, triangles=mesh.triangles))
            shades.append(color)
    return encode_3mf(solids, np.array(shades), name=result.shape.name)
