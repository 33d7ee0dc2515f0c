"""The words of a picture: its title, and the legend that says which colour is which part.

Drawn with Pillow's built-in font, which is the same everywhere.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw
    from PIL.ImageFont import FreeTypeFont, ImageFont

#: No picture has room for as many characters on a line.
_LONGEST = 300
_DARK, _FAINT, _PALE = (34, 34, 34), (110, 110, 110), (176, 176, 176)


@dataclass(frozen=True)
class LegendEntry:
    """A part as the legend names it.

    Parameters
    ----------
    name : str
    share : str
        Its share of the area, such as "41 %".
    absent : bool
        Whether the part has no elements; it is then greyed.
    """

    name: str
    share: str
    absent: bool = False


def draw_title(
    draw: ImageDraw, title: str, *, size: tuple[int, int], pad: int, beside: int = 0
) -> int:
    """Write a title, shortened where it is too long, at the top left of a picture.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    title : str
    size : (int, int), pixels
        Width and height of the picture.
    pad : int, pixels
        Free space around it.
    beside : int, pixels
        Room on the right that is taken.

    Returns
    -------
    int, pixels
        Where the room below begins; 0 without a title.
    """
    text = one_line(title)
    if not text:
        return 0
    width, height = size
    font = _font(max(13, round(min(width / 42, height / 16))))
    draw.text((pad, pad), _shortened(text, font, width - 2 * pad - beside), fill=_DARK, font=font)
    return pad + _line_height(font)


def draw_legend(
    draw: ImageDraw,
    entries: Sequence[LegendEntry],
    colors: npt.NDArray[np.uint8],
    *,
    size: tuple[int, int],
    pad: int,
) -> int:
    """Write a legend along the bottom of a picture, in as many columns as fit.

    Text becomes smaller where the legend would take over 30 % of the height; entries that still
    do not fit are counted on its last line.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    entries : sequence of LegendEntry
    colors : (n, 3) uint8
        One for each entry.
    size : (int, int), pixels
        Width and height of the picture.
    pad : int, pixels
        Free space around it.

    Returns
    -------
    int, pixels
        Where the room above ends.
    """
    width, height = size
    if not entries:
        return height
    for em in range(_em(size), 10, -1):
        font = _font(em)
        line = _line_height(font) * 5 // 4
        widest = min(width / 3, max(width / 6, 12 * em))
        names = [_shortened(one_line(entry.name), font, widest) for entry in entries]
        ends = [1.5 * em + font.getlength(name) for name in names]
        column = 2 * em + math.ceil(
            max(
                end + 0.5 * em + font.getlength(entry.share)
                for end, entry in zip(ends, entries, strict=True)
            )
        )
        columns = max(1, (width - 2 * pad + 2 * em) // column)
        rows = -(-len(entries) // columns)
        room = max(1, int(0.3 * height) // line)
        if rows <= room:
            break
    fitting = len(entries) if rows <= room else columns * room - 1
    top = height - pad - min(rows, room) * line
    corner = max(1, em // 5)

    def place(k: int) -> tuple[int, int]:
        return pad + k % columns * column, top + k // columns * line

    for k, entry in enumerate(entries[:fitting]):
        x, y = place(k)
        swatch = (x, y + em // 8, x + em, y + em // 8 + em)
        if entry.absent:
            draw.rounded_rectangle(swatch, corner, outline=_PALE, width=max(1, em // 10))
        else:
            red, green, blue = colors[k].tolist()
            draw.rounded_rectangle(swatch, corner, fill=(red, green, blue))
        dark, faint = (_PALE, _PALE) if entry.absent else (_DARK, _FAINT)
        draw.text((x + 1.5 * em, y), names[k], fill=dark, font=font)
        draw.text((x + ends[k] + 0.5 * em, y), entry.share, fill=faint, font=font)
    if fitting < len(entries):
        draw.text(place(fitting), f"and {len(entries) - fitting} more", fill=_FAINT, font=font)
    return top


def draw_ramp(
    draw: ImageDraw,
    colors: npt.NDArray[np.uint8],
    least: str,
    greatest: str,
    *,
    middle: tuple[float, str] | None = None,
    size: tuple[int, int],
    pad: int,
) -> int:
    """Draw a ramp of colours along the bottom of a picture, with words below it.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    colors : (n, 3) uint8
        From left to right.
    least, greatest : str
        What the left and the right end are.
    middle : (float, str), optional
        Where something is between them, 0 to 1, and what; it gets a mark.
    size : (int, int), pixels
        Width and height of the picture.
    pad : int, pixels
        Free space around it.

    Returns
    -------
    int, pixels
        Where the room above ends.
    """
    width, height = size
    font = _font(_em(size))
    line = _line_height(font) * 5 // 4
    top = height - pad - 2 * line
    left, right = pad, width - pad
    for x in range(left, right):
        red, green, blue = colors[(x - left) * len(colors) // (right - left)].tolist()
        draw.line([(x, top), (x, top + line * 2 // 3)], fill=(red, green, blue))
    room = (right - left) / 3 - pad
    words = [_shortened(one_line(text), font, room) for text in (least, greatest)]
    lengths = [font.getlength(text) for text in words]
    draw.text((left, top + line), words[0], fill=_DARK, font=font)
    draw.text((right - lengths[1], top + line), words[1], fill=_DARK, font=font)
    if middle is not None:
        place = left + middle[0] * (right - left - 2)
        draw.line([(place, top), (place, top + line * 2 // 3)], fill=_DARK, width=2)
        text = _shortened(one_line(middle[1]), font, room)
        length = font.getlength(text)
        start = max(left + lengths[0] + pad, place - length / 2)
        start = min(start, right - lengths[1] - pad - length)
        draw.text((start, top + line), text, fill=_DARK, font=font)
    return top


def draw_caption(
    draw: ImageDraw, text: str, *, size: tuple[int, int], at: tuple[int, int], right: bool = False
) -> int:
    """Write a few small, faint words.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    text : str
    size : (int, int), pixels
        Width and height of the picture.
    at : (int, int), pixels
        The upper left corner of the words, or the upper right one.
    right : bool
        Whether it is the right one.

    Returns
    -------
    int, pixels
        How long they are.
    """
    font = _font(max(11, round(0.75 * _em(size))))
    words = one_line(text)
    draw.text(at, words, fill=_FAINT, font=font, anchor="ra" if right else "la")
    return math.ceil(font.getlength(words))


def _em(size: tuple[int, int]) -> int:
    """Height of the words of a picture: one that is shown at 600 pixels has them at 12 or more."""
    width, height = size
    return max(13, round(min(width / 48, height / 20)))


def one_line(text: str) -> str:
    r"""Text without line breaks and other characters that cannot be drawn.

    Examples
    --------
    >>> one_line("two\nlines\x00")
    'two lines'
    """
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def _shortened(text: str, font: FreeTypeFont | ImageFont, width: float) -> str:
    """Cut a text that is too long to draw, and end it in three dots."""
    if len(text) <= _LONGEST and font.getlength(text) <= width:
        return text
    lengths = range(1, min(len(text), _LONGEST) + 1)
    fits = bisect_right(lengths, width, key=lambda n: font.getlength(text[:n] + "..."))
    return text[:fits] + "..."


def _line_height(font: FreeTypeFont | ImageFont) -> int:
    """Height of a line of text with its descenders, pixels."""
    return int(font.getbbox("Ag")[3])


def _font(size: int) -> FreeTypeFont | ImageFont:
    from PIL import ImageFont

    return ImageFont.load_default(size=size)
