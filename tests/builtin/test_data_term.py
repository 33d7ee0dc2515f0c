"""What elements cost under each label, against sums over the terms one by one."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.builtin.data_term import PlaceTerm, place_costs, place_terms
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.errors import PluginError, UsageError
from moseg_core.problem.problem import Problem
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.builtin.along import area, far, registry_with_along

LABELS = ["body", "leg1", "leg2", "tail"]


@objective(mean_of=lambda given: None)
def perhaps(part: Part) -> float:
    return part.area


@objective()
def apart(first: Part, second: Part) -> float:
    return float(np.linalg.norm(first.centroid - second.centroid))


@pytest.fixture
def source(monkeypatch):
    return registry_with_along(monkeypatch)


def problem(minimize, source, **more):
    own = {"far": far, "perhaps": perhaps, "area": area, "apart": apart, **more}
    return Problem(LABELS, minimize, objectives=own, registry=source)


def test_the_terms_that_speak_of_places(source):
    asked = problem(
        "3*far(leg*, axis=1) + area(*) - 0.5*far(tail, axis=2, times=4) + apart(body, tail)"
        " + perhaps(body)",
        source,
    )
    assert place_terms(asked) == (
        PlaceTerm(3.0, (1, 2), "made:along", {"axis": 1}),
        PlaceTerm(-0.5, (3,), "made:along", {"axis": 2, "times": 4.0}),
    )


def test_costs_are_sums_of_weighted_fields(source):
    shape = Shape.from_mesh(*shapes.sphere(2))
    asked = problem(
        "3*far(leg*, axis=1) - 0.5*far(tail, axis=2, times=4) + 2*far(leg2, axis=0)"
        " + area(body) + far(body, axis=0)",
        source,
    )
    elements = np.array([5, 2, 90])
    found = place_costs(asked, shape, elements)
    for k, element in enumerate(elements):
        x, y, z = shape.points[element]
        assert found[k] == pytest.approx([x, 3 * y, 3 * y + 2 * x, -0.5 * 4 * z])


def test_a_label_of_which_nothing_is_said_costs_what_the_others_do_in_the_mean(source):
    shape = Shape.from_mesh(*shapes.sphere(2))
    elements = np.arange(7)
    x, y, _ = shape.points[:7].T
    found = place_costs(problem("far(leg*, axis=0) + far(tail, axis=1)", source), shape, elements)
    assert np.allclose(found.T, [(x + x + y) / 3, x, x, y], rtol=0, atol=1e-12)
    # Of one label alone: nothing is said for or against it.
    alone = place_costs(problem("far(tail, axis=1)", source), shape, elements)
    assert np.allclose(alone.T, [y] * 4, rtol=0, atol=1e-12)
    assert (place_costs(problem("area(*)", source), shape, elements) == np.zeros((7, 4))).all()


def test_super_elements_cost_the_mean_of_their_members(source):
    shape = Shape.from_mesh(*shapes.sphere(4))
    coarse = coarsen(shape, 60)
    asked = problem("far(leg*, axis=0) + far(tail, axis=1) + far(body, axis=2)", source)
    fine = place_costs(asked, shape, np.arange(shape.n_elements))
    for k in (0, 3, 11):
        own = coarse.members == k
        mean = np.average(fine[own], axis=0, weights=shape.areas[own])
        assert place_costs(asked, coarse, np.array([k]))[0] == pytest.approx(mean)


def test_what_goes_wrong_is_told_with_the_name_of_the_term(source):
    def confused(given):
        raise KeyError("axis")

    lost = objective(mean_of=confused)(area._function)
    with pytest.raises(PluginError, match=r"'python:lost'.* of which field 'lost\(body\)' is the"):
        place_terms(problem("lost(body)", source, lost=lost))
    unknown = objective(mean_of=lambda given: ("made:alogn", {}))(area._function)
    asked = problem("unknown(body)", source, unknown=unknown)
    with pytest.raises(UsageError, match="'made:alogn'; did you mean 'made:along'"):
        place_costs(asked, Shape.from_mesh(*shapes.sphere(1)), np.arange(2))
