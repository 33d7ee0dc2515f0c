"""Shapes under articulation for moseg: geodesic distances and their 3-D embedding (Sec. 9).

:mod:`~moseg_mds.embedding` is the component. On the :mod:`~moseg_mds.surface`, welded and in one
piece, :mod:`~moseg_mds.landmarks` are spread and their distances measured
(:mod:`~moseg_mds.geodesics`, or :mod:`~moseg_mds.paths` where these fail);
:mod:`~moseg_mds.scaling` places them, :mod:`~moseg_mds.majorize` improves the places, and
:mod:`~moseg_mds.carry` takes the rest of the surface along. :mod:`~moseg_mds.command` is
``moseg embed``.
"""
