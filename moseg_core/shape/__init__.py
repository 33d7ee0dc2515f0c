"""What is cut: surfaces as they were read, their elements, neighbours and moments (Sec. 4).

A :class:`~moseg_core.shape.shape.Shape` is a geometry (:mod:`~moseg_core.shape.geometry`, of which
:mod:`~moseg_core.shape.mesh`, :mod:`~moseg_core.shape.cloud` and :mod:`~moseg_core.shape.voxels`
are kinds; polygons are cut up by :mod:`~moseg_core.shape.triangulate`) with what follows from it
(:mod:`~moseg_core.shape.data`), each computed once: exact moments
(:mod:`~moseg_core.shape.moments`), :mod:`~moseg_core.shape.adjacency`, and the volume where there
is one (:mod:`moseg_core.shape.volume`).

A labelling is summed up part by part in :mod:`~moseg_core.shape.part_sums`; labels are checked in
:mod:`~moseg_core.shape.labels`, some may be :mod:`~moseg_core.shape.pins`. A part becomes a shape
of its own in :mod:`~moseg_core.shape.subshape`. :mod:`~moseg_core.shape.coarse` is the same shape
in about 2000 super-elements, to search on, which :mod:`~moseg_core.shape.grow` makes with the queue
of :mod:`~moseg_core.shape.heap`; :mod:`~moseg_core.shape.hull_corners` says which of their vertices
matter to hulls. :mod:`~moseg_core.shape.compiled` is how all kernels are compiled.
"""
