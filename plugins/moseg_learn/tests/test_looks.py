"""Scores and probabilities by hand, and what is said of tables that cannot be read."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from moseg_learn.looks import (
    KEYS,
    MOST,
    Looks,
    beside_the_rest,
    log_probabilities,
    quantities,
    unlikeliness,
)
from moseg_learn.position import POSITIONS, positions

import moseg_core as moseg
from moseg_core import Shape, Table, UsageError, field_values

LOOKS = Table(
    {
        "body": {"thickness": 2, "concavity_within_8": -1.5, "constant": 0.5},
        "leg": {"remoteness": 3, "area_within_30": 0.25},
        "tail": {},
    }
)


@pytest.fixture(scope="module")
def lump():
    mesh = trimesh.creation.icosphere(subdivisions=2)
    bent = mesh.vertices * [1.5, 1, 0.6] + 0.2 * np.sin(3 * mesh.vertices[:, [1, 2, 0]])
    return Shape.from_mesh(bent, mesh.faces)


def unlikely(shape, kind, among=LOOKS):
    return field_values(shape, "learn:unlikeliness", kind=kind, among=among)


def test_quantities_are_the_fields_they_are_called_after(lump):
    found = dict(zip(KEYS, quantities(lump).T, strict=True))
    assert len(found) == 116
    assert np.array_equal(found["thickness"], field_values(lump, "basic:log_thickness"))
    assert np.array_equal(found["log_remoteness"], np.log(found["remoteness"]))
    assert np.array_equal(found["concavity"], field_values(lump, "basic:concavity"))
    for percent in (4, 8, 16, 30):
        for name in ("area", "offset", "remoteness"):
            around = field_values(lump, "learn:surroundings", of=name, radius=percent / 100)
            assert np.array_equal(found[f"{name}_within_{percent}"], around)
    for k, name in enumerate(POSITIONS):
        assert np.array_equal(found[name], positions(lump)[:, k])


def test_places_are_compared_with_the_rest_of_their_shape(lump):
    found = dict(zip(KEYS, quantities(lump).T, strict=True))
    for name in ("thickness", "remoteness", "outward", "width_within_16"):
        x = found[name]
        mean = np.average(x, weights=lump.areas)
        z = (x - mean) / np.sqrt(np.average((x - mean) ** 2, weights=lump.areas))
        assert found[f"relative_{name}"] == pytest.approx(z / np.hypot(1, z), abs=1e-9)


def test_what_is_the_same_everywhere_says_nothing():
    """Rounding errors of a ball's thickness are no differences."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    shape = Shape.from_mesh(ball.vertices, ball.faces)
    noise = 1e-9 * np.random.default_rng(0).normal(size=(shape.n_elements, 1))
    assert np.abs(beside_the_rest(shape, 3.0 + noise)).max() < 1e-5


def test_probabilities_by_hand(lump):
    found = dict(zip(KEYS, quantities(lump).T.tolist(), strict=True))
    values = {kind: unlikely(lump, kind) for kind in LOOKS}
    for i in range(0, lump.n_elements, 7):
        scores = {
            "body": 2 * found["thickness"][i] - 1.5 * found["concavity_within_8"][i] + 0.5,
            "leg": 3 * found["remoteness"][i] + 0.25 * found["area_within_30"][i],
            "tail": 0.0,
        }
        total = sum(map(math.exp, scores.values()))
        for kind, score in scores.items():
            expected = min(-math.log(math.exp(score) / total), MOST)
            assert values[kind][i] == pytest.approx(expected)


def test_probabilities_are_one_together_where_none_is_cut_off(lump):
    total = sum(np.exp(-unlikely(lump, kind)) for kind in LOOKS)
    assert total == pytest.approx(1, abs=3e-3)


def test_a_table_is_read_once_and_others_each_time():
    equal = Table(LOOKS.document())
    assert Looks.read(LOOKS) is Looks.read(equal)
    assert Looks.read(LOOKS).kinds == Looks.read(LOOKS.document()).kinds == ("body", "leg", "tail")
    assert Looks.read(LOOKS.document()) is not Looks.read(LOOKS)
    wrong = Table({"body": {"thickness": 1}, "leg": {"thinness": 1}})
    for _ in range(2):
        with pytest.raises(UsageError, match=r"in the looks of 'leg': unknown quantity 'thinness'"):
            Looks.read(wrong)


def test_nothing_is_unlikelier_than_one_in_a_thousand(lump):
    among = Table({"a": {"constant": 500}, "b": {"constant": -500}})
    assert unlikely(lump, "a", among).tolist() == [0.0] * lump.n_elements
    assert unlikely(lump, "b", among) == pytest.approx(math.log(1000))


def test_without_a_table_nothing_is_unlikely(lump):
    assert not field_values(lump, "learn:unlikeliness").any()


def test_kinds_of_a_table_are_scored_together_and_once(lump, monkeypatch):
    calls = []
    scored = Looks.unlikeliness
    monkeypatch.setattr(Looks, "unlikeliness", lambda *given: calls.append(1) or scored(*given))
    fresh = Shape.from_mesh(lump.geometry.vertices, np.asarray(lump.geometry.triangles))
    for kind in LOOKS:
        assert np.array_equal(unlikely(fresh, kind), unlikely(lump, kind))
    unlikely(fresh, "leg", Table(LOOKS.document()))  # an equal one
    assert len(calls) == 1
    unlikely(fresh, "leg", Table({**LOOKS, "tail": {"constant": 1}}))
    assert len(calls) == 2


def test_scores_of_groups_are_carried_to_elements():
    """On a mesh of more elements than groups values change from element to element."""
    horse = moseg.load(moseg.sample_path("horse"))
    values = unlikely(horse, "leg")
    assert len(np.unique(values.round(9))) > 0.9 * horse.n_elements
    # Each a mean of scores: within the bounds of those.
    assert values.min() >= 0


@pytest.mark.parametrize(
    ("among", "message"),
    [
        ({"leg": {"thicknes": 1}}, "looks of 'leg': unknown quantity 'thicknes'; did you mean 'th"),
        ({"leg": {"area_within_9": 1}}, "unknown quantity 'area_within_9'; did you mean 'area_w"),
        ({"leg": {"thickness": "much"}}, "weight 'thickness' must be a number, not 'much'"),
        ({"leg": {"thickness": True}}, "weight 'thickness' must be a number, not True"),
        ({"leg": 3}, "looks of 'leg' must be a table of weights, not 3"),
        ({"legs": {}, "body": {}}, "unknown kind among the looks 'leg'; did you mean 'legs'"),
        ({}, "unknown kind among the looks 'leg'; known: none"),
    ],
)
def test_tables_that_cannot_be_read(lump, among, message):
    with pytest.raises(UsageError) as caught:
        unlikeliness(lump, kind="leg", among=Table(among))
    assert message in str(caught.value)


def test_log_probabilities_do_not_overflow():
    scores = np.array([[1e4, 0.0, -1e4], [1.0, 2.0, 3.0]])
    found = log_probabilities(scores)
    assert found[0].tolist() == [0.0, -1e4, -2e4]
    assert np.exp(found[1]) == pytest.approx(np.exp([1, 2, 3]) / np.exp([1, 2, 3]).sum())
