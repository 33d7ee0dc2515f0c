"""The cost of a candidate: how many of its parts are empty, then what its terms add up to.

A partition can leave a label without elements. No objective can say anything of such a part, so
the core ranks it itself: fewer empty parts always win, whatever the terms say, and no NaN or
exception ever comes of it.
"""

from __future__ import annotations

import math
from typing import NamedTuple


class Cost(NamedTuple):
    """A cost, ordered by (empty, value); less is better.

    Parameters
    ----------
    empty : int
        Number of parts that are empty or have no extent, and of pins that are broken.
    value : float
        Weighted sum over the terms whose parts are all there.

    Examples
    --------
    >>> Cost(0, 9.0) < Cost(1, 0.5)
    True
    """

    empty: int
    value: float

    @property
    def scalar(self) -> float:
        """One number for optimisers that take no other: ``value``, plus 1e12 per empty part.

        The order of two costs is that of their scalars as long as values differ by less than
        1e12 and, with equal numbers of empty parts, by more than rounding.
        """
        return self.value + 1e12 * self.empty


WORST = Cost(2**31, math.inf)
"""A cost that every other is better than."""
