"""Pictures of a result, and of how it was found, as formats that results are saved in."""

from __future__ import annotations

from moseg_core.search.result import Result
from moseg_core.view.convergence import render_convergence
from moseg_core.view.picture import render_picture
from moseg_core.view.point_bodies import drawable


def write_png(result: Result) -> bytes:
    """A picture from two sides, with a legend and the cost."""
    title = f"{result.shape.name}, cost {result.cost:.4g}"
    surface, labels = result.surface
    areas = None if result.shape.has_surface else result.shape.areas
    return render_picture(
        drawable(surface),
        labels,
        result.problem.labels,
        title=title,
        areas=areas,
        up=result.shape.up,
    )


def write_svg(result: Result) -> bytes:
    """The convergence curves (Fig. 6), with the name and the cost."""
    title = f"{result.shape.name}, cost {result.cost:.4g}"
    return render_convergence(result.history, format="svg", title=title)
