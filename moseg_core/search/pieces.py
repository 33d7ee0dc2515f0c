"""Small loose pieces left out of the search: a stray triangle, the crumbs of a scan.

Such a piece belongs to no part that anybody means, but objectives see it: it widens the hull of a
part, and an open one leaves the shape without a volume. Where the user says so, the connected
pieces below a share of the area are taken out before everything else; what is searched, and what
the cost is about, is the shape without them. Their elements then get the label of the nearest part,
by the middle of the nearest element that stayed, so that every element of the input has one.

Unasked nothing is left out; that there are such pieces is a warning of the result.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from moseg_core.errors import MosegError, ShapeError, UsageError
from moseg_core.problem.settings import SearchOptions
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from moseg_core.types import BoolArray, IntArray

PinsGiven = Mapping[str, npt.ArrayLike] | None
"""Elements by label, as a caller gives them."""

#: Pieces below this share of the area are worth a word.
_SMALL = 0.001
#: Where they have more than this share together, the shape is made of small pieces.
_CRUMBS = 0.05


@dataclass(frozen=True, eq=False, kw_only=True)
class Kept:
    """What is left of a shape without its small pieces.

    Parameters
    ----------
    whole, shape : Shape
        As the user gave it, and without them.
    elements : (k,) int
        Of the whole, those that stay.
    count : int
        Number of pieces that were left out.
    share : float
        Of the area: what these have less than.
    """

    whole: Shape
    shape: Shape
    elements: IntArray
    count: int
    share: float

    def pins(self, given: PinsGiven) -> dict[str, IntArray]:
        """Pins by the numbers that elements have here; those on small pieces are left out."""
        place = np.full(self.whole.n_elements, -1)
        place[self.elements] = np.arange(len(self.elements))
        found = {}
        for name, numbers in (given or {}).items():
            asked = np.atleast_1d(np.asarray(numbers))
            known = np.issubdtype(asked.dtype, np.integer) and bool(
                ((asked >= 0) & (asked < len(place))).all()
            )
            here = place[asked] if known else asked  # what is wrong with others is told later
            found[name] = here[here >= 0] if known else here
        return found

    @cached_property
    def nearest(self) -> IntArray:
        """(F,) int: for each element of the whole the kept one whose label it gets."""
        near = np.empty(self.whole.n_elements, np.int64)
        near[self.elements] = np.arange(len(self.elements))
        left = np.setdiff1d(np.arange(len(near)), self.elements)
        near[left] = cKDTree(self.shape.points).query(self.whole.points[left])[1]
        return near

    def returned(self, result: Result, pins: PinsGiven = None) -> Result:
        """The result with the small pieces back, under the label of the nearest part or their pin.

        Examples
        --------
        See :func:`without_small_pieces`.
        """
        labels = result.labels[self.nearest]
        left = np.setdiff1d(np.arange(len(labels)), self.elements)
        names = list(result.problem.labels)
        for name, numbers in (pins or {}).items():
            pinned = np.intersect1d(np.atleast_1d(np.asarray(numbers)), left)
            if name in names:
                labels[pinned] = names.index(name)
        one = self.count == 1
        pieces = "1 loose piece was" if one else f"{self.count} loose pieces were"
        said = (
            f"{pieces} left out of the search and of the cost, with less than"
            f" {100 * self.share:.3g} % of the area{'' if one else ' each'}, and"
            f" {'is' if one else 'are'} labelled like the nearest part"
        )
        return replace(
            result,
            shape=self.whole,
            labels=labels,
            method={**result.method, "ignore_pieces_below": f"{self.share:.17g}"},
            warnings=(*result.warnings, said),
        )


def without_small_pieces(shape: Shape, share: float) -> Kept | None:
    """A shape without its small pieces; None where it has none.

    Kept as long as the shape, for other searches on it.

    Parameters
    ----------
    shape : Shape
    share : float
        Of the area, from 0 to 1: pieces with less than this are left out.

    Raises
    ------
    ShapeError
        Nothing would be left, or it is not known which elements touch.

    Examples
    --------
    >>> shape = Shape.from_mesh([[0, 0, 0], [9, 0, 0], [9, 9, 0], [20, 0, 0], [20, 1, 0],
    ...                          [21, 0, 0]], [[0, 1, 2], [3, 4, 5]])
    >>> without_small_pieces(shape, 0.05).elements.tolist()
    [0]
    >>> without_small_pieces(shape, 0.001) is None
    True
    """
    if shape.adjacency is None:
        raise ShapeError(
            f"'{shape.name}' has no pieces to leave out: it is not known which of its"
            f" {shape.geometry.noun}s touch; say so with --adjacency knn, or leave out"
            " --ignore-pieces-below"
        )
    key = ("without small pieces", share)
    if key not in shape.made_from:
        shape.made_from[key] = _kept(shape, share)
    found: Kept | None = shape.made_from[key]
    return found


def _kept(shape: Shape, share: float) -> Kept | None:
    """See :func:`without_small_pieces`."""
    areas, small = _pieces_below(shape, share)
    if not small.any():
        return None
    if small.all():
        raise ShapeError(
            f"no piece of '{shape.name}' has {100 * share:.3g} % of the area; the largest of"
            f" {len(areas)} has {100 * areas.max() / shape.area:.3g} %"
        )
    elements = np.flatnonzero(~small)
    kept = subshape(shape, elements, name=shape.name)
    count = int((areas < share * shape.area).sum())
    return Kept(whole=shape, shape=kept, elements=elements, count=count, share=share)


def on_large_pieces(
    shape: Shape,
    options: SearchOptions,
    search: Callable[[Shape, SearchOptions, PinsGiven], Result],
    pins: PinsGiven = None,
) -> Result:
    """A search on the shape without its small pieces, where the options ask for that.

    Parameters
    ----------
    shape : Shape
    options : SearchOptions
    search : callable
        From the shape to search, the options with the small pieces settled, and pins, to a result.
    pins : mapping of str to array_like of int, optional
        By the shape's own numbers.

    Raises
    ------
    UsageError
        No shape.
    MosegError
        As the search, with what it had found as the error's ``result``.
    """
    if not isinstance(shape, Shape):
        raise UsageError(f"segment takes a Shape, from moseg.load(path), not {shape!r:.60}")
    kept = None
    if options.ignore_pieces_below > 0:
        kept = without_small_pieces(shape, options.ignore_pieces_below)
    options = replace(options, ignore_pieces_below=0.0)
    if kept is None:
        found = search(shape, options, pins)
        said = [word for word in small_pieces_warning(shape) if word not in found.warnings]
        return replace(found, warnings=(*found.warnings, *said))
    try:
        return kept.returned(search(kept.shape, options, kept.pins(pins)), pins)
    except MosegError as error:
        if error.result is not None and error.result.shape is kept.shape:
            error.result = kept.returned(error.result, pins)
        raise


def searched_part(shape: Shape, options: SearchOptions) -> Shape:
    """The shape that a search with these options sees: without small pieces where they say so."""
    if options.ignore_pieces_below > 0:
        kept = without_small_pieces(shape, options.ignore_pieces_below)
        return shape if kept is None else kept.shape
    return shape


def small_pieces_warning(shape: Shape) -> list[str]:
    """A word on small pieces that are searched like everything else; none where all are small."""
    if shape.adjacency is None or shape.n_elements == 0:
        return []
    areas, small = _pieces_below(shape, _SMALL)
    count = int((areas < _SMALL * shape.area).sum())
    together = float(shape.areas[small].sum()) / shape.area
    if not count or together > _CRUMBS:
        return []
    pieces = "1 loose piece has" if count == 1 else f"{count} loose pieces have"
    each = "" if count == 1 else " each"
    return [
        f"{pieces} less than 0.1 % of the area{each}, and may take a part for"
        f" {'itself' if count == 1 else 'themselves'}; --ignore-pieces-below 0.1% leaves"
        f" {'it' if count == 1 else 'them'} out of the search"
    ]


def _pieces_below(shape: Shape, share: float) -> tuple[np.ndarray, BoolArray]:
    """The area of each piece, and (F,) bool: elements of those with less than a share of all."""
    assert shape.adjacency is not None  # callers have looked
    if "pieces" not in shape.made_from:
        count, piece = shape.adjacency.components()
        shape.made_from["pieces"] = piece, np.bincount(piece, shape.areas, count)
    piece, areas = shape.made_from["pieces"]
    small: BoolArray = (areas < share * shape.area)[piece]
    return areas, small
