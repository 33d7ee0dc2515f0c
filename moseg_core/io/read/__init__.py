"""Readers: a file to a :class:`~moseg_core.shape.shape.Shape`, and what several of them share.

OFF, OBJ, STL and PLY have a module each (:mod:`~moseg_core.io.read.ply_header` and
:mod:`~moseg_core.io.read.ply_elements` for the parts of a PLY file), glTF has
:mod:`~moseg_core.io.read.glb_scene` over :mod:`~moseg_core.io.read.glb_container`, with
:mod:`~moseg_core.io.read.gltf_buffers` for what lies outside of it. Point clouds as text are in
:mod:`~moseg_core.io.read.clouds`, over :mod:`~moseg_core.io.read.point_rows` and
:mod:`~moseg_core.io.read.point_columns`, voxels, NPY and BINVOX, in
:mod:`~moseg_core.io.read.grids`. :mod:`~moseg_core.io.read.text_rows` reads rows of numbers,
:mod:`~moseg_core.io.read.checked` checks what was read.
"""
