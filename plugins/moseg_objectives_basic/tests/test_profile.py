from __future__ import annotations

import math

import numpy as np
import pytest
from moseg_objectives_basic.profile import Likeness

import moseg_core as moseg
from moseg_core import Problem, Segmentation, Target

MEASURES = Likeness._fields


@pytest.fixture(scope="module")
def hammer():
    shape = moseg.load(moseg.sample_path("hammer"))
    labels = moseg.read_labels(moseg.sample_labels_path("hammer"), shape.n_elements).labels
    return Segmentation.from_labels(shape, labels, 2)


@pytest.mark.parametrize("name", MEASURES)
def test_a_target_at_the_measured_value_costs_nothing_and_one_elsewhere_does(hammer, name):
    measured = getattr(hammer.parts[0].measure("basic:likeness"), name)

    def cost(value, spread):
        text = f"is(handle, {name}={Target(value, spread)})"
        problem = Problem(["handle", "head"], text)
        return problem.evaluate(hammer.shape, hammer.labels).cost.value

    assert cost(measured, 0.1) < 1e-12
    # z = 1 one spread above, by ratio or not: ln(v / (v + s)) / ln(1 + s / (v + s)) or -s / s.
    above = cost(measured + 0.1, 0.1)
    by_ratio = name in hammer.parts[0].measure("basic:likeness").by_ratio
    away = 0.1 / (measured + 0.1)
    expected = (math.log(1 - away) / math.log1p(away)) ** 2 if by_ratio else 1.0
    assert above == pytest.approx(
        expected if abs(expected) < 4 else 4 * math.sqrt(expected) - 4, rel=1e-9
    )


def test_what_the_shape_does_not_tell_is_nan():
    rng = np.random.default_rng(0)
    cloud = moseg.Shape.from_points(rng.normal(size=(60, 3)))
    labels = (cloud.points[:, 0] > 0).astype(int)
    found = Segmentation.from_labels(cloud, labels, 2).parts[1].measure("likeness")
    unknown = {name for name in MEASURES if math.isnan(getattr(found, name))}
    assert unknown == set(MEASURES[6:])
    share = cloud.areas[labels == 1].sum() / cloud.area
    assert found.area == pytest.approx(share)


def test_measures_that_are_compared_by_ratio_are_those_whose_targets_must_be_positive(hammer):
    refused = []
    for name in MEASURES:
        try:
            Problem(["handle", "head"], f"is(handle, {name}=0+-1)").evaluate(
                hammer.shape, hammer.labels
            )
        except moseg.UsageError:
            refused.append(name)
    assert set(hammer.parts[0].measure("basic:likeness").by_ratio) <= set(refused)
