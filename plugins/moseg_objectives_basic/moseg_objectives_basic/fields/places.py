"""Some thousand places for a large surface: what costs much is computed there, and carried over.

Elements are grouped as the search groups them (:func:`moseg_core.coarsen`): connected, of similar
area, and so that two sheets that lie close to each other do not come into one group.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from moseg_core import Shape, coarsen

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Places:
    """Groups of the elements of a shape, and one element of each to stand for it.

    Parameters
    ----------
    shape : Shape
        Whose elements are the groups.
    members : (F,) int
        The group of each element of the input.
    chosen : (K,) int
        Of each group the element that is nearest to its middle, of those that have an area.
    """

    shape: Shape
    members: IntArray
    chosen: IntArray

    @classmethod
    def of(cls, shape: Shape, most: int) -> Places:
        """At most about `most` groups; each element its own group where there are no more.

        Examples
        --------
        >>> import moseg_core as moseg
        >>> horse = moseg.load(moseg.sample_path("horse"))
        >>> places = Places.of(horse, 500)
        >>> len(places.chosen), len(places.members) == horse.n_elements
        (500, True)
        """
        numbers = np.arange(shape.n_elements)
        if shape.n_elements <= most:
            return cls(shape, numbers, numbers)
        groups = coarsen(shape, most)
        assert groups.members is not None  # a coarse shape
        members = np.asarray(groups.members, np.int64)
        away = ((shape.points - groups.points[members]) ** 2).sum(axis=1)
        away[~(shape.areas > 0)] = np.inf
        order = np.lexsort((away, members))
        first = np.searchsorted(members[order], np.arange(groups.n_elements))
        return cls(groups, members, order[first])
