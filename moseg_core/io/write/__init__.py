"""Writers: a result to the bytes of a file.

:mod:`~moseg_core.io.write.formats` has a function for each format, over the encoders of
:mod:`~moseg_core.io.write.ply`, :mod:`~moseg_core.io.write.glb` and
:mod:`~moseg_core.io.write.arrays`. JSON is written where it is read,
:mod:`moseg_core.io.result_json`; pictures are drawn by :mod:`moseg_core.view.writer`.
"""
