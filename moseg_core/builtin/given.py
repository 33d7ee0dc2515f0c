"""Centres placed by hand (Sec. 5.2: where "automation is still desired" it can start from them).

Written ``handle=x,y,z,head=x,y,z``, in model units; every label has a centre, so no labels are
assigned afterwards. They are places on the shape as the user knows it: where the partition lives in
an embedding (Sec. 9), the image of the element nearest to a centre stands for it.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import cKDTree

from moseg_core.components.protocols import Centers, Evaluator, Report, Seeding
from moseg_core.errors import UsageError, unknown
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray


class Given:
    """The user's own centres.

    Parameters
    ----------
    centers : str
        ``label=x,y,z`` for every label, separated by commas.
    """

    def __init__(self, *, centers: str) -> None:
        self.centers = centers

    @staticmethod
    def example(evaluator: Evaluator) -> dict[str, str]:
        """Centres on elements, all over the shape: parameters to try the component with."""
        points, labels = evaluator.shape.points, evaluator.problem.labels
        chosen = np.linspace(0, len(points) - 1, len(labels)).astype(np.int64)
        places = [
            f"{label}={','.join(repr(float(x)) for x in points[k])}"
            for label, k in zip(labels, chosen, strict=True)
        ]
        return {"centers": ",".join(places)}

    def __call__(
        self, evaluator: Evaluator, *, rng: np.random.Generator, report: Report
    ) -> Seeding:
        """The centres in the order of the problem's labels.

        Raises
        ------
        UsageError
            Malformed, an unknown label, a label without a centre, or one whose centre lies where
            it gets no part.
        """
        labels = evaluator.problem.labels
        centers = _image(parse_centers(self.centers, labels), evaluator.input.shape)
        # Super-elements may be too large for a small part that the input elements can make.
        vector = evaluator.input.parameterization.encode(
            Centers(positions=centers, weights=np.ones(len(labels)))
        )
        for name in evaluator.input.evaluate(vector).empty:
            raise UsageError(
                f"centers: label '{name}' gets no part of the surface, since other centres are"
                f" nearer everywhere; move its centre to where the part is"
            )
        return Seeding(centers=centers, labelled=True)


def _image(centers: FloatArray, shape: Shape) -> FloatArray:
    """Where the places of centres are after the embedding; as they are where there is none."""
    if shape.original is None:
        return centers
    _, nearest = cKDTree(shape.original.points).query(centers)
    image: FloatArray = shape.points[nearest]
    return image


def parse_centers(text: str, labels: tuple[str, ...]) -> FloatArray:
    """(n, 3) float: a centre for each label.

    Raises
    ------
    UsageError
        See :class:`Given`.

    Examples
    --------
    >>> parse_centers("b=1,0,0, a=0,0,2.5", ("a", "b")).tolist()
    [[0.0, 0.0, 2.5], [1.0, 0.0, 0.0]]
    """
    found: dict[str, list[float]] = {}
    name = ""
    for piece in text.split(","):
        key, equals, number = piece.rpartition("=")
        if equals:
            name = key.strip()
            if name not in labels:
                raise UsageError(f"centers: {unknown('label', name, labels)}")
            if name in found:
                raise UsageError(f"centers: label '{name}' is given twice")
            found[name] = []
        try:
            value = float(number)
        except ValueError:
            value = math.nan
        if not name or not math.isfinite(value):
            raise UsageError(
                f"centers: '{piece.strip()}' is not understood; write label=x,y,z,label=x,y,z"
            )
        found[name].append(value)
    for label in labels:
        if len(found.get(label, [])) != 3:
            given = f"{len(found[label])} numbers" if label in found else "none"
            raise UsageError(f"centers: label '{label}' needs three coordinates, and has {given}")
    return np.array([found[label] for label in labels])
