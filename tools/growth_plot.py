"""The plot of docs/speed.md: seconds and memory over the number of faces, both logarithmic.

A straight line is a power of the number of faces, and one that rises as the grey rule grows in
proportion to it. Drawn as moseg draws its own charts (:mod:`moseg_core.view`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from moseg_core.view.axis import Axis, log_axis
from moseg_core.view.palette import part_colors
from moseg_core.view.scene import Color, Dot, Item, Line, Scene, Words
from moseg_core.view.svg import encode_svg

_WIDTH, _HEIGHT, _TOP, _BOTTOM = 860, 380, 90, 330
_INK, _FAINT, _GRID, _RULE = (34, 34, 34), (96, 96, 96), (232, 232, 232), (190, 190, 190)

#: By panel its left and right edge, and by curve the end of the name of its records.
_PANELS: dict[str, tuple[float, float, dict[str, str]]] = {
    "seconds": (
        70,
        400,
        {
            "everything": ": seconds",
            "read": ", one process: read",
            "fields": ", one process: fields",
            "search": ", one process: search",
            "polish": ", one process: polish",
        },
    ),
    "memory, GB": (510, 840, {"memory": ": memory"}),
}


def meshes(run: Mapping[str, Any]) -> list[int]:
    """The numbers of faces that growth was measured at, rising; empty where it was not."""
    whats = [record["what"] for record in run["records"] if record["job"] == "growth"]
    ending = ": faces"
    return sorted(int(what.removesuffix(ending)) for what in whats if what.endswith(ending))


def growth_plot(run: Mapping[str, Any]) -> bytes:
    """The plot as SVG.

    Parameters
    ----------
    run : mapping
        What ``benchmarks/speed.py --json`` writes, with the job growth in it.
    """
    sizes = meshes(run)
    medians = {r["what"]: r["median"] for r in run["records"] if r["job"] == "growth"}
    title = "Seconds and memory over the number of faces, recipe hammer"
    items: list[Item] = [_words(title, (16, 30), size=16.0)]
    for label, (left, right, curves) in _PANELS.items():
        values = {
            name: [(size, medians[f"{size}{end}"]) for size in sizes if f"{size}{end}" in medians]
            for name, end in curves.items()
        }
        items += _panel(label, (left, right), sizes, values)
    return encode_svg(Scene(width=_WIDTH, height=_HEIGHT, items=tuple(items), title=title))


def _panel(
    label: str,
    edges: tuple[float, float],
    sizes: Sequence[int],
    curves: Mapping[str, Sequence[tuple[int, float]]],
) -> list[Item]:
    """Two axes and what is drawn between them."""
    left, right = edges
    x_axis = log_axis(sizes)
    shown = [y for points in curves.values() for _, y in points if y > 0.0]
    y_axis = log_axis(shown)

    def at(x: float, y: float) -> tuple[float, float]:
        up = y_axis.place(y)
        return left + x_axis.place(x) * (right - left), _BOTTOM - up * (_BOTTOM - _TOP)

    items = _axes(label, edges, x_axis, y_axis)
    # In proportion to the faces, as far as that goes within the axes.
    low = max(x_axis.low, sizes[-1] * y_axis.low / y_axis.high)
    ends = at(low, y_axis.high * low / sizes[-1]), at(sizes[-1], y_axis.high)
    items.append(Line(points=ends, color=_RULE, name="in proportion to the number of faces"))
    colors: list[Color] = [tuple(color) for color in part_colors(len(curves)).tolist()]
    across = left
    for (name, points), color in zip(curves.items(), colors, strict=True):
        places = tuple(at(x, y) for x, y in points if y > 0.0)
        if len(places) > 1:
            items.append(Line(points=places, color=color, width=2.0, name=name))
        items += [Dot(center=place, radius=3.0, color=color, name=name) for place in places]
        items.append(Dot(center=(across + 4, _TOP - 20), radius=4.0, color=color))
        items.append(_words(name, (across + 13, _TOP - 16)))
        across += 30 + 6.5 * len(name)
    return items


def _axes(label: str, edges: tuple[float, float], x_axis: Axis, y_axis: Axis) -> list[Item]:
    left, right = edges
    items: list[Item] = []
    for value, text in y_axis.ticks:
        y = _BOTTOM - y_axis.place(value) * (_BOTTOM - _TOP)
        items.append(Line(points=((left, y), (right, y)), color=_GRID))
        items.append(_words(text, (left - 8, y + 4), color=_FAINT, anchor="end"))
    for value, text in x_axis.ticks:
        x = left + x_axis.place(value) * (right - left)
        items.append(Line(points=((x, _BOTTOM), (x, _BOTTOM + 4)), color=_FAINT))
        items.append(_words(text, (x, _BOTTOM + 18), color=_FAINT, anchor="middle"))
    frame = ((left, _TOP), (left, _BOTTOM), (right, _BOTTOM))
    items.append(Line(points=frame, color=_FAINT))
    middle = (left + right) / 2
    items.append(_words("faces", (middle, _BOTTOM + 36), anchor="middle"))
    items.append(_words(label, (left, _TOP - 40), size=13.0))
    return items


def _words(
    text: str,
    at: tuple[float, float],
    *,
    size: float = 12.0,
    color: Color = _INK,
    anchor: Any = "start",
) -> Words:
    return Words(text=text, at=at, size=size, color=color, anchor=anchor)
