"""Colours that stay apart, and checks of colours."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import UsageError
from moseg_core.view.palette import checked_colors, linear_light, part_colors

# How linear sRGB is seen without one kind of cone (Machado, Oliveira and Fernandes 2009).
SEEN = {
    "normal": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}


def oklab(linear):
    cones = np.cbrt(
        linear
        @ np.array(
            [
                [0.4122214708, 0.2119034982, 0.0883024619],
                [0.5363325363, 0.6806995451, 0.2817188376],
                [0.0514459929, 0.1073969566, 0.6299787005],
            ]
        )
    )
    return cones @ np.array(
        [
            [0.2104542553, 1.9779984951, 0.0259040371],
            [0.7936177850, -2.4285922050, 0.7827717662],
            [-0.0040720468, 0.4505937099, -0.8086757660],
        ]
    )


def least_difference(colors, seen=SEEN["normal"]):
    points = oklab(np.clip(linear_light(colors) @ np.transpose(seen), 0, 1))
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    return gaps[np.triu_indices(len(points), 1)].min()


def test_twelve_colors_differ_clearly():
    assert least_difference(part_colors(12)) >= 0.13


@pytest.mark.parametrize("reader", SEEN)
def test_twelve_colors_differ_for_all_readers(reader):
    assert least_difference(part_colors(12), SEEN[reader]) >= 0.07
    assert least_difference(part_colors(8), SEEN[reader]) >= 0.09


def test_colors_show_on_white_and_are_no_greys():
    points = oklab(linear_light(part_colors(100)))
    assert points[:, 0].max() <= 0.91
    assert points[:, 0].min() >= 0.34
    assert np.hypot(points[:, 1], points[:, 2]).min() >= 0.04


def test_generated_colors_stay_apart():
    assert least_difference(part_colors(24)) >= 0.08
    assert least_difference(part_colors(60)) >= 0.04
    assert len(np.unique(part_colors(500), axis=0)) == 500


@given(n=st.integers(0, 80), m=st.integers(0, 80))
def test_more_parts_keep_the_colors_of_fewer(n, m):
    few, many = sorted([n, m])
    assert part_colors(few).shape == (few, 3)
    assert part_colors(few).dtype == np.uint8
    np.testing.assert_array_equal(part_colors(many)[:few], part_colors(few))


def test_the_caller_may_change_the_colors():
    colors = part_colors(3)
    colors[:] = 0
    assert part_colors(3).any()


def test_more_parts_than_colors_repeat():
    assert part_colors(9000).shape == (9000, 3)


def test_linear_light_follows_the_standard():
    # IEC 61966-2-1: the linear segment ends at 0.04045.
    light = linear_light(np.array([[0, 10, 11], [128, 188, 255]], np.uint8))
    expected = [[0, 10 / 255 / 12.92, 0.0033465], [0.2158605, 0.5028865, 1]]
    np.testing.assert_allclose(light, expected, atol=1e-6)


@pytest.mark.parametrize(
    "colors",
    [[[1, 2, 3]], [[1, 2], [3, 4]], [[0.5, 1, 1]] * 2, [[256, 0, 0]] * 2, [[-1, 0, 0]] * 2],
)
def test_colors_that_do_not_fit(colors):
    with pytest.raises(UsageError, match="2 parts need as many colours"):
        checked_colors(colors, ["a", "b"])


def test_colors_come_out_as_they_went_in():
    assert checked_colors([[255, 0, 7]], ["a"]).tolist() == [[255, 0, 7]]
    assert checked_colors([], []).shape == (0, 3)
