"""All measures at once are the measures one by one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core import agreement
from moseg_core.errors import UsageError
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(3, 3), 1, 0.2))
MESH = SHAPE.geometry
GRAPH = agreement.EdgeGraph.joined(
    MESH.vertices, MESH.merged, *MESH.edges, centroids=SHAPE.points, areas=SHAPE.areas
)


@given(st.integers(0, 2**32), st.integers(1, 6), st.integers(1, 6))
@settings(max_examples=40)
def test_each_number_is_that_of_its_own_measure(seed, kinds, others):
    rng = np.random.default_rng(seed)
    found, truth = (rng.integers(0, k, SHAPE.n_elements) for k in (kinds, others))
    areas = SHAPE.areas
    names, true_names = list("abcdef"), list("fedcba")
    told = agreement.compare(
        found,
        truth,
        areas=areas,
        graph=GRAPH,
        names=names,
        truth_names=true_names,
        rename={"a": "f"},
    )
    hamming = agreement.hamming_distance(found, truth, areas)
    by_faces = agreement.consistency_errors(found, truth)
    by_area = agreement.consistency_errors(found, truth, areas)
    assert told == agreement.Agreement(
        rand_index_error=agreement.rand_index_error(found, truth),
        rand_index_error_by_area=agreement.rand_index_error(found, truth, areas),
        cut_discrepancy=agreement.cut_discrepancy(GRAPH, found, truth),
        hamming=hamming.distance,
        missing=hamming.missing,
        false_alarm=hamming.false_alarm,
        global_consistency_error=by_faces.global_error,
        global_consistency_error_by_area=by_area.global_error,
        local_consistency_error=by_faces.local_error,
        local_consistency_error_by_area=by_area.local_error,
        named_right=agreement.named_right(
            found, names, truth, true_names, areas, rename={"a": "f"}
        ),
    )


@pytest.mark.parametrize("known", [{}, {"names": ["a"]}, {"truth_names": ["a"]}], ids=str)
def test_without_names_on_both_sides_nothing_is_named_right_or_wrong(known):
    same = np.zeros(SHAPE.n_elements, int)
    assert (
        agreement.compare(same, same, areas=SHAPE.areas, graph=GRAPH, **known).named_right is None
    )


def test_faces_without_a_label_are_left_out_of_all_measures():
    truth = (SHAPE.points[:, 0] > 0).astype(int)
    found = np.where(np.arange(SHAPE.n_elements) % 5 == 0, -1, truth)
    names = ["a", "b"]
    told = agreement.compare(
        found, truth, areas=SHAPE.areas, graph=GRAPH, names=names, truth_names=names
    )
    assert told.named_right == 1.0
    assert told.rand_index_error == told.hamming == told.cut_discrepancy == 0.0
    with pytest.raises(UsageError, match="nothing has a label in both"):
        agreement.compare(np.full_like(truth, -1), truth, areas=SHAPE.areas, graph=GRAPH)


def test_a_translation_of_no_name_is_refused():
    same = np.zeros(SHAPE.n_elements, int)
    with pytest.raises(UsageError, match="unknown label to rename 'b'"):
        agreement.compare(
            same,
            same,
            areas=SHAPE.areas,
            graph=GRAPH,
            names=["a"],
            truth_names=["a"],
            rename={"b": "a"},
        )
