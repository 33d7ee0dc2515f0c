"""Weights that are known, the loss by loops, and how sure a table is of what it has not seen."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from moseg_learn import discriminant as module
from moseg_learn.discriminant import ALONE, RIDGE, Sample, fit_looks, fitted, temperature_of
from moseg_learn.looks import CONSTANT, KEYS, MOST, log_probabilities

from moseg_core import Example, Shape, Table, UsageError, field_values

N = len(KEYS)


def lollipop(stick=3.0, head=0.6, turn=0.0):
    """A ball on a stick, and which face is of which."""
    rod = trimesh.creation.cylinder(radius=0.15, height=stick, sections=24)
    rod = trimesh.Trimesh(*trimesh.remesh.subdivide_to_size(rod.vertices, rod.faces, 0.2))
    ball = trimesh.creation.icosphere(subdivisions=3, radius=head)
    ball.apply_translation([0, 0, stick / 2 + 0.8 * head])
    mesh = trimesh.boolean.union([rod, ball], engine="manifold")
    mesh.apply_transform(trimesh.transformations.rotation_matrix(turn, [1, 1, 0]))
    shape = Shape.from_mesh(mesh.vertices, mesh.faces)
    middle = ball.centroid @ trimesh.transformations.rotation_matrix(turn, [1, 1, 0])[:3, :3].T
    away = np.linalg.norm(shape.points - middle, axis=1)
    return Example(shape, (away < head * 1.001).astype(int), ("stick", "head"))


def sample(rng, weights, *, count=400, shift=0.0):
    """Groups of equal areas, whose kinds follow the logistic model exactly."""
    values = rng.normal(size=(count, N)) + shift
    chances = np.exp(log_probabilities(values @ weights.T))
    return Sample(values, chances / count)


@pytest.fixture(scope="module")
def examples():
    return [lollipop(), lollipop(2.6, 0.7, 0.7), lollipop(3.4, 0.5, 2.0)]


def test_weights_that_are_known(monkeypatch):
    """Of kinds of equal areas, without a ridge, the weights that the data were made with."""
    monkeypatch.setattr(module, "RIDGE", np.zeros(N))
    monkeypatch.setattr(module, "_STEPS", 5000)
    rng = np.random.default_rng(1)
    weights = np.zeros((2, N))
    weights[0, :3], weights[1, :3] = (1.0, -0.5, 0.25), (-1.0, 0.5, -0.25)
    values = rng.normal(size=(4000, N))
    values = np.concatenate([values, -values])  # so that the kinds have equal areas
    chances = np.exp(log_probabilities(values @ weights.T))
    found, constants = fitted([Sample(values, chances / len(values))])
    assert found == pytest.approx(weights, abs=0.02)
    assert constants == pytest.approx(0, abs=0.01)


def test_units_of_the_quantities_change_no_probability():
    rng = np.random.default_rng(2)
    weights = rng.normal(size=(3, N)) / 3
    one = sample(rng, weights)
    scale, shift = np.exp(rng.normal(size=N)), rng.normal(size=N)
    other = Sample(one.values * scale + shift, one.shares)
    scores = []
    for each in (one, other):
        own, constants = fitted([each])
        scores.append(log_probabilities(each.values @ own.T + constants))
    assert scores[0] == pytest.approx(scores[1], abs=1e-3)


def test_loss_by_loops_is_least():
    """Steps away from what was found, along any coefficient, cost more."""
    rng = np.random.default_rng(3)
    given = sample(rng, rng.normal(size=(3, N)) / 2, count=60)
    own = given.shares.sum(axis=0)
    middle, scale = given.values.mean(axis=0), given.values.std(axis=0)
    standard = (given.values - middle) / scale
    weights, constants = fitted([given])

    def loss(w, c):
        total = weight = 0.0
        for i in range(60):
            scores = [float(w[k] @ standard[i]) + c[k] for k in range(3)]
            sums = math.log(sum(map(math.exp, scores)))
            for k in range(3):
                b = given.shares[i, k] * math.sqrt(own.sum() / own[k])
                total -= b * (scores[k] - sums)
                weight += b
        return total / weight + float((RIDGE * w**2).sum()) / 2

    w, c = weights * scale, constants + weights @ middle
    best = loss(w, c)
    for k in range(3):
        for q in (0, 7, 35):
            for step in (0.05, -0.05):
                off = w.copy()
                off[k, q] += step
                assert loss(off, c) > best
        for step in (0.05, -0.05):
            assert loss(w, c + step * (np.arange(3) == k)) > best


def test_a_rare_kind_counts_between_its_area_and_all_alike():
    """Where quantities tell nothing, probabilities are as the roots of the areas."""
    shares = np.full((50, 2), [0.96, 0.04]) / 50
    weights, constants = fitted([Sample(np.zeros((50, N)), shares)])
    assert not weights.any()
    assert constants[1] - constants[0] == pytest.approx(math.log(math.sqrt(0.04 / 0.96)), abs=1e-3)


def test_examples_that_differ_make_less_sure():
    """What differs from example to example, whatever the kind, is no evidence."""
    rng = np.random.default_rng(4)
    weights = np.zeros((2, N))
    weights[0, 0] = 4.0
    steady = [sample(rng, weights) for _ in range(4)]
    misled = []
    for k in range(4):
        own = np.zeros((2, N))
        own[0, 0], own[0, 1 + k] = 1.0, 6.0  # each has a rule of its own
        misled.append(sample(rng, own))
    assert temperature_of(steady) < 1.3
    assert temperature_of(misled) > 2.0


def test_the_temperature_is_the_best_of_all():
    """None on a grid makes what is left out likelier; two thirds of its logarithm count."""
    rng = np.random.default_rng(5)
    common = rng.normal(size=(2, N))
    samples = [sample(rng, common + rng.normal(size=(2, N)), count=80) for _ in range(3)]
    judged = []
    for k, left_out in enumerate(samples):
        weights, constants = fitted([s for j, s in enumerate(samples) if j != k])
        judged.append((left_out.shares, left_out.values @ weights.T + constants))

    def unlikeliness(temperature):
        return sum(
            (shares * np.minimum(-log_probabilities(scores / temperature), MOST)).sum()
            for shares, scores in judged
        )

    best = min(np.geomspace(0.5, 20, 200), key=unlikeliness)
    assert 1.1 < best < 19
    assert temperature_of(samples) == pytest.approx(best ** (2 / 3), rel=0.03)


def test_kinds_are_found_on_a_shape_that_was_not_shown(examples):
    looks = Table(fit_looks(examples[:2]))
    assert list(looks) == ["head", "stick"]
    unseen = examples[2]
    off = [
        field_values(unseen.shape, "learn:unlikeliness", kind=kind, among=looks)
        for kind in unseen.names
    ]
    right = np.argmin(off, axis=0) == unseen.labels
    assert right @ unseen.shape.areas > 0.95 * unseen.shape.area
    mean = np.choose(unseen.labels, off) @ unseen.shape.areas / unseen.shape.area
    assert mean < 0.3


def test_the_table_is_all_there_is(examples):
    """Rounding and undone standardisation leave the probabilities as they were fitted."""
    kinds = ("head", "stick")
    samples = [Sample.of(example, kinds) for example in examples]
    weights, constants = fitted(samples)
    temperature = temperature_of(samples)
    table = fit_looks(examples)
    for each in samples:
        exact = (each.values @ weights.T + constants) / temperature
        said = np.stack(
            [each.values @ [table[k][key] for key in KEYS] + table[k][CONSTANT] for k in kinds], 1
        )
        apart = np.exp(log_probabilities(said)) - np.exp(log_probabilities(exact))
        assert np.abs(apart).max() < 2e-3
    digits = [
        len(f"{abs(number):.10g}".replace(".", "").lstrip("0")) for number in table["head"].values()
    ]
    assert max(digits) <= 6


def test_the_order_of_examples_hardly_matters(examples):
    one, other = fit_looks(examples), fit_looks(examples[::-1])
    for kind, weights in one.items():
        assert list(other[kind].values()) == pytest.approx(list(weights.values()), abs=0.02)


def test_a_kind_that_one_example_lacks(examples):
    bare = Example(examples[1].shape, np.zeros(examples[1].shape.n_elements, int), ("stick", "x"))
    looks = fit_looks([examples[0], bare])
    assert list(looks) == ["head", "stick"]
    assert all(math.isfinite(weight) for own in looks.values() for weight in own.values())


def test_one_example_is_enough(examples):
    weights, _ = fitted([Sample.of(examples[0], ("head", "stick"))])
    looks = fit_looks(examples[:1])
    assert list(looks["head"].values())[:-1] == pytest.approx(
        weights[0] / ALONE, abs=1e-3, rel=1e-3
    )


def test_nothing_to_learn_from():
    with pytest.raises(UsageError, match="at least one example"):
        fit_looks([])


def test_nothing_is_learned_of_elements_without_a_label(examples):
    example = examples[0]
    missing = np.arange(len(example.labels)) % 3 == 0
    partly = Example(example.shape, np.where(missing, -1, example.labels), example.names)
    whole, some = (Sample.of(each, ["head", "stick"]) for each in (example, partly))
    assert whole.shares.sum() == pytest.approx(1.0)
    areas = example.shape.areas
    assert some.shares.sum() == pytest.approx(areas[~missing].sum() / areas.sum())
    assert (some.shares <= whole.shares + 1e-15).all()
