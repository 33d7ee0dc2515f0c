"""A scene as pixels: the same drawing as in :mod:`moseg_core.view.svg`, as a PNG file.

Drawn with Pillow at twice the size of the result and then averaged down, which makes slanted
lines smooth. A unit of the scene is two pixels of the file, as on a dense screen. Text is in
Pillow's built-in font, which is the same everywhere; equal scenes give equal bytes on the same
installation.
"""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

from moseg_core.view.legend import one_line
from moseg_core.view.scene import Dot, Line, Scene, Words

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

#: Pixels of the file for a unit of the scene, and samples for each of those in one direction.
PIXELS, _SAMPLES = 2, 2
_FINE = PIXELS * _SAMPLES
_ANCHORS = {"start": "ls", "middle": "ms", "end": "rs"}


def encode_png(scene: Scene) -> bytes:
    """Write a scene as a PNG file.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    bytes
        A picture of twice as many pixels as the scene has units, either way.

    Examples
    --------
    >>> encode_png(Scene(width=8, height=2, items=()))[1:4]
    b'PNG'
    """
    from PIL import Image, ImageDraw

    image = Image.new("RGB", (scene.width * _FINE, scene.height * _FINE), "white")
    draw = ImageDraw.Draw(image)
    for item in scene.items:
        if isinstance(item, Line):
            _draw_line(draw, item)
        elif isinstance(item, Dot):
            _draw_dot(draw, item)
        else:
            _draw_words(image, draw, item)
    buffer = io.BytesIO()
    image.reduce(_SAMPLES).save(buffer, format="PNG")
    return buffer.getvalue()


def _draw_line(draw: ImageDraw, line: Line) -> None:
    width = max(1, round(line.width * _FINE))
    points = [(x * _FINE, y * _FINE) for x, y in line.points]
    draw.line(points, fill=line.color, width=width, joint="curve")


def _draw_dot(draw: ImageDraw, dot: Dot) -> None:
    x, y = (place * _FINE for place in dot.center)
    # Pillow draws an outline inwards; in SVG its middle is on the radius.
    radius = (dot.radius + 0.5) * _FINE
    fill = (255, 255, 255) if dot.hollow else dot.color
    box = (x - radius, y - radius, x + radius, y + radius)
    draw.ellipse(box, fill=fill, outline=dot.color, width=_FINE)


def _draw_words(image: Image, draw: ImageDraw, words: Words) -> None:
    from PIL import Image, ImageDraw, ImageFont

    text = one_line(words.text)
    font = ImageFont.load_default(size=words.size * _FINE)
    x, y = (place * _FINE for place in words.at)
    if not words.upward:
        draw.text((x, y), text, fill=words.color, font=font, anchor=_ANCHORS[words.anchor])
        return
    # Written level on a strip whose base line is at half its height, which is then stood up.
    length, room = math.ceil(font.getlength(text)), math.ceil(2 * words.size * _FINE)
    strip = Image.new("L", (max(1, length), 2 * room))
    ImageDraw.Draw(strip).text((0, room), text, fill=255, font=font, anchor="ls")
    upright = strip.transpose(Image.Transpose.ROTATE_90)
    before = {"start": 0.0, "middle": 0.5, "end": 1.0}[words.anchor] * length
    corner = round(x) - room, round(y + before) - length
    image.paste(Image.new("RGB", upright.size, words.color), corner, upright)
