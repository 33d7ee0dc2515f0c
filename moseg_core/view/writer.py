"""The picture of a result, as a format that results are saved in."""

from __future__ import annotations

from moseg_core.result import Result
from moseg_core.splats import drawable
from moseg_core.view.picture import render_picture


def write_png(result: Result) -> bytes:
    """A picture from two sides, with a legend and the cost."""
    title = f"{result.shape.name}, cost {result.cost:.4g}"
    names = result.problem.labels
    shape = result.shape
    drawn, areas = drawable(shape.geometry), shape.areas / shape.area
    return render_picture(drawn, result.labels, names, title=title, areas=areas)
