"""A scene written as PNG: what is where, two pixels to a unit."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from moseg_core.view.png import encode_png
from moseg_core.view.scene import Dot, Line, Scene, Words

RED, BLACK = (200, 0, 10), (0, 0, 0)


def drawn(*items, width=90, height=60):
    with Image.open(
        io.BytesIO(encode_png(Scene(width=width, height=height, items=items)))
    ) as image:
        assert image.format == "PNG"
        return np.asarray(image.convert("RGB")).astype(int)


def inked(pixels):
    """Top, left, bottom and right of what is not white, in units of the scene."""
    places = np.argwhere((pixels < 250).any(axis=2))
    return [*(places.min(axis=0) / 2).tolist(), *((places.max(axis=0) + 1) / 2).tolist()]


def test_an_empty_sheet_is_white():
    pixels = drawn()
    assert pixels.shape == (120, 180, 3)
    assert (pixels == 255).all()


def test_a_line_is_where_it_should_be():
    pixels = drawn(Line(points=((10.0, 20.0), (70.0, 20.0), (70.0, 50.0)), color=RED, width=2.0))
    for x, y in ((12, 20), (40, 20), (69.5, 30), (69.5, 48)):
        assert pixels[int(2 * y), int(2 * x)].tolist() == list(RED)
    np.testing.assert_allclose(inked(pixels), [19, 10, 50, 71], atol=1)


def test_dots_are_full_or_hollow():
    pixels = drawn(
        Dot(center=(20.0, 30.0), radius=8.0, color=RED),
        Dot(center=(60.0, 30.0), radius=8.0, color=RED, hollow=True),
    )
    assert pixels[60, 40].tolist() == list(RED)
    assert pixels[60, 120].tolist() == [255, 255, 255]
    for x in (52, 68):
        assert (pixels[60, 2 * x - 1 : 2 * x + 1] == RED).all(axis=1).any()
    np.testing.assert_allclose(inked(pixels), [21.5, 11.5, 38.5, 68.5], atol=0.6)


def test_what_comes_later_is_over_what_came_before():
    line = Line(points=((10.0, 30.0), (80.0, 30.0)), color=BLACK, width=2.0)
    dot = Dot(center=(40.0, 30.0), radius=6.0, color=RED)
    assert drawn(line, dot)[60, 80].tolist() == list(RED)
    assert drawn(dot, line)[60, 80].tolist() == list(BLACK)


@pytest.mark.parametrize(("anchor", "share"), [("start", 0.0), ("middle", 0.5), ("end", 1.0)])
def test_words_end_at_their_anchor(anchor, share):
    def level_and_upward(text):
        words = {"text": text, "size": 12.0, "color": BLACK, "anchor": anchor}
        return (
            inked(drawn(Words(at=(100.0, 100.0), **words), width=200, height=200)),
            inked(drawn(Words(at=(100.0, 100.0), upward=True, **words), width=200, height=200)),
        )

    (top, left, bottom, right), upward = level_and_upward("HHHHHH")
    assert right - left > 40
    assert left + share * (right - left) == pytest.approx(100, abs=2)
    assert bottom == pytest.approx(100, abs=1)
    assert 100 - top == pytest.approx(8.5, abs=1.5)
    # A quarter turn to the left about the place that is given: right becomes up.
    turned = [100 - (right - 100), top, 100 - (left - 100), bottom]
    np.testing.assert_allclose(upward, turned, atol=1.0)


def test_text_that_cannot_be_drawn_is_left_out():
    words = {"at": (10.0, 40.0), "size": 12.0, "color": BLACK}
    both = [drawn(Words(text=text, **words)) for text in ("a b", "a\x00\nb")]
    np.testing.assert_array_equal(*both)
    assert (drawn(Words(text="\x07", upward=True, **words)) == 255).all()
