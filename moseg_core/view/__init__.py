"""Pictures of segmentations and of searches, made without a screen, a GPU or a graphics library.

A segmentation: :mod:`~moseg_core.view.picture` puts it together, from where
:mod:`~moseg_core.view.camera` looks, with triangles or small bodies of points
(:mod:`~moseg_core.view.point_bodies`), shaded by :mod:`~moseg_core.view.normals`, coloured by
:mod:`~moseg_core.view.palette`, drawn by the z-buffer of :mod:`~moseg_core.view.raster`, with the
words of :mod:`~moseg_core.view.legend`. A search: :mod:`~moseg_core.view.convergence` reads its
history, :mod:`~moseg_core.view.chart` lays out curves over :mod:`~moseg_core.view.axis`, as a
:mod:`~moseg_core.view.scene` of lines and words that :mod:`~moseg_core.view.svg` and
:mod:`~moseg_core.view.png` write down. :mod:`~moseg_core.view.writer` offers both as formats.
"""
