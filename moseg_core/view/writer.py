"""The picture of a result, as a format that results are saved in."""

from __future__ import annotations

from moseg_core.result import Result
from moseg_core.view.picture import render_picture


def write_png(result: Result) -> bytes:
    """A picture from two sides, with a legend and the cost."""
    title = f"{result.shape.name}, cost {result.cost:.4g}"
    mesh, labels = result.surface
    return render_picture(mesh, labels, result.problem.labels, title=title)
