"""Weights of centres by the sizes that their labels are expected to have.

With equal weights all parts are of similar extent, and an ear gets as much as a torso. The border
between two cells of a weighted partition divides the way between their centres as the weights
(Sec. 4), so lengths go with weights, and areas with their squares: a label that is expected to
have the share ``a`` of the area gets a weight in proportion to ``sqrt(a)``.

Shares come from the problem, where its objectives say something of them
(``Problem.expected_shares``). Labels of which nothing is known divide what the others leave, and
each has a *class*, a factor on its weight, which evolves with the places.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.types import BoolArray, FloatArray, IntArray

#: Factors on the weight of a label whose size is not known.
CLASSES = np.array([0.35, 0.6, 1.0, 1.6])

#: The class that changes nothing.
PLAIN = 2

#: The labels without a known share have at least so much of the area together.
_LEAST_REST = 0.1


@dataclass(frozen=True, eq=False, kw_only=True)
class Sizes:
    """What weights the labels of an individual's places may have.

    Parameters
    ----------
    base : (g,) float
        Weights of the labels, before classes.
    evolve : (g,) bool
        Whether a label has a class.
    """

    base: FloatArray
    evolve: BoolArray

    @classmethod
    def of(cls, shares: FloatArray, which: str) -> Sizes:
        """The sizes of labels.

        Parameters
        ----------
        shares : (g,) float
            Expected share of the area of each label; NaN where nothing is known.
        which : {"expected", "evolved", "equal"}
            Known shares give weights and the others evolve; all evolve; all weights are 1.

        Examples
        --------
        >>> sizes = Sizes.of(np.array([0.64, 0.04, np.nan, np.nan]), "expected")
        >>> sizes.base.round(3).tolist(), sizes.evolve.tolist()
        ([0.8, 0.2, 0.4, 0.4], [False, False, True, True])
        """
        n = len(shares)
        if which != "expected":
            return cls(base=np.ones(n), evolve=np.full(n, which == "evolved"))
        known = ~np.isnan(shares) & (shares > 0)
        rest = max(1.0 - float(shares[known].sum()), _LEAST_REST) / max(1, int((~known).sum()))
        return cls(base=np.sqrt(np.where(known, shares, rest)), evolve=~known)

    def weights(self, classes: IntArray) -> FloatArray:
        """(..., g) float: the weights for (..., g) classes; their mean is 1.

        Examples
        --------
        >>> Sizes.of(np.full(2, np.nan), "evolved").weights(np.array([2, 1])).round(6).tolist()
        [1.25, 0.75]
        """
        raw = self.base * np.where(self.evolve, CLASSES[classes], 1.0)
        found: FloatArray = raw / raw.mean(axis=-1, keepdims=True)
        return found
