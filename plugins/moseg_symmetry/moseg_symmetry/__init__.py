"""Symmetry for moseg: planes and axes of a shape, mirrored centres, centres on a plane (Sec. 8).

:mod:`~moseg_symmetry.constraints` has ``mirror`` and ``on_plane``. Their plane is the one that the
user writes (:mod:`~moseg_symmetry.planes`) or one found on the shape
(:mod:`~moseg_symmetry.plane_of`): :mod:`~moseg_symmetry.plane_detection` and
:mod:`~moseg_symmetry.axis_detection` judge many :mod:`~moseg_symmetry.motions` of the
:mod:`~moseg_symmetry.surface` and improve the best (:mod:`~moseg_symmetry.refine`).
:mod:`~moseg_symmetry.command` is ``moseg symmetry``.
"""
