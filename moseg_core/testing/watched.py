"""Shapes and parts that remember what was read of them.

An objective says in ``requires`` what a shape must have. What it reads beyond that it will miss on
a shape that lacks it, in the middle of a search. :func:`watched` makes a segmentation whose shape
and parts note what is asked of them, but else are the same.

What an objective finds out by other ways, from ``shape.geometry`` for instance, is not seen.
"""

from __future__ import annotations

from typing import Any

from moseg_core.part import Part
from moseg_core.segmentation import Segmentation
from moseg_core.shape import Shape

_READS = "_reads"


class _WatchedShape(Shape):
    """A shape that notes when its volume or adjacency is read."""

    def __getattribute__(self, name: str) -> Any:
        if name in ("volume", "adjacency"):
            vars(self)[_READS].add(name)
        return super().__getattribute__(name)

    @property
    def key(self) -> tuple[object, ...]:
        """Like the plain shape's; that the core reads for it does not count."""
        key: tuple[object, ...] = vars(self)["_key"]
        return key


class _WatchedPart(Part):
    """A part that notes what is read of its elements."""

    def __getattribute__(self, name: str) -> Any:
        if name in _OF_PARTS:
            vars(self)[_READS].add(name)
        return super().__getattribute__(name)


_OF_PARTS = frozenset(("triangles", "to_mesh", "points", "areas", "vertices"))


def watched(segmentation: Segmentation) -> tuple[Segmentation, set[str]]:
    """The same segmentation, watched, and the set in which its readings are noted.

    Parameters
    ----------
    segmentation : Segmentation
        Of a shape of input elements.

    Examples
    --------
    >>> from moseg_core.testing.zoo import specimen
    >>> seen, reads = watched(Segmentation.from_labels(specimen("cube"), [0] * 6, 1))
    >>> seen.parts[0].shape.volume, sorted(reads)
    (1.0, ['volume'])
    """
    reads: set[str] = set()
    plain = segmentation.shape
    shape = _copied(plain, _WatchedShape, reads)
    vars(shape)["_key"] = plain.key
    whole = _copied(segmentation, Segmentation, reads)
    vars(whole)["level"] = shape
    parts = []
    for part in segmentation.parts:
        seen = _copied(part, _WatchedPart, reads)
        vars(seen)["level"] = shape
        parts.append(seen)
    vars(whole)["parts"] = tuple(parts)
    reads.clear()
    return whole, reads


def _copied(plain: Any, kind: type, reads: set[str]) -> Any:
    """An object of another class with the same fields."""
    made: Any = object.__new__(kind)
    vars(made).update(vars(plain))
    vars(made)[_READS] = reads
    return made
