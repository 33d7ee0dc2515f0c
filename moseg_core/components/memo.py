"""A bounded memory of what was computed for a part.

During the search most parts of a candidate are the same as a moment ago: only the neighbours of
the centre that moved have changed. Values are remembered under the part's membership hash, so
they are found again whatever the candidate. A value in the memory equals one computed anew (see
:mod:`moseg_core.shape.part_sums`), so the memory changes the time and nothing else.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any


class Memo:
    """A mapping that forgets what was least recently used.

    Parameters
    ----------
    size : int
        Number of values kept. 0 keeps none, so that everything is computed anew.

    Examples
    --------
    >>> memo = Memo(size=2)
    >>> memo.get("a", lambda: 1), memo.get("a", lambda: 2)
    (1, 1)
    >>> memo.hits, memo.misses
    (1, 1)
    """

    def __init__(self, *, size: int = 50_000) -> None:
        self.size = size
        self.hits = 0
        self.misses = 0
        self._values: OrderedDict[Hashable, Any] = OrderedDict()

    def __len__(self) -> int:
        return len(self._values)

    def known(self, key: Hashable) -> Any:
        """The value under `key`, None where it is not known."""
        value = self._values.get(key)
        if value is not None:
            self.hits += 1
            self._values.move_to_end(key)
        return value

    def get(self, key: Hashable, compute: Callable[..., Any], *arguments: Any) -> Any:
        """The value under `key`; computed from the arguments, and kept, where it is not known."""
        try:
            value = self._values[key]
        except KeyError:
            self.misses += 1
            value = compute(*arguments)
            self._values[key] = value
            if len(self._values) > self.size:
                self._values.popitem(last=False)
            return value
        self.hits += 1
        self._values.move_to_end(key)
        return value
