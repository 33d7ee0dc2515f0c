"""Multiplicatively weighted Voronoi partitions as a parameterization (Sec. 4).

A segmentation of n parts is a vector of m = 4n numbers, position and weight of each centre,
``(x_1, y_1, z_1, w_1, ..., x_n, y_n, z_n, w_n)``. An element at ``p`` belongs to the centre with
the least ``||p - c|| / w``. Where the adjacency is known the segments are kept connected by
flooding from the centres (Algorithm 1, :mod:`moseg_core.builtin.flood`).

A body is not one cell. A part may have several centres, whose cells together are the part: four
numbers for each, those of a part one after the other. Where one centre of several is in the place
of another, with the same weight, it makes no difference; so a seeder's single centre for each part
is a vector too, and the search moves the others out from there.

Vectors are in unit coordinates (bounding-box diagonal 1), so that one pattern size serves
positions and weights alike. Source: Okabe et al., Spatial Tessellations, 2nd ed., 2000,
Sec. 3.1.
"""

from __future__ import annotations

import fnmatch
import itertools
import re
from collections.abc import Sequence

import numpy as np

from moseg_core.builtin.flood import (
    Workspace,
    flood_labels,
    flood_parts,
    voronoi_labels,
    workspace,
)
from moseg_core.components.protocols import Centers, centers_of_parts
from moseg_core.errors import UsageError, unknown
from moseg_core.shape.row_threads import over_rows
from moseg_core.shape.shape import Shape
from moseg_core.types import BoolArray, FloatArray, Int32Array, IntArray

#: With centers="auto" a part that is expected to have more than this share of the area gets so
#: many centres more.
_LARGE, _MORE = 0.25, 2
#: About how long it takes to find a label.
_COUNT = re.compile(r"0*[1-9][0-9]{0,2}")  # of centres of a label
_SECONDS = 5e-8


class Voronoi:
    """Weighted Voronoi partitions of a shape into `n_parts` parts.

    Parameters
    ----------
    shape : Shape
    n_parts : int
    connected : bool
        Whether segments are kept connected; has no effect on a shape without adjacency. Of a part
        with several centres only what is joined to the first is kept, and what its other centres
        reach apart from that goes to other parts.
    centers : str
        How many centres some parts have, ``label=count,label=count``, globs allowed:
        ``"body=3,leg*=2"``. All others have one. Or ``auto``: three for each label that is expected
        to have more than a quarter of the area, as terms such as ``area_fraction`` say.
    labels : sequence of str
        What the parts are called; needed where `centers` are given.
    expected_shares : (n,) float, optional
        The share of the area that each part is expected to have, NaN where nothing is known.

    Raises
    ------
    UsageError
        Malformed `centers`, an unknown label, one that is given twice, or a count below 1.

    Examples
    --------
    >>> import numpy as np
    >>> shape = Shape.from_mesh([[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
    ...                         [[0, 5, 4, 3], [5, 1, 2, 4]])
    >>> voronoi = Voronoi(shape, 2)
    >>> at = Centers(positions=np.array([[4., 0, 0], [0, 0, 0]]), weights=np.ones(2))
    >>> voronoi.labels(voronoi.encode(at)[None]).tolist()
    [[1, 0]]
    >>> Voronoi(shape, 2, centers="body=3", labels=["head", "body"]).centers_per_part.tolist()
    [1, 3]
    """

    weighted_bisectors = True

    def __init__(
        self,
        shape: Shape,
        n_parts: int,
        *,
        connected: bool = True,
        centers: str = "",
        labels: Sequence[str] = (),
        expected_shares: FloatArray | None = None,
    ) -> None:
        self._shape = shape
        self._n_parts = n_parts
        self.connected = connected and shape.adjacency is not None
        self._counts = np.ones(n_parts, np.int64)
        if centers == "auto":
            if expected_shares is not None:
                self._counts[np.asarray(expected_shares) > _LARGE] += _MORE
        elif centers:
            if len(labels) != n_parts:
                raise UsageError(f"centers: the names of all {n_parts} labels are needed too")
            self._counts = np.array(list(parse_counts(centers, labels).values()), np.int64)
        self._starts = np.cumsum(self._counts) - self._counts
        self._total = int(self._counts.sum())
        self._several = self._total > n_parts
        self._parts = np.repeat(np.arange(n_parts, dtype=np.int32), self._counts)
        self._spare: list[Workspace] = []
        self._component: IntArray | None = None
        if self._several and self.connected and shape.adjacency is not None:
            self._component = shape.adjacency.components()[1]

    def _workspace(self) -> Workspace:
        return workspace(self._total, self._shape.n_elements)

    @property
    def n_parts(self) -> int:
        """Number of parts, n."""
        return self._n_parts

    @property
    def centers_per_part(self) -> IntArray:
        """(n,) int: how many centres each part has, c in all."""
        return self._counts.copy()

    @property
    def lower(self) -> FloatArray:
        """(4c,) float: positions are free, weights are positive."""
        smallest = np.finfo(np.float64).tiny
        return np.tile([-np.inf, -np.inf, -np.inf, smallest], self._total)

    @property
    def upper(self) -> FloatArray:
        """(4c,) float: unbounded."""
        return np.full(4 * self._total, np.inf)

    @property
    def scale(self) -> FloatArray:
        """(4c,) float: 1 for positions, in bounding-box diagonals, and for weights alike."""
        return np.ones(4 * self._total)

    def labels(self, vectors: FloatArray) -> Int32Array:
        """(B, F) int32: the partitions that (B, 4c) vectors describe."""
        rows = np.ascontiguousarray(vectors, dtype=np.float64).reshape(-1, self._total, 4)
        labels = np.empty((len(rows), self._shape.n_elements), np.int32)
        points = np.ascontiguousarray(self._shape.unit_points)
        adjacency = self._shape.adjacency if self.connected else None
        needed = self._needed(rows)

        def partition(first: int, end: int) -> None:
            # One of its own for each thread at work; they are kept for the next batch.
            try:
                space = self._spare.pop()
            except IndexError:  # asked for and taken in one step: another thread may be faster
                space = self._workspace()
            for b in range(first, end):
                write(b, *space)
            self._spare.append(space)

        def write(
            b: int, table: FloatArray, known: FloatArray, key: FloatArray, code: IntArray
        ) -> None:
            row, parts = rows[b], self._parts
            if self._several:
                row, parts = row[needed[b]], parts[needed[b]]
            centers, weights = np.ascontiguousarray(row[:, :3]), row[:, 3].copy()
            if adjacency is None:
                voronoi_labels(points, centers, weights, labels[b], table, known)
                if self._several:
                    labels[b] = parts[labels[b]]
                return
            graph = adjacency.indptr, adjacency.indices
            if len(row) == self._n_parts:
                flood_labels(points, centers, weights, *graph, labels[b], table, known, key, code)
            else:
                assert self._component is not None  # parts have several centres
                own = parts, self._component
                flood_parts(
                    points, centers, weights, *own, *graph, labels[b], table, known, key, code
                )

        over_rows(partition, len(rows), seconds=_SECONDS * labels.size)
        return labels

    def encode(self, centers: Centers) -> FloatArray:
        """(4c,) float: the vector of centres in model units."""
        own = centers.fitted(self._counts)
        unit = self._shape.frame.to_unit(own.positions)
        return np.column_stack([unit, own.weights]).reshape(-1)

    def decode(self, vector: FloatArray) -> Centers:
        """The centres of a vector, in model units."""
        rows = vector.reshape(-1, 4)
        return Centers(
            positions=self._shape.frame.to_model(rows[:, :3]),
            weights=rows[:, 3].copy(),
            parts=self._parts.astype(np.int64) if self._several else None,
        )

    def distances(self, vector: FloatArray, points: FloatArray) -> FloatArray:
        """(P, n) float: weighted distance of points (model units) to each part's nearest centre."""
        rows = vector.reshape(-1, 4)
        apart = self._shape.frame.to_unit(points)[:, None] - rows[None, :, :3]
        distance: FloatArray = np.sqrt((apart**2).sum(axis=2)) / rows[:, 3]
        return np.minimum.reduceat(distance, self._starts, axis=1) if self._several else distance

    def coordinates(self, part: int) -> IntArray:
        """(4k,) int: where in the vector the positions and weights of a part's k centres are."""
        first = 4 * int(self._starts[part])
        return np.arange(first, first + 4 * int(self._counts[part]))

    def permute(self, vector: FloatArray, order: IntArray) -> FloatArray:
        """(4c,) float: the vector with the centres of its parts in another order.

        Where parts have different numbers of centres it is that of :meth:`Centers.fitted` ones.
        """
        places = centers_of_parts(self._counts, self._counts, np.asarray(order))
        permuted: FloatArray = vector.reshape(-1, 4)[places].reshape(-1)
        return permuted

    def _needed(self, rows: FloatArray) -> BoolArray:
        """(B, c) bool: the centres that are not the same as an earlier one of their part.

        Parameters
        ----------
        rows : (B, c, 4) float
        """
        needed = np.ones(rows.shape[:2], np.bool_)
        for first, count in zip(self._starts.tolist(), self._counts.tolist(), strict=True):
            for j, k in itertools.combinations(range(first, first + count), 2):
                needed[:, k] &= (rows[:, j] != rows[:, k]).any(axis=1)
        return needed


def parse_counts(text: str, labels: Sequence[str]) -> dict[str, int]:
    """How many centres each label has, from ``label=count`` words.

    Parameters
    ----------
    text : str
    labels : sequence of str

    Returns
    -------
    dict of str to int
        For every label in order; 1 for those that no word names.

    Raises
    ------
    UsageError
        See :class:`Voronoi`.

    Examples
    --------
    >>> parse_counts("body=3, leg*=2", ["head", "body", "leg1", "leg2"])
    {'head': 1, 'body': 3, 'leg1': 2, 'leg2': 2}
    """
    found: dict[str, int] = {}
    for word in text.split(","):
        name, equals, number = (piece.strip() for piece in word.partition("="))
        if not equals or not _COUNT.fullmatch(number):
            raise UsageError(
                f"centers: '{word.strip()}' is not understood; write label=count,label=count, with"
                " counts from 1 to 999"
            )
        if "*" in name:
            named = [label for label in labels if fnmatch.fnmatchcase(label, name)]
            if not named:
                raise UsageError(
                    f"centers: '{name}' matches none of the labels {', '.join(labels)}"
                )
        elif name in labels:
            named = [name]
        else:
            raise UsageError(f"centers: {unknown('label', name, labels)}")
        for label in named:
            if label in found:
                raise UsageError(f"centers: label '{label}' is given twice")
            found[label] = int(number)
    return {label: found.get(label, 1) for label in labels}
