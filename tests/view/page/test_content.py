"""What a page shows of a result."""

from __future__ import annotations

import numpy as np

from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.view.page.content import PageContent, middle_places
from tests.results import result_on


def test_a_result_is_shown_with_its_cost_and_warnings(box):
    result = result_on(box, warnings=("a part is in 2 pieces",))
    content = PageContent.of_result(result)
    assert content.evaluation is result.evaluation
    assert content.warnings == ("a part is in 2 pieces",)
    assert content.names == ("first", "second")


def test_centres_to_begin_with_are_on_the_surface_of_their_parts(box):
    """Those that the search found have weights, and may lie anywhere."""
    result = result_on(box)
    centers = PageContent.of_result(result).centers
    distances = np.linalg.norm(box.points[:, None] - centers, axis=2)
    np.testing.assert_allclose(distances.min(axis=0), 0.0, atol=1e-12)
    assert result.labels[distances.argmin(axis=0)].tolist() == [0, 1]


def test_the_middle_is_by_area(row):
    labels = np.array([0, 0, 0, 0, 0, -1])
    assert middle_places(row, labels, 2)[0].tolist() == [2.5, 0.5, 0.0]
    assert np.isnan(middle_places(row, labels, 2)[1]).all()


def test_no_centres_are_placed_on_several_levels(box):
    result = result_on(box)
    levels = Hierarchy(result.problem)
    assert PageContent.of_result(result_on(box, problem=levels)).centers is None
