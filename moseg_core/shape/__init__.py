"""What is cut: surfaces as they were read, their elements, neighbours and moments (Sec. 4).

A :class:`~moseg_core.shape.shape.Shape` is a geometry (:mod:`~moseg_core.shape.mesh`,
:mod:`~moseg_core.shape.cloud`, :mod:`~moseg_core.shape.voxels`) with what follows from it, each
computed once: exact moments, adjacency, and the volume where there is one
(:mod:`moseg_core.shape.volume`). :mod:`~moseg_core.shape.coarse` is the same shape in about 2000
super-elements, to search on.
"""
