"""Pins: elements that must bear a certain label, because the user says so.

A partition that gives a pinned element another label breaks the pin. Broken pins are counted with
the empty parts, before the value of the objectives: a candidate that breaks fewer always wins.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError, unknown
from moseg_core.types import Int32Array, IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Pins:
    """Pinned elements with their labels.

    Parameters
    ----------
    elements : (p,) int
        Different elements.
    labels : (p,) int
        Index of the label that each must bear.
    """

    elements: IntArray
    labels: IntArray

    def __len__(self) -> int:
        return len(self.elements)

    def broken(self, labels: Int32Array) -> int:
        """How many pinned elements bear another label than theirs."""
        if not self.elements.size:
            return 0
        return int((labels[self.elements] != self.labels).sum())

    def broken_by_part(self, parts: Int32Array, n: int) -> IntArray:
        """(n, n) int: entry ``i, j`` is how many pins of label ``j`` lie outside part ``i``."""
        inside = np.zeros((n, n), np.int64)
        np.add.at(inside, (parts[self.elements], self.labels), 1)
        outside: IntArray = np.bincount(self.labels, minlength=n)[None, :] - inside
        return outside


NO_PINS = Pins(elements=np.empty(0, np.int64), labels=np.empty(0, np.int64))
"""Nothing is pinned."""


def read_pins(given: Mapping[str, npt.ArrayLike], labels: Sequence[str], n_elements: int) -> Pins:
    """Check pins given as elements per label.

    Parameters
    ----------
    given : mapping of label to array_like of int
    labels : sequence of str
        The problem's labels.
    n_elements : int

    Raises
    ------
    UsageError
        An unknown label, an element that does not exist or is pinned to two labels.

    Examples
    --------
    >>> read_pins({"head": [3, 5]}, ["handle", "head"], 10).labels.tolist()
    [1, 1]
    """
    elements: list[int] = []
    indices: list[int] = []
    for name, numbers in given.items():
        if name not in labels:
            raise UsageError(f"pins: {unknown('label', name, labels)}")
        array = np.atleast_1d(np.asarray(numbers))
        if not np.issubdtype(array.dtype, np.integer):
            raise UsageError(f"pins: elements of '{name}' must be integers, not {array.dtype}")
        for element in np.unique(array).tolist():
            if not 0 <= element < n_elements:
                raise UsageError(
                    f"pins: there is no element {element}; elements are 0 to {n_elements - 1}"
                )
            if element in elements:
                raise UsageError(f"pins: element {element} is pinned to two labels")
            elements.append(element)
            indices.append(list(labels).index(name))
    return Pins(elements=np.array(elements, np.int64), labels=np.array(indices, np.int64))
