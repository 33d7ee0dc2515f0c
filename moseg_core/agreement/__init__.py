"""How much two labellings of one shape agree: the measures of the Princeton benchmark, and names.

One idea a file. :mod:`~moseg_core.agreement.overlap` tabulates which part of the one meets which of
the other, and by how much; three of the four measures of Chen, Golovinskiy and Funkhouser, "A
benchmark for 3D mesh segmentation" (2009, doi:10.1145/1531326.1531379), follow from that table:
:mod:`~moseg_core.agreement.rand`, :mod:`~moseg_core.agreement.consistency` and
:mod:`~moseg_core.agreement.hamming`. The fourth, :mod:`~moseg_core.agreement.cut`, compares the
boundaries of the parts and needs the surface. :mod:`~moseg_core.agreement.names` compares what the
parts are called. :mod:`~moseg_core.agreement.compare` computes everything at once.

All but the share named right are errors: 0 is best. Elements without a label, -1, on either side
are left out of all of them.

This package is public, as :mod:`moseg_core` and :mod:`moseg_core.testing` are: bundles may import
what it lists.
"""

from moseg_core.agreement.compare import Agreement, compare
from moseg_core.agreement.consistency import Consistency, consistency_errors
from moseg_core.agreement.cut import EdgeGraph, cut_discrepancy, cut_vertices, mean_radius
from moseg_core.agreement.hamming import Hamming, directional_hamming, hamming_distance
from moseg_core.agreement.names import Confusion, confusion, fold, named_right, renamed
from moseg_core.agreement.overlap import Overlap, labelled, overlap
from moseg_core.agreement.rand import rand_index_error

__all__ = [
    "Agreement",
    "Confusion",
    "Consistency",
    "EdgeGraph",
    "Hamming",
    "Overlap",
    "compare",
    "confusion",
    "consistency_errors",
    "cut_discrepancy",
    "cut_vertices",
    "directional_hamming",
    "fold",
    "hamming_distance",
    "labelled",
    "mean_radius",
    "named_right",
    "overlap",
    "rand_index_error",
    "renamed",
]
