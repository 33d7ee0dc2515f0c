"""What a run is asked for is checked before any work begins."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.protocols import Centers
from moseg_core.errors import ShapeError, UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import Method, SearchOptions
from moseg_core.search.request import Request, check_frozen, prepare_components
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5))
PROBLEM = Problem(["stem", "bar"], "narrow(stem)")


def test_a_request_has_all_that_a_run_needs():
    start = Centers(positions=SHAPE.points[:2], weights=np.ones(2))
    request = Request.of(
        SHAPE, PROBLEM, SearchOptions(seeder="kmeans"), start=start, freeze=["bar"], pins={"bar": 3}
    )
    assert request.ready["seeder"].component.id == "core:kmeans"
    assert request.whole.shape is SHAPE
    assert request.whole.pins.elements.tolist() == [3]
    assert request.start.positions.tolist() == start.positions.tolist()
    assert list(request.frozen) == [1]
    assert list(request.warnings) == []
    assert request.exchanges
    assert not Request.of(SHAPE, PROBLEM, SearchOptions(settings="paper")).exchanges


@pytest.mark.parametrize(
    ("problem", "more", "message"),
    [
        (Hierarchy(PROBLEM), {}, "give a Hierarchy to segment_hierarchy"),
        ("hammer", {}, "segment takes a Problem, not 'hammer'"),
        (PROBLEM, {"freeze": ["bra"]}, "freeze: unknown label 'bra'; did you mean 'bar'"),
        (PROBLEM, {"pins": {"stemm": [1]}}, "unknown label 'stemm'; did you mean 'stem'"),
        (PROBLEM, {"start": "somewhere"}, "the start must be Centers"),
        (PROBLEM, {"defaults": "kmeans"}, "defaults"),
    ],
)
def test_what_is_wrong_with_it_is_told(problem, more, message):
    with pytest.raises(UsageError, match=message):
        Request.of(SHAPE, problem, SearchOptions(), **more)


def test_a_shape_that_lacks_what_a_term_needs_is_refused():
    touching = Problem(["a", "b"], "touching(a, b)")
    with pytest.raises(ShapeError, match="touching"):
        Request.of(Shape.from_points(SHAPE.points), touching, SearchOptions())


def test_labels_to_freeze_are_a_list():
    assert check_frozen(PROBLEM, ["bar", "stem"]) == [1, 0]
    with pytest.raises(UsageError, match="freeze must be a list of labels, not the text 'bar'"):
        check_frozen(PROBLEM, "bar")


def test_components_are_tuned_to_the_settings_and_a_refiner_is_there_where_asked_for():
    default, paper = (
        prepare_components(PROBLEM, SearchOptions(seeder="evolution", settings=name).settled())
        for name in ("default", "paper")
    )
    assert default["seeder"].parameters == {"population": 20, "iterations": 6}
    assert paper["seeder"].parameters == {}
    assert "refiner" not in default
    asked = SearchOptions().settled(Method(refiner="graph_cut(band=0.2)"))
    assert prepare_components(PROBLEM, asked)["refiner"].parameters == {"band": 0.2}
