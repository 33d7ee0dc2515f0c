"""Charts of numbers that change step by step: panels above one another, each with its curves.

A :class:`Panel` says what there is to see, in its own numbers; :func:`draw_chart` finds room and
axes for it and returns a :class:`~moseg_core.view.scene.Scene`. Values that are no numbers leave
gaps. Values that do not compare with the others are hollow: they are dots beside the curve, not
part of its line. The left axis is logarithmic where the values on it span more than two powers
of ten.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from moseg_core.view.axis import Axis, linear_axis, log_axis
from moseg_core.view.scene import Anchor, Color, Dot, Item, Line, Point, Scene, Words

_INK, _FAINT, _FRAME, _GRID = (34, 34, 34), (96, 96, 96), (150, 150, 150), (232, 232, 232)
_WIDTH, _HEAD, _PANEL = 800, 44, 290
_LEFT, _RIGHT, _TOP, _BOTTOM = 76, 70, 52, 50
_TYPE, _TITLE = 12.0, 16.0
#: Letters of a title that fit.
_LONGEST = 90
#: Mean width of a letter, as a share of the height of the type.
_LETTER = 0.5
_RADIUS = 2.6
#: The left axis is logarithmic from this ratio on.
_WIDE = 100.0
#: Values beyond the second count as infinite: differences between them would be. On a logarithmic
#: axis, values up to the first count as zero.
_SMALLEST, _LARGEST = 1e-280, 1e280


@dataclass(frozen=True, kw_only=True)
class Curve:
    """Values in order.

    Parameters
    ----------
    name : str
        As the legend says it.
    xs, ys : tuple of float
        As many of one as of the other; what is not finite is a gap.
    color : Color
    hollow : frozenset of int
        Places of the values that do not compare with the others.
    pale : frozenset of int
        Places of the dots that are drawn in grey; without effect on a line.
    width : float
        Of the line, in the units of a scene.
    line : bool
        Whether values are joined by a line; else each is a dot.
    right : bool
        Whether the values are on the right axis, which is logarithmic.
    """

    name: str
    xs: tuple[float, ...]
    ys: tuple[float, ...]
    color: Color
    hollow: frozenset[int] = frozenset()
    pale: frozenset[int] = frozenset()
    width: float = 1.6
    line: bool = True
    right: bool = False

    @property
    def shown(self) -> list[int]:
        """Places of the values that can be drawn."""
        least = _SMALLEST if self.right else -_LARGEST
        pairs = enumerate(zip(self.xs, self.ys, strict=True))
        return [k for k, (x, y) in pairs if math.isfinite(x) and least < y < _LARGEST]


@dataclass(frozen=True, kw_only=True)
class Panel:
    """Curves over one horizontal axis of whole numbers.

    Parameters
    ----------
    title : str
    x_label, y_label : str
        What the axes count.
    curves : tuple of Curve
        In the order of drawing.
    right_label : str
        What the right axis counts, where a curve is on it.
    notes : tuple of str
        Written below, for what the curves do not say.
    """

    title: str
    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    right_label: str = ""
    notes: tuple[str, ...] = ()


def draw_chart(panels: Sequence[Panel], *, title: str) -> Scene:
    """Draw panels above one another.

    Parameters
    ----------
    panels : sequence of Panel
        Each with at least one value to draw.
    title : str

    Returns
    -------
    Scene
        800 wide and 290 high for each panel, with 44 for the title.

    Examples
    --------
    >>> cost = Curve(name="cost", xs=(1, 2), ys=(3.0, 1.0), color=(0, 0, 0))
    >>> panel = Panel(title="search", x_label="iteration", y_label="cost", curves=(cost,))
    >>> draw_chart([panel], title="horse").height
    334
    """
    items: list[Item] = [_headline(title)]
    for k, panel in enumerate(panels):
        items += _draw_panel(panel, _HEAD + k * _PANEL)
    height = _HEAD + _PANEL * len(panels)
    return Scene(width=_WIDTH, height=height, items=tuple(items), title=title)


def draw_message(text: str, *, title: str) -> Scene:
    """Draw a sheet that says why there is no chart on it."""
    items = (_headline(title), _words(text, (16, 64), color=_FAINT))
    return Scene(width=_WIDTH, height=100, items=items, title=f"{title}: {text}")


def _headline(title: str) -> Words:
    short = title if len(title) <= _LONGEST else title[: _LONGEST - 3] + "..."
    return _words(short, (16, 30), size=_TITLE)


def _draw_panel(panel: Panel, top: float) -> list[Item]:
    """Everything of a panel whose upper edge is at `top`."""
    left, right = _LEFT, _WIDTH - _RIGHT
    upper, lower = top + _TOP, top + _PANEL - _BOTTOM
    x_axis = linear_axis([c.xs[k] for c in panel.curves for k in c.shown], most=10, whole=True)
    y_axis = _left_axis([c.ys[k] for c in panel.curves if not c.right for k in c.shown])
    steps = [c.ys[k] for c in panel.curves if c.right for k in c.shown]
    right_axis = log_axis(steps) if steps else None

    def across(x: float) -> float:
        return left + x_axis.place(x) * (right - left)

    def up(axis: Axis) -> Callable[[float], float]:
        return lambda y: lower - axis.place(y) * (lower - upper)

    items: list[Item] = [_words(panel.title, (left, top + 18), size=13.0)]
    items += _legend(panel, left, top + 38)
    for value, text in y_axis.ticks:
        y = up(y_axis)(value)
        items.append(_rule((left, y), (right, y), _GRID))
        items.append(_words(text, (left - 8, y + 4), color=_FAINT, anchor="end"))
    for value, text in x_axis.ticks:
        x = across(value)
        items.append(_rule((x, lower), (x, lower + 4), _FRAME))
        items.append(_words(text, (x, lower + 17), color=_FAINT, anchor="middle"))
    if right_axis is not None:
        for value, text in right_axis.ticks:
            y = up(right_axis)(value)
            items.append(_rule((right, y), (right + 4, y), _FRAME))
            items.append(_words(text, (right + 8, y + 4), color=_FAINT))
        middle = (_WIDTH - 8.0, (upper + lower) / 2)
        items.append(_words(panel.right_label, middle, anchor="middle", upward=True))
        items.append(_rule((right, upper), (right, lower), _FRAME))
    items.append(_rule((left, upper), (left, lower), _FRAME))
    items.append(_rule((left, lower), (right, lower), _FRAME))
    for curve in panel.curves:
        axis = right_axis if curve.right and right_axis is not None else y_axis
        places = {k: (across(curve.xs[k]), up(axis)(curve.ys[k])) for k in curve.shown}
        items += _draw_curve(curve, places)
    items.append(_words(panel.y_label, (20, (upper + lower) / 2), anchor="middle", upward=True))
    items.append(_words(panel.x_label, ((left + right) / 2, lower + 34), anchor="middle"))
    if panel.notes:
        notes = _words("; ".join(panel.notes), (right, top + 18), color=_FAINT, anchor="end")
        items.append(notes)
    return items


def _left_axis(values: list[float]) -> Axis:
    wide = values and min(values) > _SMALLEST and max(values) > _WIDE * min(values)
    return log_axis(values) if wide else linear_axis(values)


def _draw_curve(curve: Curve, places: dict[int, Point]) -> list[Item]:
    """A line through each run of neighbours, and dots for what stands alone or is hollow."""
    lines: list[Item] = []
    dots: list[Item] = []
    run: list[Point] = []
    for k in range(len(curve.ys) + 1):
        joined = curve.line and k in places and k not in curve.hollow
        if joined:
            run.append(places[k])
            continue
        if len(run) == 1:
            dots.append(_dot(run[0], curve))
        elif run:
            lines.append(
                Line(points=tuple(run), color=curve.color, width=curve.width, name=curve.name)
            )
        run = []
        if k in places:
            grey = curve.pale if not curve.line else ()
            dots.append(
                _dot(
                    places[k],
                    curve,
                    hollow=k in curve.hollow,
                    color=_FRAME if k in grey else curve.color,
                )
            )
    return lines + dots


def _dot(center: Point, curve: Curve, *, hollow: bool = False, color: Color | None = None) -> Dot:
    radius = _RADIUS if curve.line else 1.5 * _RADIUS
    return Dot(
        center=center, radius=radius, color=color or curve.color, hollow=hollow, name=curve.name
    )


def _legend(panel: Panel, left: float, y: float) -> list[Item]:
    """A stroke or dot and a name for each curve, side by side."""
    items: list[Item] = []
    x = left
    for curve in sorted(panel.curves, key=lambda curve: curve.right):
        if curve.line:
            ends = ((x, y - 4), (x + 22, y - 4))
            items.append(Line(points=ends, color=curve.color, width=curve.width))
        else:
            items.append(Dot(center=(x + 11, y - 4), radius=1.5 * _RADIUS, color=curve.color))
        items.append(_words(curve.name, (x + 28, y)))
        x += 28 + _LETTER * _TYPE * len(curve.name) + 22
    return items


def _rule(start: Point, end: Point, color: Color) -> Line:
    return Line(points=(start, end), color=color)


def _words(
    text: str,
    at: Point,
    *,
    size: float = _TYPE,
    color: Color = _INK,
    anchor: Anchor = "start",
    upward: bool = False,
) -> Words:
    return Words(text=text, at=at, size=size, color=color, anchor=anchor, upward=upward)
