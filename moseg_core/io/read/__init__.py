"""Readers: a file to a :class:`~moseg_core.shape.shape.Shape`, and what several of them share.

OFF, OBJ, STL and PLY have a module each (:mod:`~moseg_core.io.read.ply_header` and
:mod:`~moseg_core.io.read.ply_elements` for the parts of a PLY file), GLB has
:mod:`~moseg_core.io.read.glb_scene` over :mod:`~moseg_core.io.read.glb_container`. Point clouds as
text, XYZ and CSV, are in :mod:`~moseg_core.io.read.clouds`, voxels, NPY and BINVOX, in
:mod:`~moseg_core.io.read.grids`. :mod:`~moseg_core.io.read.text_rows` reads rows of numbers,
:mod:`~moseg_core.io.read.checked` checks what was read.
"""
