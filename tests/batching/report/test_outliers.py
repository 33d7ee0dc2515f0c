"""What is unlike the others is found, whatever the units; what is only larger is not."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.batching.report.outliers import FEWEST, MOST, compare_shapes


def specimen(rng, *, scale=1.0, leg=0.3, parts=("body", "leg"), cost=1.0):
    """The table of a shape of some parts; lengths vary by a twentieth."""
    rows = []
    for part in parts:
        length = (leg if part == "leg" else 0.8) * rng.normal(1, 0.05) * scale
        rows.append(
            {
                "file": "x.off",
                "part": part,
                "elements": 100,
                "length": length,
                "share": 0.5 + rng.normal(0, 0.01),
                "closed_volume": 0.1 * scale**3 * rng.normal(1, 0.05),
                "centroid_x": rng.normal(0, 100),
                "term_narrow": None,
                "shape_diagonal": scale,
                "shape_cost": cost + rng.normal(0, 0.01),
            }
        )
    return rows


@pytest.mark.parametrize("seed", range(5))
def test_the_shape_that_differs_comes_out_whatever_its_size(seed):
    rng = np.random.default_rng(seed)
    tables = [specimen(rng, scale=10 ** rng.uniform(-3, 3)) for _ in range(20)]
    tables[7] = specimen(rng, leg=0.5)
    found = compare_shapes(tables)
    scores = [each.score for each in found]
    assert int(np.argmax(scores)) == 7
    first = found[7].deviations[0]
    assert (first.part, first.measure) == ("leg", "length")
    assert first.value == pytest.approx(0.5, rel=0.2)
    assert first.usual == pytest.approx(0.3, rel=0.1)
    assert first.size > 3


def test_a_part_that_is_not_there_and_one_that_others_lack():
    rng = np.random.default_rng(0)
    tables = [specimen(rng) for _ in range(9)]
    tables += [specimen(rng, parts=("body",)), specimen(rng, parts=("body", "leg", "tail"))]
    found = compare_shapes(tables)
    lacking, more = found[9], found[10]
    assert [(d.part, d.measure, d.value) for d in lacking.deviations if d.measure == "present"] == [
        ("leg", "present", 0.0)
    ]
    assert [(d.part, d.measure, d.value) for d in more.deviations if d.measure == "present"] == [
        ("tail", "present", 1.0)
    ]
    assert min(lacking.score, more.score) > max(each.score for each in found[:9])


def test_an_empty_part_is_not_there():
    rng = np.random.default_rng(1)
    tables = [specimen(rng) for _ in range(8)]
    tables[3] = [
        row if row["part"] != "leg" else {"part": "leg", "elements": 0} for row in tables[3]
    ]
    assert compare_shapes(tables)[3].deviations[0].measure == "present"


def test_equal_shapes_are_all_alike_and_rounding_is_no_difference():
    rng = np.random.default_rng(2)
    one = specimen(rng)
    other = [{**row, "length": row["length"] * (1 + 1e-9)} for row in one]
    found = compare_shapes([one] * 6 + [other])
    assert max(each.score for each in found) < 1e-3
    assert all(each.deviations == () for each in found)


def test_no_score_is_above_the_most_and_few_shapes_have_none():
    rng = np.random.default_rng(3)
    tables = [specimen(rng) for _ in range(FEWEST)]
    tables[0] = specimen(rng, leg=1e9, cost=1e9)
    found = compare_shapes(tables)
    assert 1 < found[0].score <= MOST
    assert compare_shapes(tables[: FEWEST - 1]) is None
