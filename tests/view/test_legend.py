"""What the title and the legend of a picture draw."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image, ImageDraw

from moseg_core.view.legend import LegendEntry, draw_legend, draw_ramp, draw_title
from moseg_core.view.palette import part_colors
from moseg_core.view.ramp import ramp


def drawn(size, paint):
    """The pixels of a picture and what painting on it returned."""
    image = Image.new("RGB", size, "white")
    result = paint(ImageDraw.Draw(image))
    return np.asarray(image), result


def entries(count):
    return [LegendEntry(f"part {k}", "7 %") for k in range(count)]


def test_title_stays_in_its_place():
    size = (300, 400)
    title = "a title that is far too long for such a picture " * 3
    pixels, below = drawn(size, lambda draw: draw_title(draw, title, size=size, pad=10))
    inked = np.argwhere((pixels < 128).any(axis=2))
    assert len(inked) > 100
    assert inked.min(axis=0).tolist() >= [10, 9]
    assert inked[:, 0].max() < below
    assert inked[:, 1].max() < 290


@pytest.mark.parametrize("title", ["", "  ", "\n"])
def test_no_title_takes_no_room(title):
    size = (300, 400)
    pixels, below = drawn(size, lambda draw: draw_title(draw, title, size=size, pad=10))
    assert below == 0
    assert (pixels == 255).all()


def test_legend_shows_each_color_in_order():
    size, colors = (900, 420), part_colors(5)
    pixels, top = drawn(size, lambda draw: draw_legend(draw, entries(5), colors, size=size, pad=12))
    places = [np.argwhere((pixels == color).all(axis=2)).mean(axis=0) for color in colors]
    rows, columns = np.transpose(places)
    assert (np.diff(columns) > 30).all()
    np.testing.assert_allclose(rows, rows[0], atol=1)
    assert top < rows[0] < 420
    assert (pixels[:top] == 255).all()


def test_legend_greys_an_absent_part():
    size, colors = (400, 300), part_colors(1)
    for absent in (False, True):
        legend = [LegendEntry("nowhere", "0 %", absent=absent)]
        pixels, _ = drawn(
            size, lambda draw, legend=legend: draw_legend(draw, legend, colors, size=size, pad=10)
        )
        assert (pixels == colors[0]).all(axis=2).any() == (not absent)
        assert (pixels.min() < 60) == (not absent)
        assert (pixels == 176).all(axis=2).sum() > 20 or not absent


@pytest.mark.parametrize("size", [(1400, 700), (240, 160), (500, 900)])
@pytest.mark.parametrize("count", [0, 1, 12, 70, 300])
def test_legend_leaves_room_for_the_picture(size, count):
    pixels, top = drawn(
        size, lambda draw: draw_legend(draw, entries(count), part_colors(count), size=size, pad=8)
    )
    assert top >= 0.65 * size[1] - 8
    assert (pixels[:top] == 255).all()
    assert (pixels[:, -8:] == 255).all() or count > 12
    assert (count == 0) == bool((pixels == 255).all())


def test_legend_counts_what_does_not_fit():
    size = (240, 160)

    def shown(count):
        colors = part_colors(count)
        pixels, _ = drawn(
            size, lambda draw: draw_legend(draw, entries(count), colors, size=size, pad=8)
        )
        return sum((pixels == color).all(axis=2).any() for color in colors)

    assert shown(3) == 3
    assert 1 <= shown(40) < 10


def test_legend_draws_any_name():
    size = (400, 300)
    names = ["", "two\nlines", "tab\tand\x00zero", "ü ß 漢字", "x" * 500]
    legend = [LegendEntry(name, "1 %") for name in names]
    pixels, top = drawn(
        size, lambda draw: draw_legend(draw, legend, part_colors(5), size=size, pad=10)
    )
    assert top > 150
    assert all((pixels == color).all(axis=2).any() for color in part_colors(5))


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_a_ramp_goes_from_left_to_right_with_a_mark_in_its_place(share):
    size, words = (600, 300), ("least 1", "greatest 2")

    def paint(draw):
        return draw_ramp(draw, ramp(), *words, middle=(share, "mean"), size=size, pad=10)

    pixels, top = drawn(size, paint)
    band = pixels[top + 2, 10:590]
    (marked,) = np.nonzero((band == 34).all(axis=1))
    assert marked == pytest.approx(share * 578, abs=2)
    if share == 0.3:
        assert band[0].tolist() == ramp()[0].tolist()
        assert band[-1].tolist() == ramp()[-1].tolist()
    text = (pixels[(top + 290) // 2 :] < 128).any(axis=(0, 2))
    gaps = np.diff(np.flatnonzero(text))
    assert (gaps > 8).sum() >= 2  # three words that do not touch


def test_a_ramp_without_a_mean():
    pixels, top = drawn(
        (600, 300), lambda d: draw_ramp(d, ramp(), "a", "b", size=(600, 300), pad=9)
    )
    assert (pixels[:top] == 255).all()
    assert not (pixels[top + 2, 9:591] == 34).all(axis=1).any()
