"""Several targets at once: how far each of many values is off its own.

A profile of a part has a dozen targets (:mod:`moseg_core.language.target`), and a search compares
some eighty parts with it at a time. Numpy takes as long to begin as to compute for a hundred
numbers; so all values of all targets go through one pass, column by column of a table. Each is the
number that :meth:`~moseg_core.Target.cost` or :meth:`~moseg_core.Target.ratio_cost` gives, to the
last bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from moseg_core.language.target import LEAST_LOG_RATIO, Target, hubers

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


@dataclass(frozen=True)
class TargetArray:
    """Targets, in the order of the columns of a table of values.

    Parameters
    ----------
    targets : tuple of Target
    by_ratio : tuple of bool
        Of which of them ratios count, as many.

    Raises
    ------
    UsageError
        A target of which ratios count has a value that is not positive.

    Examples
    --------
    >>> pair = TargetArray((Target(10, 2), Target(0.1, 0.1)), (False, True))
    >>> pair.costs([[12, 0.2], [20, 0.8]]).round(9).tolist()
    [[1.0, 1.0], [16.0, 8.0]]
    """

    targets: tuple[Target, ...]
    by_ratio: tuple[bool, ...]

    def __post_init__(self) -> None:
        for target, ratio in zip(self.targets, self.by_ratio, strict=True):
            if ratio:
                target.require_positive()

    def costs(self, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """How far values are off.

        Parameters
        ----------
        values : (k, m) array_like of float
            A column for each target, in its unit.

        Returns
        -------
        (k, m) float
            0 or more; 0 is best, at the target, and 1 one spread above it.
        """
        import numpy as np

        given = np.asarray(values, np.float64)
        places, spreads, ratios = self._columns
        if len(ratios):
            of_ratios = given[:, ratios]
            positive = np.where(of_ratios <= 0, 1.0, of_ratios)
            # Python's logarithm rounds otherwise than numpy's in three of a thousand: as alone.
            logs = np.array([*map(math.log, positive.ravel().tolist())], np.float64)
            given = given.copy()
            given[:, ratios] = logs.reshape(positive.shape)
        off = given - places
        if len(ratios):
            least = np.maximum(off[:, ratios], LEAST_LOG_RATIO)
            off[:, ratios] = np.where(of_ratios <= 0, LEAST_LOG_RATIO, least)
        return hubers(off / spreads)

    @cached_property
    def _columns(
        self,
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.int64]]:
        """(m,) values and (m,) spreads, logarithms where ratios count; the columns where they do.

        Numpy's arrays are made when they are first used: to read an expression needs none.
        """
        import numpy as np

        pairs = [
            (target.log_value, target.log_spread) if ratio else (target.value, target.spread)
            for target, ratio in zip(self.targets, self.by_ratio, strict=True)
        ]
        places, spreads = np.array(pairs, np.float64).reshape(-1, 2).T
        return places, spreads, np.flatnonzero(self.by_ratio)
