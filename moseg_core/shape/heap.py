"""A binary heap of keys and codes in two arrays, for kernels that grow regions.

Algorithm 1 (:mod:`moseg_core.builtin.flood`) and the super-elements of coarse shapes
(:mod:`moseg_core.shape.grow`) take the nearest element first; of equal keys the lower code goes
first, so that the order is the same everywhere.
"""

from __future__ import annotations

from moseg_core.shape.compiled import kernel
from moseg_core.types import FloatArray, IntArray


@kernel
def push(key: FloatArray, code: IntArray, count: int, k: float, c: int) -> int:
    """Add an entry to the heap of `count` entries; the new count."""
    at = count
    while at > 0:
        up = (at - 1) >> 1
        if key[up] < k or (key[up] == k and code[up] < c):
            break
        key[at], code[at] = key[up], code[up]
        at = up
    key[at], code[at] = k, c
    return count + 1


@kernel
def sift(key: FloatArray, code: IntArray, count: int, k: float, c: int) -> None:
    """Put an entry in place of the least one in a heap of `count` entries."""
    at = 0
    while True:
        down = 2 * at + 1
        if down >= count:
            break
        right = down + 1
        if right < count and (
            key[right] < key[down] or (key[right] == key[down] and code[right] < code[down])
        ):
            down = right
        if k < key[down] or (k == key[down] and c < code[down]):
            break
        key[at], code[at] = key[down], code[down]
        at = down
    key[at], code[at] = k, c
