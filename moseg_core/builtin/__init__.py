"""The core's own components, offered by :mod:`~moseg_core.builtin.plugin` as anybody's bundle is.

The parameterization :mod:`~moseg_core.builtin.voronoi` (Sec. 4) over the kernel of Algorithm 1,
:mod:`~moseg_core.builtin.flood`. Seeders (Sec. 5): :mod:`~moseg_core.builtin.kmeans`, which begins
at the farthest pair of :mod:`~moseg_core.builtin.diameter`, :mod:`~moseg_core.builtin.evolution`,
and centres by hand, :mod:`~moseg_core.builtin.given`. Labelers (Sec. 6):
:mod:`~moseg_core.builtin.hungarian`, :mod:`~moseg_core.builtin.greedy`,
:mod:`~moseg_core.builtin.exhaustive`. The optimizer (Sec. 7):
:mod:`~moseg_core.builtin.pattern_search`. The refiner, which the paper has none of:
:mod:`~moseg_core.builtin.graph_cut`, by the minimum cuts of :mod:`~moseg_core.builtin.swaps` in the
:mod:`~moseg_core.builtin.band` around boundaries.
"""
