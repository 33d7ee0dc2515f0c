"""How a search went: cost per generation and per iteration (Fig. 6).

A result keeps a record of every round of its stages (``Result.history``, and "history" in
``.json``). Here they become a chart (:mod:`moseg_core.view.chart`) of up to three panels:

- *seeding*: mean (blue) and best (black) cost of each generation of the evolutionary seeder. The
  mean is over the individuals of a generation, the best is the best so far. K-means knows no cost;
  what is shown of it is how far its centres still move.
- *search*: cost after each iteration of the pattern search, and the pattern size ``Delta`` with
  which it polled. A search on super-elements is followed by one on the input elements, the polish,
  as a curve of its own: the same segmentation costs a little more or less on the other level.
- *starts*: what each start came to, where there were several. Those in grey were given up early.
- *number of parts*: what each number that was tried came to, where it was to be found.

The first two are the two halves of the paper's figure.

A cost with an empty part leaves out the terms about it, so it says nothing beside the others: such
values are hollow and stand apart from the line. Infinite ones (null in ``.json``) are left out, and
counted. Stages that were not run have no panel; a seeder of another bundle has one if its records
have ``best`` or ``largest_step``, an optimizer if they have ``value``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from moseg_core.errors import UsageError, unknown
from moseg_core.view.chart import Curve, Panel, draw_chart, draw_message
from moseg_core.view.palette import part_colors
from moseg_core.view.scene import Color, Scene

FORMATS = ("svg", "png")
"""What a chart can be written as."""

Record = Mapping[str, Any]
History = Mapping[str, Sequence[Record]]

_BLACK: Color = (34, 34, 34)
_NOTHING = "No search was recorded: nothing was seeded, and nothing was optimised."


def render_convergence(
    history: History, *, format: str = "svg", title: str = "Convergence"
) -> bytes:
    """Draw the convergence curves of a result.

    Parameters
    ----------
    history : mapping of str to sequence of mapping
        ``Result.history``, or the same as read from ``.json``, where None stands for infinity. The
        stages "seeding", "search", "polish", "restarts" and "number of parts" are drawn.
    format : {"svg", "png"}
        A PNG has two pixels for each unit of the SVG.
    title : str
        Written at the top left.

    Returns
    -------
    bytes
        A file; equal arguments give equal bytes. Where nothing can be drawn, it says so.

    Raises
    ------
    UsageError
        An unknown format.

    Examples
    --------
    >>> search = [{"evaluations": 1, "value": 2.5, "empty": 0, "step": 0.2},
    ...           {"evaluations": 17, "value": 1.5, "empty": 0, "step": 0.2}]
    >>> render_convergence({"search": search}, title="hammer").decode().count("<polyline") > 2
    True
    """
    if format not in FORMATS:
        raise UsageError(unknown("chart format", format, FORMATS))
    scene = convergence_scene(history, title=title)
    if format == "svg":
        from moseg_core.view.svg import encode_svg

        return encode_svg(scene)
    from moseg_core.view.png import encode_png

    return encode_png(scene)


def convergence_scene(history: History, *, title: str) -> Scene:
    """The drawing that :func:`render_convergence` encodes.

    Parameters
    ----------
    history : mapping of str to sequence of mapping
    title : str

    Returns
    -------
    Scene
    """
    drawn = (_seeding(history), _search(history), _restarts(history), _numbers_tried(history))
    panels = [panel for panel in drawn if panel is not None]
    return draw_chart(panels, title=title) if panels else draw_message(_NOTHING, title=title)


def _seeding(history: History) -> Panel | None:
    """Cost per generation, or the movement of the centres per round."""
    records = _records(history, "seeding")
    if any("best" in record for record in records):
        blue = _palette(0)
        generations = _counted(records)
        hollow = _with_empty_parts(records)
        mean = Curve(name="mean", xs=generations, ys=_numbers(records, "mean"), color=blue)
        best = Curve(
            name="best so far",
            xs=generations,
            ys=_numbers(records, "best"),
            color=_BLACK,
            hollow=hollow,
        )
        return _panel("Seeding by evolution", "generation", "cost", [mean, best])
    if any("largest_step" in record for record in records):
        step = Curve(
            name="largest step of a centre",
            xs=_counted(records),
            ys=_numbers(records, "largest_step"),
            color=_BLACK,
        )
        return _panel("Seeding by k-means", "round", "step (diagonals)", [step])
    return None


def _search(history: History) -> Panel | None:
    """Cost and pattern size per iteration, of the search and of the polish that follows it."""
    search, polish = _records(history, "search"), _records(history, "polish")
    records = search + polish
    iterations = _counted(records)

    def cost(part: list[Record], name: str, color: Color, *, after: int) -> Curve:
        return Curve(
            name=name,
            xs=iterations[after : after + len(part)],
            ys=_numbers(part, "value"),
            color=color,
            hollow=_with_empty_parts(part),
            width=2.0,
        )

    curves = [
        Curve(
            name="pattern size (right)",
            xs=iterations,
            ys=_numbers(records, "step"),
            color=_palette(2),
            width=0.8,
            right=True,
        ),
        cost(search, "cost", _BLACK, after=0),
        cost(polish, "cost while polishing", _palette(6), after=len(search)),
    ]
    return _panel("Pattern search", "iteration", "cost", curves, right="pattern size (diagonals)")


def _restarts(history: History) -> Panel | None:
    """What the starts came to, where there were several."""
    records = _records(history, "restarts")
    if len(records) < 2:
        return None
    finalist = _numbers(records, "finalist")
    given_up = frozenset(k for k, value in enumerate(finalist) if value == 0.0)
    ends = Curve(
        name="cost of a start",
        xs=_counted(records),
        ys=_numbers(records, "value"),
        color=_BLACK,
        hollow=_with_empty_parts(records),
        pale=given_up,
        line=False,
    )
    notes = ["grey: given up early"] if given_up else []
    return _panel("Starts", "start", "cost", [ends], notes=notes)


def _numbers_tried(history: History) -> Panel | None:
    """What each number of parts came to, where several were tried."""
    records = _records(history, "number of parts")
    tried = Curve(
        name="cost of a number of parts",
        xs=_numbers(records, "parts"),
        ys=_numbers(records, "cost"),
        color=_BLACK,
        hollow=_with_empty_parts(records),
        line=False,
    )
    return _panel("Number of parts", "parts", "cost", [tried])


def _panel(
    title: str,
    x_label: str,
    y_label: str,
    curves: Sequence[Curve],
    *,
    right: str = "",
    notes: Iterable[str] = (),
) -> Panel | None:
    """A panel of the curves that have a value to show, with notes on those that do not compare."""
    shown = [curve for curve in curves if curve.shown]
    if not any(not curve.right for curve in shown):
        return None
    lines = list(notes)
    if any(k in curve.hollow for curve in shown for k in curve.shown):
        lines.append("hollow: with an empty part")
    missing = sum(_infinite(curve) for curve in curves if not curve.right)
    if missing:
        lines.append(f"infinite, left out: {missing}")
    return Panel(
        title=title,
        x_label=x_label,
        y_label=y_label,
        curves=tuple(shown),
        right_label=right if any(curve.right for curve in shown) else "",
        notes=tuple(lines),
    )


def _infinite(curve: Curve) -> int:
    """How many values of a curve are infinite or next to it; what is absent (NaN) is not."""
    shown = set(curve.shown)
    return sum(1 for k, y in enumerate(curve.ys) if k not in shown and not math.isnan(y))


def _records(history: History, stage: str) -> list[Record]:
    return list(history.get(stage, ()))


def _counted(records: Sequence[Record]) -> tuple[float, ...]:
    """The number of each record, from 1."""
    return tuple(float(k) for k in range(1, len(records) + 1))


def _numbers(records: Sequence[Record], key: str) -> tuple[float, ...]:
    """A value of each record: NaN where it has none, infinity where it is null."""
    values = (record.get(key, math.nan) for record in records)
    return tuple(math.inf if value is None else float(value) for value in values)


def _with_empty_parts(records: Sequence[Record]) -> frozenset[int]:
    return frozenset(k for k, empty in enumerate(_numbers(records, "empty")) if empty > 0.0)


def _palette(k: int) -> Color:
    red, green, blue = part_colors(k + 1)[k].tolist()
    return red, green, blue
