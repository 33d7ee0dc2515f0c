"""Fewer samples and triangles for the surface distances of parts of a coarse shape.

While moseg searches on super-elements (``part.level``), an integral over a part's surface needs
no more than some hundred samples, and a distance no finer surface than some thousand triangles
over the whole shape. Both are chosen once for each coarse shape, so that what a part costs does
not grow with the mesh. Values then differ from the exact ones by less than 5 %, or 5e-5 where they
are smaller than 1e-3; the final evaluation, on input elements, is always exact.
"""

from __future__ import annotations

from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from moseg_core import Part, Shape, coarsen

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_SAMPLES = 600
_SURFACE = 5000


class Thinned:
    """What stands for the surface of a coarse shape.

    Parameters
    ----------
    level : Shape
        A coarse one.
    """

    def __init__(self, level: Shape) -> None:
        assert level.members is not None  # a coarse shape
        self._fine, self._members = level.input, level.members
        self._sizes, self._areas = level.sizes, level.areas
        self._chosen: dict[int, tuple[IntArray, FloatArray, IntArray]] = {}

    def samples(self, part: Part) -> tuple[FloatArray, FloatArray] | None:
        """Some of the part's elements, at equal areas within each super-element.

        Parameters
        ----------
        part : Part
            Of the same coarse shape.

        Returns
        -------
        points : (k, 3) float, model units
        weights : (k,) float, model units squared
            They add up to the part's area. None where this would leave out too little to be
            worth while, or nothing at all.
        """
        groups = part.level_elements
        each = -(-_SAMPLES // len(groups))
        if 3 * each * len(groups) > 2 * part.n_elements:
            return None
        if each not in self._chosen:
            self._chosen[each] = self._choose(each)
        elements, weights, starts = self._chosen[each]
        inside = _ranges(starts, groups)
        return self._fine.points[elements[inside]], weights[inside]

    def surface(self, part: Part) -> tuple[FloatArray, IntArray] | None:
        """Vertices and triangles of a coarser surface of the part; None where that saves nothing.

        Parameters
        ----------
        part : Part
            Of the same coarse shape.
        """
        if len(self._fine.geometry.triangles) < 3 * _SURFACE:
            return None
        vertices, triangles, starts = self._surface
        found = triangles[_ranges(starts, part.level_elements)]
        return (vertices, found) if len(found) >= 200 else None

    @cached_property
    def _order(self) -> IntArray:
        """Input elements by super-element, within each along its longest direction."""
        centers = np.stack(
            [np.bincount(self._members, column) for column in self._fine.points.T], axis=1
        )
        apart = self._fine.points - (centers / self._sizes[:, None])[self._members]
        pairs = apart[:, :, None] * apart[:, None, :]
        spread = np.stack(
            [np.bincount(self._members, column) for column in pairs.reshape(-1, 9).T], axis=1
        )
        axis = np.linalg.eigh(spread.reshape(-1, 3, 3))[1][:, :, 2]
        along = np.einsum("fi,fi->f", apart, axis[self._members])
        order: IntArray = np.lexsort((along, self._members))
        return order

    def _choose(self, each: int) -> tuple[IntArray, FloatArray, IntArray]:
        """Up to so many elements of every super-element, their weights, where each begins."""
        count = np.minimum(self._sizes, each)
        starts = np.concatenate([[0], np.cumsum(count)])
        group = np.repeat(np.arange(len(count)), count)
        rank = np.arange(len(group)) - starts[group]
        ends = np.cumsum(self._sizes)
        run = np.cumsum(self._fine.areas[self._order])
        before = np.concatenate([[0.0], run])[ends - self._sizes]
        share = self._areas / count
        wanted = before[group] + (rank + 0.5) * share[group]
        first = (ends - self._sizes)[group]
        place = np.searchsorted(run, wanted).clip(first, ends[group] - 1)
        return self._order[place], share[group], starts

    @cached_property
    def _surface(self) -> tuple[FloatArray, IntArray, IntArray]:
        """Vertices clustered, the triangles that are left, sorted by super-element."""
        geometry = self._fine.geometry
        cluster = coarsen(self._fine, _SURFACE).members
        assert cluster is not None  # a coarse shape
        of_vertex = np.zeros(len(geometry.vertices), np.int64)
        of_vertex[geometry.triangles.reshape(-1)] = np.repeat(cluster[geometry.triangle_polygon], 3)
        of_vertex = of_vertex[np.unique(geometry.merged, return_index=True)[1]][geometry.merged]
        size = int(cluster.max()) + 1
        used = np.unique(geometry.triangles)
        number = np.bincount(of_vertex[used], minlength=size).clip(min=1)
        vertices = np.stack(
            [np.bincount(of_vertex[used], c, size) for c in geometry.vertices[used].T], axis=1
        )
        triangles = of_vertex[geometry.triangles]
        following = np.roll(triangles, 1, axis=1)
        proper = (triangles != following).all(axis=1)
        owner = self._members[geometry.triangle_polygon[proper]]
        order = np.argsort(owner, kind="stable")
        starts = np.searchsorted(owner[order], np.arange(len(self._sizes) + 1))
        return vertices / number[:, None], triangles[proper][order], starts


def _ranges(starts: IntArray, groups: IntArray) -> IntArray:
    """The numbers ``starts[g]`` to ``starts[g + 1] - 1`` of some groups, one after the other."""
    count = starts[groups + 1] - starts[groups]
    before = np.cumsum(count) - count
    return np.repeat(starts[groups] - before, count) + np.arange(int(count.sum()))


_KNOWN: WeakKeyDictionary[Shape, Thinned] = WeakKeyDictionary()


def thinned(part: Part) -> Thinned | None:
    """What stands for the surface of the part's coarse shape; None for a part of input elements."""
    level = part.level
    if level.fine is None:
        return None
    if level not in _KNOWN:
        _KNOWN[level] = Thinned(level)
    return _KNOWN[level]
