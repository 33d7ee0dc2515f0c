"""Pictures of segmentations and of searches, made without a screen, a GPU or a graphics library.

A segmentation: :mod:`~moseg_core.view.picture` puts it together. The shape is stood upright by
:mod:`~moseg_core.view.upright`, made of triangles or small bodies of points
(:mod:`~moseg_core.view.point_bodies`), smoothed by :mod:`~moseg_core.view.normals`, coloured by
:mod:`~moseg_core.view.palette`, seen from the sides of :mod:`~moseg_core.view.views` by the cameras
of :mod:`~moseg_core.view.camera`, drawn by the z-buffer of :mod:`~moseg_core.view.raster` in the
light of :mod:`~moseg_core.view.shading`, beside the words of :mod:`~moseg_core.view.legend`.

A search: :mod:`~moseg_core.view.convergence` reads its history, :mod:`~moseg_core.view.chart` lays
out curves over :mod:`~moseg_core.view.axis`, as a :mod:`~moseg_core.view.scene` of lines and words
that :mod:`~moseg_core.view.svg` and :mod:`~moseg_core.view.png` write down.
:mod:`~moseg_core.view.writer` offers both as formats.
"""
