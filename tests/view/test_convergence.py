"""The curves of known histories: what is drawn, where, and what is said of the rest."""

from __future__ import annotations

import io
import math
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from moseg_core.errors import UsageError
from moseg_core.view.convergence import render_convergence
from moseg_core.view.palette import part_colors

SVG = "{http://www.w3.org/2000/svg}"

EVOLUTION = [
    {"generation": 1, "evaluations": 50, "best": 8.0, "mean": 12.0, "empty": 0},
    {"generation": 2, "evaluations": 98, "best": 6.0, "mean": 10.0, "empty": 0},
    {"generation": 3, "evaluations": 140, "best": 4.0, "mean": 7.0, "empty": 0},
]
KMEANS = [{"round": k, "largest_step": 10.0**-k} for k in (1, 2, 3)]
SEARCH = [
    {"evaluations": 1, "value": 4.0, "empty": 0, "step": 0.2},
    {"evaluations": 17, "value": 3.0, "empty": 0, "step": 0.2},
    {"evaluations": 33, "value": 3.0, "empty": 0, "step": 0.4},
]
POLISH = [
    {"evaluations": 1, "value": 3.5, "empty": 0, "step": 0.01},
    {"evaluations": 17, "value": 2.0, "empty": 0, "step": 0.01},
]
STARTS = [
    {"value": 2.0, "empty": 0, "finalist": 1},
    {"value": 3.0, "empty": 0, "finalist": 0},
    {"value": 1.0, "empty": 1, "finalist": 0},
]
LEFT, RIGHT, UPPER, LOWER = 76.0, 730.0, 96.0, 284.0
MARGIN = 0.04 / 1.08


def drawn(history, **options):
    return ElementTree.fromstring(render_convergence(history, **options))


def curves(root):
    """(name, (n, 2) points) of the lines that stand for something."""
    return [
        (line.find(f"{SVG}title").text, points_of(line))
        for line in root.iter(f"{SVG}polyline")
        if line.find(f"{SVG}title") is not None
    ]


def points_of(line):
    return np.array([[float(v) for v in pair.split(",")] for pair in line.get("points").split()])


def texts(root):
    return [element.text for element in root.iter(f"{SVG}text")]


def dots(root):
    return [dot for dot in root.iter(f"{SVG}circle") if dot.find(f"{SVG}title") is not None]


def at(x, y, *, panel=0):
    """Place of shares of the ranges of both axes, in the panel of that number."""
    inner = 1 - 2 * MARGIN
    across = LEFT + (MARGIN + x * inner) * (RIGHT - LEFT)
    return across, LOWER + 290 * panel - (MARGIN + y * inner) * (LOWER - UPPER)


def test_mean_and_best_of_each_generation():
    root = drawn({"seeding": EVOLUTION})
    (first, mean), (second, best) = curves(root)
    assert (first, second) == ("mean", "best so far")
    np.testing.assert_allclose(mean, [at(0, 1), at(0.5, 0.75), at(1, 3 / 8)], atol=0.01)
    np.testing.assert_allclose(best, [at(0, 0.5), at(0.5, 0.25), at(1, 0)], atol=0.01)
    strokes = {
        line.find(f"{SVG}title").text: line.get("stroke")
        for line in root.iter(f"{SVG}polyline")
        if line.find(f"{SVG}title") is not None
    }
    red, green, blue = part_colors(1)[0]
    assert strokes == {"mean": f"#{red:02x}{green:02x}{blue:02x}", "best so far": "#222222"}
    assert {"Seeding by evolution", "generation", "cost"} <= set(texts(root))


def test_k_means_shows_how_far_centres_move():
    root = drawn({"seeding": KMEANS})
    ((name, step),) = curves(root)
    assert name == "largest step of a centre"
    # Two decades are not more than two: 0.1, 0.01 and 0.001 on a linear axis.
    np.testing.assert_allclose(step, [at(0, 1), at(0.5, 0.009 / 0.099), at(1, 0)], atol=0.01)


def test_cost_and_pattern_size_of_each_iteration_through_the_polish():
    root = drawn({"search": SEARCH, "polish": POLISH})
    (_, size), (first, cost), (second, polish) = curves(root)
    assert (first, second) == ("cost", "cost while polishing")
    np.testing.assert_allclose(cost, [at(0, 1), at(0.25, 0.5), at(0.5, 0.5)], atol=0.01)
    np.testing.assert_allclose(polish, [at(0.75, 0.75), at(1, 0)], atol=0.01)
    middle = math.log10(0.2 / 0.01) / math.log10(0.4 / 0.01)
    heights = [middle, middle, 1, 0, 0]
    expected = [at(k / 4, height) for k, height in enumerate(heights)]
    np.testing.assert_allclose(size, expected, atol=0.01)
    assert "pattern size (diagonals)" in texts(root)


NUMBERS = [
    {"parts": 2, "cost": 3.0, "empty": 0},
    {"parts": 3, "cost": 1.0, "empty": 0},
    {"parts": 4, "cost": 2.0, "empty": 1},
]


def test_starts_are_dots():
    root = drawn({"search": SEARCH, "restarts": STARTS})
    found = dots(root)
    centers = [(float(dot.get("cx")), float(dot.get("cy"))) for dot in found]
    expected = [at(0, 0.5, panel=1), at(0.5, 1, panel=1), at(1, 0, panel=1)]
    np.testing.assert_allclose(centers, expected, atol=0.01)
    assert found[0].get("fill") == "#222222"
    assert found[1].get("fill") not in ("#222222", "#ffffff")
    assert found[2].get("fill") == "#ffffff"
    assert "grey: given up early; hollow: with an empty part" in texts(root)
    assert not dots(drawn({"search": SEARCH, "restarts": STARTS[:1]}))


def test_numbers_of_parts_are_dots():
    root = drawn({"search": SEARCH, "number of parts": NUMBERS})
    found = dots(root)
    centers = [(float(dot.get("cx")), float(dot.get("cy"))) for dot in found]
    expected = [at(0, 1, panel=1), at(0.5, 0, panel=1), at(1, 0.5, panel=1)]
    np.testing.assert_allclose(centers, expected, atol=0.01)
    assert [dot.get("fill") for dot in found] == ["#222222", "#222222", "#ffffff"]
    assert {"Number of parts", "parts", "hollow: with an empty part"} <= set(texts(root))


def test_panels_only_for_what_there_is():
    stages = {"seeding": EVOLUTION, "search": SEARCH, "restarts": STARTS}
    for left_out in stages:
        history = {stage: records for stage, records in stages.items() if stage != left_out}
        assert drawn(history).get("height") == str(44 + 2 * 290)
    assert drawn(stages).get("height") == str(44 + 3 * 290)


def test_costs_with_empty_parts_are_hollow_and_off_the_line():
    first = {"evaluations": 1, "value": 1.0, "empty": 2, "step": 0.2}
    root = drawn({"search": [first, *SEARCH]})
    (_, cost) = curves(root)[1]
    np.testing.assert_allclose(cost, [at(1 / 3, 1), at(2 / 3, 2 / 3), at(1, 2 / 3)], atol=0.01)
    (dot,) = dots(root)
    assert (float(dot.get("cx")), float(dot.get("cy"))) == pytest.approx(at(0, 0), abs=0.01)
    assert dot.get("fill") == "#ffffff"
    assert "hollow: with an empty part" in texts(root)


@pytest.mark.parametrize("infinite", [None, math.inf, -math.inf, 1e290])
def test_infinite_costs_are_left_out_and_counted(infinite):
    first = {"evaluations": 1, "value": infinite, "empty": 0, "step": 0.2}
    root = drawn({"search": [first, first, *SEARCH]})
    (_, cost) = curves(root)[1]
    np.testing.assert_allclose(cost, [at(0.5, 1), at(0.75, 0), at(1, 0)], atol=0.01)
    assert "infinite, left out: 2" in texts(root)


def test_a_generation_without_a_mean_is_a_gap_and_no_infinity():
    bad = {"generation": 4, "evaluations": 150, "best": 4.0, "empty": 0}
    root = drawn({"seeding": [*EVOLUTION, bad]})
    assert [len(points) for _, points in curves(root)] == [3, 4]
    assert not any("infinite" in text for text in texts(root))


def test_costs_over_many_decades_are_on_a_logarithmic_axis():
    records = [{**SEARCH[0], "value": value} for value in (1000.0, 10.0, 1.0)]
    (_, cost) = curves(drawn({"search": records}))[1]
    np.testing.assert_allclose(cost, [at(0, 1), at(0.5, 1 / 3), at(1, 0)], atol=0.01)


@pytest.mark.parametrize(
    "history",
    [
        {},
        {"seeding": (), "search": ()},
        {"search": [{"value": None, "empty": 1, "step": 0.2}]},
        {"seeding": [{"temperature": 3.0}]},
    ],
)
def test_an_empty_history_says_so(history):
    root = drawn(history)
    assert any(text.startswith("No search was recorded") for text in texts(root))
    assert not curves(root)
    with Image.open(io.BytesIO(render_convergence(history, format="png"))) as image:
        assert image.size == (1600, 200)


def test_png_and_svg_are_the_same_drawing():
    history = {"seeding": EVOLUTION, "search": SEARCH, "polish": POLISH}
    root = drawn(history, title="horse")
    with Image.open(io.BytesIO(render_convergence(history, format="png", title="horse"))) as image:
        assert image.size == (2 * int(root.get("width")), 2 * int(root.get("height")))
        pixels = np.asarray(image.convert("RGB")).astype(int)
    for line in root.iter(f"{SVG}polyline"):
        if line.find(f"{SVG}title") is None or float(line.get("stroke-width")) < 1:
            continue
        color = [int(line.get("stroke")[k : k + 2], 16) for k in (1, 3, 5)]
        for x, y in np.rint(2 * points_of(line)).astype(int):
            near = pixels[y - 3 : y + 3, x - 3 : x + 3].reshape(-1, 3)
            assert (np.abs(near - color).max(axis=1) < 40).any()


def test_equal_histories_give_equal_bytes():
    history = {"seeding": EVOLUTION, "search": SEARCH, "restarts": STARTS}
    for format in ("svg", "png"):
        first, second = (render_convergence(history, format=format) for _ in range(2))
        assert first == second


def test_names_are_escaped():
    root = drawn({"search": SEARCH}, title="</svg> & <me>")
    assert texts(root)[0] == "</svg> & <me>"


def test_other_formats_are_refused():
    with pytest.raises(UsageError, match="unknown chart format 'pdf'; known: png, svg"):
        render_convergence({}, format="pdf")
