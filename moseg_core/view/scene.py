"""A drawing as plain data: lines, dots and words on a white sheet.

What is drawn and how it becomes a file are two questions. A chart (:mod:`moseg_core.view.chart`)
says where its lines and words are, in a :class:`Scene`; :mod:`moseg_core.view.svg` and
:mod:`moseg_core.view.png` write the same scene as vectors and as pixels, so that neither of them
knows what a chart is, and a chart in one format is the chart in the other.

Lengths are in units of a 96th of an inch, the pixel of the web. The origin is the top left corner,
x runs right and y runs down. What comes later is drawn over what came before.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Color = tuple[int, int, int]
"""Red, green and blue, sRGB, 0 to 255."""

Point = tuple[float, float]
"""A place on the sheet."""

Anchor = Literal["start", "middle", "end"]
"""Which place of a text is given."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """A line through points, with round corners.

    Parameters
    ----------
    points : tuple of (float, float)
        Two or more.
    color : Color
    width : float
    name : str
        What the line stands for; formats with names keep it.
    """

    points: tuple[Point, ...]
    color: Color
    width: float = 1.0
    name: str = ""


@dataclass(frozen=True, kw_only=True)
class Dot:
    """A disc, or a circle where it is hollow.

    Parameters
    ----------
    center : (float, float)
    radius : float
        To the middle of the outline.
    color : Color
    hollow : bool
        Whether it is white inside.
    name : str
        What the dot stands for.
    """

    center: Point
    radius: float
    color: Color
    hollow: bool = False
    name: str = ""


@dataclass(frozen=True, kw_only=True)
class Words:
    """A line of text.

    Parameters
    ----------
    text : str
    at : (float, float)
        On the text's base line, at its start, middle or end.
    size : float
        Height of the type.
    color : Color
    anchor : {"start", "middle", "end"}
    upward : bool
        Whether the text runs up instead of right.
    """

    text: str
    at: Point
    size: float
    color: Color
    anchor: Anchor = "start"
    upward: bool = False


Item = Line | Dot | Words


@dataclass(frozen=True, kw_only=True)
class Scene:
    """What is on a sheet.

    Parameters
    ----------
    width, height : int
    items : tuple of Line, Dot and Words
        In the order of drawing.
    title : str
        What the drawing is, for readers who do not see it.
    """

    width: int
    height: int
    items: tuple[Item, ...]
    title: str = ""
