"""Names that carry over from an earlier result to another shape."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.errors import UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.statement import Statement
from moseg_core.search.alignment import Template, align
from moseg_core.search.levels import segment_hierarchy
from moseg_core.search.segment import segment
from moseg_core.search.variants import segment_variants
from moseg_core.shape.shape import Shape
from tests import shapes

#: A tee with a foot at one end of its bar, so that the bar's ends are two.
MESH = shapes.joined(
    shapes.jitter(shapes.tee(6, 7), 5),
    shapes.moved(shapes.box(1, 1, 2), np.eye(3), 0.6, [3.2, 6.2, 0.9]),
)
SHAPE = Shape.from_mesh(*MESH, name="first")
PROBLEM = Problem(["left", "right", "stem"], "narrow(*) + perpendicular(stem, left)")
QUICK = "pattern_search(threshold=0.05)"


def placed(seed, *, mesh=MESH, scale=3.0):
    turn = shapes.rotation(seed)
    turn = turn * np.sign(np.linalg.det(turn))
    moved = shapes.moved(mesh, turn, scale, [9, -70, 4])
    return Shape.from_mesh(*moved, name="second"), lambda x: scale * x @ turn.T + [9, -70, 4]


@pytest.fixture(scope="module")
def first():
    """Ends of the bar, of which nothing but the place says which is left."""
    x = SHAPE.points[:, 0]
    places = SHAPE.points[[x.argmin(), x.argmax(), SHAPE.points[:, 1].argmin()]]
    start = Centers(positions=places, weights=np.ones(3))
    return segment(SHAPE, PROBLEM, start=start, optimizer=QUICK)


@pytest.mark.parametrize("seed", range(4))
def test_names_stay_with_their_parts_on_a_copy(first, seed):
    second, placing = placed(seed)
    alignment = align(first, second)
    np.testing.assert_allclose(
        alignment.centers.positions,
        placing(first.centers.positions),
        atol=0.01 * second.frame.scale,
    )
    assert alignment.warnings == ()
    found = segment(second, PROBLEM, start=alignment, optimizer=QUICK)
    assert (found.labels == first.labels).mean() > 0.95
    assert found.cost <= first.cost * 1.001


def test_and_on_one_that_is_meshed_anew(first):
    second, placing = placed(2, mesh=shapes.subdivided(shapes.fan(MESH), 3))
    alignment = align(first, second)
    np.testing.assert_allclose(
        alignment.centers.positions,
        placing(first.centers.positions),
        atol=0.03 * second.frame.scale,
    )
    assert alignment.distance < 0.01


def test_a_template_says_all_that_is_needed_and_can_be_sent(first):
    second, _ = placed(1)
    template = Template.of(first)
    again = pickle.loads(pickle.dumps(template))
    assert again.samples.shape == (12000, 3)
    one, other = align(template, second), align(again, second)
    assert one.centers.positions.tolist() == other.centers.positions.tolist()
    assert one.centers.positions.tolist() == align(first, second).centers.positions.tolist()


def test_labels_are_found_by_their_names_in_any_order(first):
    second, _ = placed(3)
    other = Problem(["stem", "right", "left"], "narrow(*) + perpendicular(stem, left)")
    found = segment(second, other, start=align(first, second), optimizer=QUICK)
    assert (np.array([2, 1, 0])[found.labels] == first.labels).mean() > 0.95


def test_of_label_sets_the_one_with_these_labels_is_taken(first):
    second, _ = placed(3)
    statement = Statement(labels=("left", "right", "stem", "foot{0..1}"), minimize="narrow(*)")
    found = segment_variants(second, statement, start=align(first, second), optimizer=QUICK)
    assert found.problem.labels == ("left", "right", "stem")
    whole = Hierarchy(PROBLEM)
    same = segment_hierarchy(second, whole, start=align(first, second), optimizer=QUICK)
    assert same.problem.labels == ("left", "right", "stem")


def test_a_symmetric_shape_is_stated():
    box = Shape.from_mesh(*shapes.box(6, 2, 1), name="box")
    problem = Problem(["one", "other"], "narrow(*)")
    result = segment(box, problem, restarts=1, optimizer=QUICK)
    turned, _ = placed(1, mesh=shapes.box(6, 2, 1))
    alignment = align(result, turned)
    assert alignment.warnings == (
        "'box' can be laid onto 'second' in several ways that are nearly as good; names may have"
        " changed places",
    )
    found = segment(turned, problem, start=alignment, optimizer=QUICK)
    assert alignment.warnings[0] in found.warnings


def test_where_surfaces_fit_in_several_ways_the_problem_decides():
    """A box whose ends differ by nothing but what the problem says of places."""
    box = Shape.from_mesh(*shapes.box(6, 2, 1), name="box")

    @objective(range=(0, 10))
    def rightness(part: Part) -> float:
        return 5.0 - part.centroid[0] / 2.0

    asked = Problem(["right", "left"], "rightness(right)", objectives={"rightness": rightness})
    ends = np.array([[6.0, 1, 0.5], [0.0, 1, 0.5]])
    start = Centers(positions=ends, weights=np.ones(2))
    first = segment(box, asked, start=start, freeze=["right", "left"])
    assert align(first, box).centers.positions[0, 0] == pytest.approx(6.0, abs=0.2)
    # The same surface where "right" lies the other way: distances cannot tell, costs can.
    other = Problem(["left", "right"], "rightness(left)", objectives={"rightness": rightness})
    assert align(first, box, other).centers.positions[0, 0] == pytest.approx(0.0, abs=0.2)


def test_a_shape_of_another_kind_is_stated(first):
    ball = Shape.from_mesh(*shapes.sphere(2), name="ball")
    said = " ".join(align(first, ball).warnings)
    assert "'ball' is unlike 'first': laid onto each other their surfaces are" in said


def test_in_an_embedding_embedded_surfaces_are_laid_onto_each_other():
    rod = Shape.from_mesh(*shapes.bent_capsule(9, 8), name="rod")
    ends = Problem(["one", "two"], "narrow(one)", embedding="mds")
    result = segment(rod, ends, restarts=1, optimizer="pattern_search(max_evaluations=30)")
    copy, _ = placed(2, mesh=shapes.bent_capsule(9, 8))
    alignment = align(result, copy, ends)
    assert alignment.distance < 0.01
    segment(copy, ends, start=alignment, optimizer="pattern_search(max_evaluations=5)")
    with pytest.raises(UsageError, match=r"embedding 'mds', and the problem .* in 'none'"):
        align(Template.of(result), copy)


def test_what_does_not_fit_is_refused_by_name(first):
    second, _ = placed(0)
    other = Problem(["left", "right", "trunk"], "narrow(*)")
    with pytest.raises(UsageError, match="has the labels left, right, stem; the problem has left"):
        segment(second, other, start=align(first, second))
    with pytest.raises(UsageError, match="of several levels"):
        align(replace(first, problem=Hierarchy(PROBLEM)), second)
    with pytest.raises(UsageError, match="a Result is needed"):
        Template.of("first.json")
    with pytest.raises(UsageError, match="align takes a Shape"):
        align(first, "second.off")
