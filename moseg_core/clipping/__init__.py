"""Smooth boundaries: where to cut a mesh between its parts, and the cutting (Sec. 4, Fig. 2).

:mod:`~moseg_core.clipping.clip` cuts a labelled mesh; :mod:`~moseg_core.clipping.net` says which
edges are cut and where, :mod:`~moseg_core.clipping.pieces` divides the faces between their
corners. What they ask of the partition is in :mod:`~moseg_core.clipping.boundaries`;
:mod:`~moseg_core.clipping.bisector` is the geometry of weighted centres. Nothing here knows of a
result: that is :mod:`moseg_core.search.clipped_result`.
"""
