"""All measures of one pair of labellings at once.

A shape is compared with many: the benchmark has a dozen people's segmentations of each model, and
a result's score is its mean over them. So what belongs to the surface, the graph of its edges, is
made once and handed in, and the tables of overlaps, by faces and by area, are made once a pair.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from moseg_core.agreement.consistency import consistency_errors_of
from moseg_core.agreement.cut import EdgeGraph, cut_discrepancy
from moseg_core.agreement.hamming import hamming_distance_of
from moseg_core.agreement.names import named_right
from moseg_core.agreement.overlap import overlap
from moseg_core.agreement.rand import rand_index_error_of
from moseg_core.types import FloatArray, IntArray


@dataclass(frozen=True, kw_only=True)
class Agreement:
    """How far a found labelling is from a true one; 0 is best but for `named_right`.

    Parameters
    ----------
    rand_index_error, rand_index_error_by_area : float
        1 - Rand Index, 0 to 1; pairs of faces, or of pieces of area.
    cut_discrepancy : float or None
        Mean distance between the cuts over the mean radius, at least 0; None where undefined.
    hamming, missing, false_alarm : float
        Hamming distance by area, the mean of the two rates that follow, 0 to 1.
    global_consistency_error, local_consistency_error : float
        GCE and LCE by faces, 0 to 1.
    global_consistency_error_by_area, local_consistency_error_by_area : float
        The same by area.
    named_right : float or None
        Share of the area under the right name, 0 to 1, where 1 is best; None without names.
    """

    rand_index_error: float
    rand_index_error_by_area: float
    cut_discrepancy: float | None
    hamming: float
    missing: float
    false_alarm: float
    global_consistency_error: float
    global_consistency_error_by_area: float
    local_consistency_error: float
    local_consistency_error_by_area: float
    named_right: float | None


def compare(
    found: IntArray,
    truth: IntArray,
    *,
    areas: FloatArray,
    graph: EdgeGraph | None,
    names: Sequence[str] | None = None,
    truth_names: Sequence[str] | None = None,
    rename: Mapping[str, str] | None = None,
) -> Agreement:
    """Compute every measure of a found labelling against a true one.

    Parameters
    ----------
    found, truth : (F,) int
        Label of each face; those without one, -1, in either are left out.
    areas : (F,) float, model units squared
    graph : EdgeGraph or None
        Of the surface; the same for all pairs on it. None where it has no edges, as a point cloud:
        the cut discrepancy is then undefined.
    names, truth_names : sequence of str, optional
        Names of the labels; without either of them nothing is named right or wrong.
    rename : mapping of str to str, optional
        For names in `names` those to compare with the truth
        (:func:`moseg_core.agreement.names.renamed`).

    Returns
    -------
    Agreement

    Raises
    ------
    UsageError
        Arrays of different lengths, no face with a label in both, or a translation of a name that
        is none of `names`.

    Examples
    --------
    Two triangles of a square, held together or cut apart:

    >>> import numpy as np
    >>> square = EdgeGraph(positions=np.array([[0., 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]),
    ...                    ends=np.array([[0, 1], [1, 2], [2, 0], [1, 3], [3, 2], [2, 1]]),
    ...                    face=np.array([0, 0, 0, 1, 1, 1]), radius=0.24)
    >>> e = compare(np.array([0, 0]), np.array([0, 1]), areas=np.array([0.5, 0.5]), graph=square)
    >>> e.rand_index_error, e.missing, e.false_alarm, e.cut_discrepancy
    (1.0, 0.0, 0.5, None)
    """
    by_faces, by_area = overlap(found, truth), overlap(found, truth, areas)
    hamming = hamming_distance_of(by_area)
    consistency, consistency_by_area = map(consistency_errors_of, (by_faces, by_area))
    named = None
    if names is not None and truth_names is not None:
        named = named_right(found, names, truth, truth_names, areas, rename=rename)
    return Agreement(
        rand_index_error=rand_index_error_of(by_faces),
        rand_index_error_by_area=rand_index_error_of(by_area),
        cut_discrepancy=None if graph is None else cut_discrepancy(graph, found, truth),
        hamming=hamming.distance,
        missing=hamming.missing,
        false_alarm=hamming.false_alarm,
        global_consistency_error=consistency.global_error,
        global_consistency_error_by_area=consistency_by_area.global_error,
        local_consistency_error=consistency.local_error,
        local_consistency_error_by_area=consistency_by_area.local_error,
        named_right=named,
    )
