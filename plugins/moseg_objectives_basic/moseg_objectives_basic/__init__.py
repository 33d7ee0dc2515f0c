"""moseg's basic objectives: the paper's, and words for what people go by.

What the paper defines in Section 10 or names in Section 3:

One part: :mod:`~moseg_objectives_basic.proportions` (narrow, flat, compact),
:mod:`~moseg_objectives_basic.symmetry` (planar, axial, rotational),
:mod:`~moseg_objectives_basic.ellipsoid`, :mod:`~moseg_objectives_basic.convexity` (convex, and
convex_parts of them all), :mod:`~moseg_objectives_basic.area`. Several:
:mod:`~moseg_objectives_basic.axes` (perpendicular, parallel, coaxial) and
:mod:`~moseg_objectives_basic.similarity`. Symmetry and ellipsoids are surface distances,
:mod:`~moseg_objectives_basic.surface_distance`, on large meshes to the coarser target of
:mod:`~moseg_objectives_basic.thinned`, by :mod:`~moseg_objectives_basic.surface_tree`; hulls are
those of :mod:`~moseg_objectives_basic.hulls`.

The words: :mod:`~moseg_objectives_basic.likeness` (is), :mod:`~moseg_objectives_basic.girth` (thin,
thick, even_thickness), :mod:`~moseg_objectives_basic.middle` (central, remote),
:mod:`~moseg_objectives_basic.size` (small, large), :mod:`~moseg_objectives_basic.seams` (short and
creased boundaries), :mod:`~moseg_objectives_basic.neighbours` (touching, apart),
:mod:`~moseg_objectives_basic.order` (above). They are made of
:mod:`~moseg_objectives_basic.fields`, numbers that every element has.
"""
