"""Where a chart puts its curves, dots and words."""

from __future__ import annotations

import math

import pytest

from moseg_core.view.chart import Curve, Panel, draw_chart, draw_message
from moseg_core.view.scene import Dot, Line, Words

RED, BLUE = (200, 0, 10), (0, 10, 200)
# Edges of the field of the first panel: right of the ticks, below the legend.
LEFT, RIGHT, UPPER, LOWER = 76.0, 730.0, 96.0, 284.0
MARGIN = 0.04 / 1.08  # of the values, at either end


def panel(*curves, **words):
    labels = {"title": "search", "x_label": "iteration", "y_label": "cost", **words}
    return Panel(curves=curves, **labels)


def curve(ys, **options):
    xs = tuple(float(k) for k in range(1, len(ys) + 1))
    return Curve(**{"name": "cost", "xs": xs, "ys": tuple(ys), "color": RED, **options})


def draw(*curves, **words):
    """Lines, dots and texts of a chart; those with a name are of a curve."""
    items = draw_chart([panel(*curves, **words)], title="horse").items
    lines = [item for item in items if isinstance(item, Line) and item.name]
    dots = [item for item in items if isinstance(item, Dot) and item.name]
    return lines, dots, [item for item in items if isinstance(item, Words)]


def across(share):
    return LEFT + (MARGIN + share * (1 - 2 * MARGIN)) * (RIGHT - LEFT)


def up(share):
    return LOWER - (MARGIN + share * (1 - 2 * MARGIN)) * (LOWER - UPPER)


def places(item):
    return [value for point in item.points for value in point]


def test_a_curve_fills_its_panel():
    (line,), dots, _ = draw(curve([8.0, 4.0, 0.0, 2.0]))
    expected = [across(0), up(1), across(1 / 3), up(0.5), across(2 / 3), up(0), across(1), up(0.25)]
    assert places(line) == pytest.approx(expected)
    assert (line.color, dots) == (RED, [])


def test_curves_share_the_axes():
    lines, _, _ = draw(curve([8.0, 4.0]), curve([0.0, 6.0, 2.0], name="mean", color=BLUE))
    assert places(lines[0]) == pytest.approx([across(0), up(1), across(0.5), up(0.5)])
    assert places(lines[1])[2:] == pytest.approx([across(0.5), up(0.75), across(1), up(0.25)])


def test_the_axis_is_logarithmic_where_values_span_more_than_two_decades():
    for top, share in ((99.0, 9.0 / 98.0), (101.0, 1.0 / math.log10(101.0))):
        (line,), _, _ = draw(curve([1.0, 10.0, top]))
        assert places(line)[3] == pytest.approx(up(share))
    (line,), _, _ = draw(curve([0.0, 10.0, 1000.0]))  # not where one is no more than zero
    assert places(line)[3] == pytest.approx(up(0.01))


def test_the_right_axis_is_its_own_and_logarithmic():
    step = curve([0.1, 0.001], name="step", color=BLUE, right=True)
    lines, _, words = draw(curve([8.0, 4.0, 0.0]), step, right_label="size")
    assert places(lines[0])[1] == pytest.approx(up(1))
    assert places(lines[1]) == pytest.approx([across(0), up(1), across(0.5), up(0)])
    texts = [item.text for item in words]
    assert {"size", "0.1", "0.01", "0.001"} <= set(texts)


def test_gaps():
    nan, inf = math.nan, math.inf
    lines, dots, _ = draw(curve([8.0, 6.0, nan, 4.0, inf, 2.0, 0.0, -inf]))
    assert [len(line.points) for line in lines] == [2, 2]
    # A value between two gaps has no line to be on.
    assert [dot.center for dot in dots] == [pytest.approx((across(0.5), up(0.5)))]
    assert places(lines[1])[2:] == pytest.approx([across(1), up(0)])


def test_hollow_values_are_dots_beside_the_line():
    lines, dots, _ = draw(curve([9.0, 1.0, 8.0, 4.0], hollow=frozenset([0, 1])))
    assert [len(line.points) for line in lines] == [2]
    assert [dot.hollow for dot in dots] == [True, True]
    assert dots[1].center == pytest.approx((across(1 / 3), up(0)))


def test_dots_only():
    lines, dots, _ = draw(
        curve([3.0, 2.0, 1.0], line=False, hollow=frozenset([1]), pale=frozenset([2]))
    )
    assert lines == []
    assert [dot.hollow for dot in dots] == [False, True, False]
    assert [dot.color == RED for dot in dots] == [True, True, False]


def test_words_say_what_is_what():
    _, _, words = draw(curve([8.0, 4.0]), curve([1.0], name="mean"), notes=("a", "b"))
    texts = [item.text for item in words]
    assert {"horse", "search", "iteration", "cost", "mean", "a; b"} <= set(texts)
    assert [item.text for item in words if item.upward] == ["cost"]
    ticks = [item for item in words if item.anchor == "end" and item.text != "a; b"]
    assert [item.text for item in ticks] == ["2", "4", "6", "8"]
    # 1 and 8 are at the ends, so that ticks two apart are two sevenths of the range apart.
    assert ticks[0].at[1] - ticks[1].at[1] == pytest.approx(up(0) - up(2 / 7))


def test_panels_are_above_one_another():
    one, two = (draw_chart([panel(curve([2.0, 1.0]))] * n, title="") for n in (1, 2))
    assert (one.width, one.height, two.height) == (800, 334, 624)
    upper, lower = [item for item in two.items if isinstance(item, Line) and item.name]
    assert [y + 290 for _, y in upper.points] == pytest.approx([y for _, y in lower.points])


def test_long_titles_are_cut():
    headline = draw_chart([panel(curve([2.0, 1.0]))], title="x" * 200).items[0]
    assert headline.text == "x" * 87 + "..."


def test_a_message():
    scene = draw_message("nothing to see", title="horse")
    assert [item.text for item in scene.items] == ["horse", "nothing to see"]
    assert scene.title == "horse: nothing to see"


def test_everything_stays_on_the_sheet():
    scene = draw_chart([panel(curve([1e-9, 2e9, 3.0]), curve([1e-7], right=True))], title="t")
    for item in scene.items:
        points = (
            item.points if isinstance(item, Line) else [getattr(item, "center", None) or item.at]
        )
        for x, y in points:
            assert 0 <= x <= scene.width
            assert 0 <= y <= scene.height
