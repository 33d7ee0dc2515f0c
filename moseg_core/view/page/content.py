"""What a page shows: a shape, its labels, and what is known of how good they are.

A result of a search knows all of it (:meth:`PageContent.of_result`). Labels from a file have no
cost, may have no names, and may leave elements without a label.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from moseg_core.problem.aggregate import Evaluation
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, IntArray
from moseg_core.view.page.steps import SearchSteps, search_steps

if TYPE_CHECKING:
    from moseg_core.clipping.clip import Clipped


@dataclass(frozen=True, eq=False, kw_only=True)
class PageContent:
    """A labelled shape to be shown.

    Parameters
    ----------
    shape : Shape
    labels : (F,) int
        The label of each element, from 0; -1 where it has none.
    names : tuple of str
        What the labels are called; text of any kind.
    evaluation : Evaluation or None
        Cost by term and part, where it is known.
    warnings : tuple of str
        What a reader should know of the labels.
    centers : (n, 3) float, model units, or None
        A centre for each label to begin with when centres are placed by hand; not finite where a
        label has none. Without them, centres cannot be placed.
    clipped : Clipped or None
        The surface with its boundaries cut, to be drawn in place of the shape's own.
    search : SearchSteps or None
        How the search went, where that is known.
    """

    shape: Shape
    labels: IntArray
    names: tuple[str, ...]
    evaluation: Evaluation | None = None
    warnings: tuple[str, ...] = ()
    centers: FloatArray | None = None
    clipped: Clipped | None = None
    search: SearchSteps | None = None

    @classmethod
    def of_result(cls, result: Result) -> PageContent:
        """What there is to show of a result."""
        labels = result.labels.astype(np.int64)
        names = result.problem.labels
        # The centres that a search ends with have weights, which no option can give.
        levels = isinstance(result.problem, Hierarchy)
        centers = None if levels else middle_places(result.shape, labels, len(names))
        return cls(
            shape=result.shape,
            labels=labels,
            names=names,
            evaluation=result.evaluation,
            warnings=result.warnings,
            centers=centers,
            clipped=result.clipped,
            search=search_steps(result),
        )


def middle_places(shape: Shape, labels: IntArray, n_labels: int) -> FloatArray:
    """For each label the place of its element that is nearest to the middle of its part.

    Parameters
    ----------
    shape : Shape
    labels : (F,) int
        From 0; -1 for none.
    n_labels : int

    Returns
    -------
    (n_labels, 3) float, model units
        Not a number where a label has no element.

    Examples
    --------
    >>> import numpy as np
    >>> row = Shape.from_points([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]])
    >>> middle_places(row, np.array([0, 0, 0, 2]), 3)[:, 0].tolist()
    [1.0, nan, 3.0]
    """
    places = np.full((n_labels, 3), np.nan)
    for label in range(n_labels):
        members = np.flatnonzero(labels == label)
        if len(members) == 0:
            continue
        points, areas = shape.points[members], shape.areas[members]
        weights = areas / areas.sum() if areas.sum() > 0.0 else np.full(len(areas), 1 / len(areas))
        away = np.linalg.norm((points - weights @ points) / shape.frame.scale, axis=1)
        places[label] = points[np.argmin(away)]
    return places
