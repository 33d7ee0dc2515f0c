"""A labelling: for each element of a shape one label, or none.

A label is a number from 0, which may have a name. :data:`~moseg_core.types.UNLABELLED`, -1, stands
where an element has none: nobody has said what it is. Such elements are left out of what is
measured of labels (:mod:`moseg_core.agreement`) and learned from them; where a labelling must be
whole, as a cost needs it, they take the label of the nearest element that has one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.shape.shape import Shape
from moseg_core.types import UNLABELLED, BoolArray, IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Labelling:
    """One label per surface element.

    Parameters
    ----------
    labels : (F,) int
        From 0; -1 where an element has none.
    names : tuple of str or None
        ``names[k]`` is the name of label ``k``; None where the file has no names.
    notes : tuple of str
        What the reader passed over, chose or carried, and how many elements have no label; each a
        line to print.
    """

    labels: IntArray
    names: tuple[str, ...] | None
    notes: tuple[str, ...] = ()

    @property
    def unlabelled(self) -> BoolArray:
        """(F,) bool: which elements have no label."""
        return np.asarray(self.labels == UNLABELLED)

    def filled(self, shape: Shape) -> IntArray:
        """Labels for all elements, for what needs a whole labelling.

        Parameters
        ----------
        shape : Shape
            Of F elements.

        Returns
        -------
        (F,) int
            Those without a label have that of the nearest element that has one.

        Examples
        --------
        >>> row = Shape.from_points([[0, 0, 0], [1, 0, 0], [3, 0, 0]])
        >>> Labelling(labels=np.array([2, -1, 0]), names=None).filled(row).tolist()
        [2, 2, 0]
        """
        missing = self.unlabelled
        if not missing.any():
            return self.labels
        from scipy.spatial import cKDTree

        labels = self.labels.copy()
        known = shape.points[~missing]
        labels[missing] = labels[~missing][cKDTree(known).query(shape.points[missing])[1]]
        return labels
