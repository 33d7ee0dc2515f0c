"""Several constraints together: fewer numbers, there and back, roles, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.builtin.evolution import Evolution
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.constraint_function import constraint
from moseg_core.components.protocols import Centers
from moseg_core.errors import PluginError, UsageError
from moseg_core.problem.constraint_calls import bind_constraints
from moseg_core.problem.constraints import Constraints
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.reflections import FLIP, known

#: A bar with a leg at either end, and its plane of symmetry x = 0.
CELLS = [(x, 0, 0) for x in range(-4, 5)] + [(x, -y, 0) for x in (-4, 4) for y in (1, 2, 3)]
TABLE = Shape.from_mesh(*shapes.solid([(x + 4, y + 4, z) for x, y, z in CELLS]), name="table")
DOG = ("head", "body", "leg1", "leg2", "leg3", "leg4")
BULLDOG = ["onplane(head, body)", "mirror(leg2, leg1)", "mirror(leg4, leg3)"]

RULES = {
    "none": [],
    "bulldog": BULLDOG,
    "dove": ["onplane(head, body)", "mirror(leg2, leg1)"],
    "chain": ["upside(leg3, leg2)", "mirror(leg2, leg1)", "onplane(head)"],
    "between": ["between(leg3, leg1, leg2)", "mirror(leg2, leg1)"],
    "function": ["pair(leg1, leg2)", "onplane(body)"],
}


def constraints(rules, names=DOG, shape=TABLE):
    found = bind_constraints(rules, names, known(), None)
    return Constraints(found, Voronoi(shape, len(names)), shape, names)


def vectors(seed, n=6, count=5):
    rng = np.random.default_rng(seed)
    rows = rng.uniform(-0.5, 0.5, (count, n, 4))
    rows[:, :, 3] = rng.uniform(0.2, 3.0, (count, n))
    return rows.reshape(count, -1)


@pytest.mark.parametrize(
    ("name", "free"),
    [("none", 24), ("bulldog", 14), ("dove", 18), ("between", 16), ("function", 19)],
)
def test_the_dimension_drops(name, free):
    found = constraints(RULES[name])
    assert (found.n_free, found.n_all) == (free, 24)
    for bound in (found.lower, found.upper, found.scale):
        assert bound.shape == (free,)


def test_the_doves_sixteen_are_ten():
    names = ("body", "wing1", "wing2", "tail")
    assert constraints(["onplane(body, tail)", "mirror(wing2, wing1)"], names).n_free == 10


@pytest.mark.parametrize("name", RULES)
@given(seed=st.integers(0, 10_000))
def test_reduce_undoes_expand(name, seed):
    found = constraints(RULES[name])
    whole = vectors(seed, count=1)[0]
    free = found.reduce(whole)
    back = found.expand(free[None])
    assert found.reduce(back[0]) == pytest.approx(free, abs=1e-7)
    # Feasible vectors stay as they are.
    assert found.expand(found.reduce(back[0])[None]) == pytest.approx(back, abs=1e-7)
    assert found.completed(back[0]) == pytest.approx(back[0], abs=1e-7)


def test_without_constraints_nothing_is_touched():
    found = constraints([])
    some = vectors(0)
    assert found.expand(some) is some
    assert found.reduce(some[0]).tobytes() == some[0].tobytes()
    assert not found.active


@given(seed=st.integers(0, 10_000))
def test_a_chain_is_expanded_in_its_order_however_written(seed):
    rows = (
        constraints(RULES["chain"])
        .expand(constraints(RULES["chain"]).reduce(vectors(seed)[0])[None])
        .reshape(6, 4)
    )
    assert rows[3] == pytest.approx(FLIP * rows[2], abs=1e-12)
    assert rows[4] == pytest.approx(rows[3] * [1, -1, 1, 1], abs=1e-12)
    assert rows[0, 0] == pytest.approx(0.0, abs=1e-12)


@given(seed=st.integers(0, 10_000))
def test_reduce_finds_the_nearest_feasible_centres(seed):
    found = constraints(BULLDOG)
    whole = vectors(seed)[0]
    nearest = found.feasible(whole)
    apart = ((nearest - whole) ** 2).sum()
    rng = np.random.default_rng(seed)
    free = found.reduce(whole)
    for step in rng.normal(scale=0.05, size=(20, found.n_free)):
        other = found.expand((free + step)[None])[0]
        assert ((other - whole) ** 2).sum() >= apart


def test_leaders_are_led_and_others_follow():
    found = constraints(BULLDOG)
    whole = vectors(1)[0].reshape(6, 4)
    completed = found.completed(whole.reshape(-1)).reshape(6, 4)
    assert completed[2] == pytest.approx(whole[2], abs=1e-12)
    assert completed[3] == pytest.approx(FLIP * whole[2], abs=1e-12)
    assert completed[0] == pytest.approx([0, *whole[0, 1:]], abs=1e-12)


def test_groups_and_roles():
    found = constraints([*BULLDOG[:2]]).groups
    assert [group.members for group in found] == [(0,), (1,), (2, 3), (4,), (5,)]
    roles = [group.role for group in found]
    assert roles[0] == roles[1]
    assert roles[3] == roles[4] == ()
    assert len({roles[0], roles[2], roles[3]}) == 3


def test_what_a_function_determines_changes_places_with_nothing():
    found = constraints(["pair(leg1, leg2)"]).groups
    assert len({group.role for group in found}) == 3  # leg1, leg2, and all others


def test_coordinates_of_a_label():
    found = constraints(BULLDOG)
    # Free are leg1 and leg3 as they stand, then three numbers each of head and body.
    assert found.coordinates(2).tolist() == [0, 1, 2, 3]
    assert found.coordinates(3).tolist() == [0, 1, 2, 3]
    assert found.coordinates(4).tolist() == [4, 5, 6, 7]
    assert found.coordinates(1).tolist() == [11, 12, 13]


@pytest.mark.parametrize(
    ("rules", "message"),
    [
        (
            ["mirror(leg2, leg1)", "mirror(leg1, leg2)"],
            r"'mirror\(leg2, leg1\)' and .* go in a circle",
        ),
        (
            ["onplane(leg2)", "mirror(leg2, leg1)"],
            r"label 'leg2' cannot follow both 'onplane\(leg2\)' and 'mirror\(leg2, leg1\)'",
        ),
        (
            ["onplane(leg1)", "mirror(leg2, leg1)"],
            r"put the centres of 'leg1' and 'leg2' in one place",
        ),
        (["mirror(leg2, leg1)", "mirror(leg3, leg1)"], "'leg2' and 'leg3' in one place"),
        (["itself(leg2, leg1)"], "the label 'leg2' would follow itself"),
    ],
)
def test_contradictions_are_refused_by_name(rules, message):
    with pytest.raises(UsageError, match=message):
        constraints(rules)


def test_a_constraint_of_a_wrong_shape_is_named():
    with pytest.raises(PluginError, match=r"constraint 'test:misshapen' of tests 1\.0 returned"):
        constraints(["misshapen(head)"])


def test_a_constraint_that_fails_is_named():
    with pytest.raises(
        PluginError, match=r"'test:failing' of tests 1.0 failed: ZeroDivisionError: by nothing"
    ):
        constraints(["failing(head)"])


def test_a_function_that_is_not_finite_is_named():
    @constraint(start=[0.3, 1.0])
    def holed(free):
        x, w = free
        return [[x, 0, 0, w], [math.nan, 0, 0, w]]

    problem = Problem(LEGS[:2], "narrow(top)", constraints=[holed], registry=known())
    with pytest.raises(
        PluginError, match=r"'python:holed' of the calling program failed: .*finite"
    ):
        segment(TABLE, problem)


def test_of_alike_labels_those_are_paired_that_move_least():
    names = ("leg1", "leg2", "leg3", "leg4")
    found = constraints(["mirror(leg2, leg1)", "mirror(leg4, leg3)"], names)
    # Fore left, hind right, hind left, fore right: leg2 would mirror a hind leg.
    rows = np.array([[-0.1, 0.3, 0], [0.1, -0.3, 0], [-0.1, -0.3, 0], [0.1, 0.3, 0]])
    vector = np.column_stack([rows, np.ones(4)]).reshape(-1)
    order = found.nearest_order(vector, [(0, 1, 2, 3)])
    asked = vector.reshape(4, 4)[order].reshape(-1)
    assert found.feasible(asked) == pytest.approx(asked, abs=1e-12)
    assert found.nearest_order(asked, [(0, 1, 2, 3)]).tolist() == [0, 1, 2, 3]
    # Labels that are not alike stay where they are.
    assert found.nearest_order(vector, [(0,), (1,), (2,), (3,)]).tolist() == [0, 1, 2, 3]


def test_many_alike_labels_are_exchanged_two_by_two():
    names = tuple(f"arm{k}" for k in range(10))
    rules = [f"mirror(arm{k + 1}, arm{k})" for k in range(0, 10, 2)]
    found = constraints(rules, names)
    assert math.factorial(10) > 50_000  # so that not all are tried
    rng = np.random.default_rng(0)
    half = np.column_stack([rng.uniform(0.1, 0.5, (5, 3)), np.ones(5)])
    rows = np.concatenate([half, FLIP * half])[rng.permutation(10)]
    order = found.nearest_order(rows.reshape(-1), [tuple(range(10))])
    asked = rows[order].reshape(-1)
    before = ((found.feasible(rows.reshape(-1)) - rows.reshape(-1)) ** 2).sum()
    assert ((found.feasible(asked) - asked) ** 2).sum() < 0.05 * before


LEGS = ("top", "left", "right")
TEXT = "narrow(top) + 3*narrow(left) + 3*narrow(right) + convex_parts"
SYMMETRIC = ["onplane(top)", "mirror(right, left)"]


def table(**options):
    return Problem(LEGS, TEXT, constraints=SYMMETRIC, registry=known(), **options)


def mirrored(labels):
    """The labels of the mirror images of all faces, left and right exchanged."""
    at = {tuple(np.round(p, 6)): k for k, p in enumerate(TABLE.unit_points)}
    image = [at[tuple(np.round(p * [-1, 1, 1], 6) + 0.0)] for p in TABLE.unit_points]
    return np.array([0, 2, 1])[labels[image]]


@pytest.mark.parametrize("seeder", ["kmeans", "evolution(population=10, iterations=3)"])
def test_a_run_is_symmetric_and_says_its_dimension(seeder):
    found = segment(TABLE, table(), seeder=seeder, seed=1, restarts=1)
    assert found.dimension == (7, 12)
    rows = TABLE.frame.to_unit(found.centers.positions)
    assert rows[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert rows[2] == pytest.approx(rows[1] * [-1, 1, 1], abs=1e-12)
    assert found.centers.weights[1] == pytest.approx(found.centers.weights[2])
    # Faces on the plane are as near to the one as to the other: there a tie decides.
    differ = (mirrored(found.labels) != found.labels) & (abs(TABLE.unit_points[:, 0]) > 1e-9)
    assert TABLE.areas[differ].sum() <= 0.005 * TABLE.area
    assert found.evaluation.empty == ()
    # A poll has 2 * 7 neighbours, not 2 * 12.
    evaluations = [record["evaluations"] for record in found.history["search"]]
    assert max(np.diff(evaluations)) == 14


def test_the_result_says_where_constraints_come_from():
    found = segment(TABLE, table(), optimizer="pattern_search(max_evaluations=5)")
    assert found.versions["test:mirror"] == "tests 1.0"


def test_evolution_keeps_roles_and_feasibility():
    problem = table()
    evaluator = ProblemEvaluator(TABLE, problem, Voronoi(TABLE, 3))
    seeding = Evolution(population=6, iterations=4)(
        evaluator, rng=np.random.default_rng(0), report=lambda progress: False
    )
    rows = TABLE.frame.to_unit(seeding.centers)
    assert rows[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert rows[2] == pytest.approx(rows[1] * [-1, 1, 1], abs=1e-12)
    vector = evaluator.parameterization.encode(
        Centers(positions=seeding.centers, weights=np.ones(3))
    )
    assert evaluator.evaluate(vector).cost.value == seeding.history[-1]["best"]


@pytest.mark.parametrize("first", ["legs", "tops"])
def test_groups_are_assigned_as_a_whole(first):
    names = ("a1", "a2", "b1", "b2")
    problem = Problem(
        names,
        "narrow(a1) + narrow(a2) + compact(b1) + compact(b2)",
        constraints=["mirror(a2, a1)", "mirror(b2, b1)"],
        registry=known(),
    )
    evaluator = ProblemEvaluator(TABLE, problem, Voronoi(TABLE, 4))
    legs, tops = [[4, -2.5, 0.5], [-4, -2.5, 0.5]], [[1, 0.5, 0.5], [-1, 0.5, 0.5]]
    both = np.array([*legs, *tops] if first == "legs" else [*tops, *legs], float)
    at = Centers(positions=both + np.array([4.5, 4, 0]), weights=np.ones(4))
    vector = evaluator.parameterization.encode(at)
    ((order, cost),) = evaluator.labelled_costs(vector[None])
    parts = evaluator.labels(vector)
    # Two pairs can only stay or change places, each in its order.
    orders = [[0, 1, 2, 3], [2, 3, 0, 1]]
    values = [evaluator.evaluate_labels(np.argsort(o).astype(np.int32)[parts]).cost for o in orders]
    assert order.tolist() == orders[values.index(min(values))]
    assert cost == min(values)


def test_frozen_labels_hold_what_they_follow():
    begin = segment(TABLE, table(), optimizer="pattern_search(max_evaluations=1)")
    found = segment(TABLE, table(), start=begin, freeze=["right"])
    assert found.centers.positions[1:] == pytest.approx(begin.centers.positions[1:], abs=1e-9)
    evaluations = [record["evaluations"] for record in found.history["search"]]
    assert max(np.diff(evaluations)) == 6  # the three numbers of the top


def test_a_function_from_python_leads_the_search():
    @constraint(start=[0.0, 1.0, 0.3, 0.0, 0.0, 1.0])
    def symmetric(free):
        y, w, *leg = free
        return [[0, y, 0, w], leg, FLIP * np.array(leg)]

    problem = Problem(LEGS, TEXT, constraints=[symmetric], registry=known())
    found = segment(TABLE, problem, seed=0)
    assert found.dimension == (6, 12)
    rows = TABLE.frame.to_unit(found.centers.positions)
    assert rows[2] == pytest.approx(rows[1] * [-1, 1, 1], abs=1e-12)
    assert found.evaluation.cost.empty == 0


def test_weights_that_a_function_makes_negative_are_never_taken():
    @constraint(start=[0.3, 1.0])
    def shrinking(free):
        x, w = free
        return [[0, 0, 0, 1], [-x, 0, 0, w - 0.9], [x, 0, 0, w - 0.9]]

    problem = Problem(LEGS, TEXT, constraints=[shrinking], registry=known())
    found = segment(TABLE, problem, seed=0)
    assert (found.centers.weights > 0).all()
    assert math.isfinite(found.cost)


def test_pins_are_kept_under_constraints():
    face = int(np.argmin(TABLE.points[:, 1]))
    found = segment(TABLE, table(), pins={"right": [face]}, seed=0)
    assert LEGS[found.labels[face]] == "right"


@pytest.mark.parametrize("held", ["left", "right"])
def test_a_frozen_leg_stays_and_draws_its_mirror_image_after_it(held):
    begin = segment(TABLE, table(), optimizer="pattern_search(max_evaluations=1)")
    k, other = LEGS.index(held), 3 - LEGS.index(held)
    positions = begin.centers.positions.copy()
    positions[k, 0] *= 0.8
    start = Centers(positions=positions, weights=begin.centers.weights)
    found = segment(TABLE, table(), start=start, freeze=[held])
    rows = TABLE.frame.to_unit(found.centers.positions)
    assert rows[k] == pytest.approx(TABLE.frame.to_unit(positions)[k], abs=1e-9)
    assert rows[other] == pytest.approx(rows[k] * [-1, 1, 1], abs=1e-9)


def test_a_frozen_centre_that_the_constraints_forbid_is_refused():
    begin = segment(TABLE, table(), optimizer="pattern_search(max_evaluations=1)")
    positions = begin.centers.positions + np.array([[0.5, 0, 0], [0, 0, 0], [0, 0, 0]])
    start = Centers(positions=positions, weights=begin.centers.weights)
    with pytest.raises(UsageError, match=r"label 'top' is frozen .* --freeze top"):
        segment(TABLE, table(), start=start, freeze=["top"])


def test_pins_do_not_move_what_a_frozen_label_holds():
    begin = segment(TABLE, table(), optimizer="pattern_search(max_evaluations=1)")
    far = int(np.argmax(TABLE.points[:, 1] - TABLE.points[:, 0]))
    found = segment(TABLE, table(), start=begin, freeze=["left"], pins={"right": [far]})
    assert found.centers.positions[1:] == pytest.approx(begin.centers.positions[1:], abs=1e-9)


def test_without_constraints_what_is_held_stays_to_the_bit():
    found, vector = constraints([]), vectors(0)[0]
    assert found.holding(vector, [1]) is vector


def test_a_label_with_several_centres_is_refused_by_name():
    partition = Voronoi(TABLE, 6, centers="body=3,leg1=2", labels=DOG)
    found = bind_constraints(["onplane(head)", "mirror(leg2, leg1)"], DOG, known(), None)
    with pytest.raises(UsageError, match=r"'mirror\(leg2, leg1\)' is about .* 'leg1' has 2; leave"):
        Constraints(found, partition, TABLE, DOG)
    with pytest.raises(UsageError, match=r"'onplane\(body\)' is about .* 'body' has 3; leave"):
        Constraints(bind_constraints(["onplane(body)"], DOG, known(), None), partition, TABLE, DOG)


def test_constraints_leave_the_centres_of_other_labels_alone():
    partition = Voronoi(TABLE, 6, centers="body=3", labels=DOG)
    found = Constraints(bind_constraints(BULLDOG[1:], DOG, known(), None), partition, TABLE, DOG)
    assert (found.n_free, found.n_all) == (24, 32)
    assert found.coordinates(1).tolist() == [*range(4, 16)]
    vector = vectors(3, n=8, count=1)[0]
    feasible = found.feasible(vector)
    body = partition.coordinates(1)
    assert feasible[body].tolist() == vector[body].tolist()
    leg, image = (feasible[partition.coordinates(k)] for k in (2, 3))
    assert image == pytest.approx([-leg[0], *leg[1:]], abs=1e-12)
    completed = found.completed(vector)
    assert completed[body].tolist() == vector[body].tolist()

    problem = Problem(DOG, "narrow(leg*)", constraints=BULLDOG[1:], registry=known())
    result = segment(
        *(TABLE, problem),
        parameterization='voronoi(centers="body=3")',
        seeder="evolution(population=6, iterations=2)",
        optimizer="pattern_search(max_evaluations=60)",
        restarts=1,
    )
    assert result.dimension == (24, 32)
    assert result.centers.parts.tolist() == [0, 1, 1, 1, 2, 3, 4, 5]
