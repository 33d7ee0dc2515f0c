"""Names of parts and labels of a recipe beside each other.

People name kinds of parts, a recipe wants instances: four legs are all ``leg`` in the benchmark
and ``leg1`` to ``leg4`` in the recipe; and one of the two may tell apart what the other does not.
To ask what the people's parts *cost* under the recipe, each of its labels needs a part, and the
area that is *named right* is that of the same labels:

- named parts get the recipe's label of the same kind, or where it has none, of the kind that they
  belong to (:class:`Naming`); where the recipe has several labels of the kind, they go to the
  connected pieces, largest first, and further pieces to the nearest of those;
- of a recipe whose labels have counts that label set is taken which comes nearest to the pieces
  that there are (:func:`fitting_set`);
- a person's part, which has no name, gets the label of the named part that most of its area is in.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from moseg_core import Labelling, Shape, UsageError, unknown
from moseg_core.agreement import fold

#: Below this share of the whole area a piece is no part of its own.
_SPECK = 0.002

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Naming:
    """What parts count as under a recipe that has no label of their name.

    Parameters
    ----------
    belongs_to : mapping of str to tuple of str
        For a true name kinds of labels, that is labels without instance number: of those the first
        that the recipe has.

    Examples
    --------
    >>> naming = Naming({"tail": ("torso", "body")})
    >>> naming.kind("tail", ["body", "leg1"]), naming.kind("tail", ["body", "tail"])
    ('body', 'tail')
    """

    belongs_to: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def kind(self, name: str, labels: Sequence[str]) -> str:
        """The kind of a recipe's labels that parts of a true name get.

        Raises
        ------
        UsageError
            The recipe has no label for them.
        """
        kinds = {fold(label) for label in labels}
        for kind in (fold(name), *self.belongs_to.get(name, ())):
            if kind in kinds:
                return kind
        raise UsageError(f"the recipe has no label for '{name}': {unknown('label', name, kinds)}")


def labels_of_names(
    shape: Shape, named: Labelling, labels: Sequence[str], naming: Naming
) -> IntArray:
    """Named parts as parts of a recipe.

    Parameters
    ----------
    shape : Shape
    named : Labelling
        With names.
    labels : sequence of str
        Of the recipe.
    naming : Naming

    Returns
    -------
    (F,) int
        Index into `labels`, -1 for elements without a name. Where there are fewer pieces than
        labels of a kind, some are not used.

    Raises
    ------
    UsageError
        A name that the recipe has no label for.
    """
    kinds = [fold(label) for label in labels]
    matched = np.full(shape.n_elements, -1, np.int64)
    for kind, numbers in _names_of_kinds(named, labels, naming).items():
        instances = [k for k, other in enumerate(kinds) if other == kind]
        own = [(named.names or ())[number] for number in numbers]
        if len(own) > 1 and sorted(own) == sorted(labels[k] for k in instances):
            for number, name in zip(numbers, own, strict=True):
                matched[named.labels == number] = labels.index(name)
            continue
        elements, piece = _pieces_of_kind(shape, named, numbers)
        matched[elements] = np.array(instances)[
            _main_pieces(shape, elements, piece, len(instances))
        ]
    return matched


def fitting_set(
    shape: Shape, named: Labelling, sets: Sequence[Sequence[str]], naming: Naming
) -> int:
    """Which of several label sets of a recipe fits named parts best.

    Parameters
    ----------
    shape : Shape
    named : Labelling
        With names.
    sets : sequence of sequence of str
        The labels of each.
    naming : Naming

    Returns
    -------
    int
        The number of the set in which fewest names share a kind of label with others, and of
        those the one whose labels of each kind are nearest in number to the connected pieces that
        get them, specks left out; the first of several.

    Raises
    ------
    UsageError
        A name that no set has a label for.
    """
    failure: UsageError | None = None
    misfits: dict[int, tuple[int, int]] = {}
    for k, labels in enumerate(sets):
        try:
            misfits[k] = _misfit(shape, named, labels, naming)
        except UsageError as error:
            failure = failure or error
    if failure is not None and not misfits:
        raise failure
    return min(misfits, key=lambda k: misfits[k])


def _misfit(
    shape: Shape, named: Labelling, labels: Sequence[str], naming: Naming
) -> tuple[int, int]:
    """How many names share their label's kind with others; how many pieces or labels are alone."""
    kinds = [fold(label) for label in labels]
    groups = _names_of_kinds(named, labels, naming)
    alone = 0
    for kind in dict.fromkeys(kinds):
        alone += abs(_count_pieces(shape, named, groups.get(kind, [])) - kinds.count(kind))
    return sum(len(group) - 1 for group in groups.values()), alone


def _names_of_kinds(
    named: Labelling, labels: Sequence[str], naming: Naming
) -> dict[str, list[int]]:
    """For each kind of a recipe's labels the numbers of the names whose parts get it."""
    names = named.names or ()
    groups: dict[str, list[int]] = {}
    for k in sorted(_borne(named), key=lambda k: names[k]):
        groups.setdefault(naming.kind(names[k], labels), []).append(int(k))
    return groups


def _borne(named: Labelling) -> list[int]:
    """The labels that elements bear, ascending."""
    found: list[int] = np.unique(named.labels[~named.unlabelled]).tolist()
    return found


def piece_counts(shape: Shape, named: Labelling) -> dict[str, int]:
    """The number of connected pieces of each kind, specks left out.

    Parameters
    ----------
    shape : Shape
    named : Labelling
        With names.

    Returns
    -------
    dict of str to int
        Kinds, names without instance number, in alphabetical order.

    Examples
    --------
    >>> tile = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    >>> piece_counts(tile, Labelling(labels=np.array([0, 1]), names=("side1", "side2")))
    {'side': 2}
    """
    groups: dict[str, list[int]] = {}
    for k in _borne(named):
        groups.setdefault(fold((named.names or ())[k]), []).append(k)
    return {kind: _count_pieces(shape, named, groups[kind]) for kind in sorted(groups)}


def _count_pieces(shape: Shape, named: Labelling, numbers: Sequence[int]) -> int:
    """The number of connected pieces that are no specks; at least one, where there are elements."""
    if not numbers:
        return 0
    elements, piece = _pieces_of_kind(shape, named, numbers)
    areas = np.bincount(piece, shape.areas[elements])
    return max(1, int((areas >= _SPECK * shape.area).sum()))


def _pieces_of_kind(
    shape: Shape, named: Labelling, numbers: Sequence[int]
) -> tuple[IntArray, IntArray]:
    """The elements of some names, and the number of the connected piece that each belongs to.

    What people numbered, ``finger1`` beside ``finger2``, is not one piece though it touches; what
    goes by a name that is not its own is one piece with whatever it touches.
    """
    names = named.names or ()
    numbered = [k for k in numbers if len(numbers) > 1 and fold(names[k]) != names[k]]
    together = [k for k in numbers if k not in numbered]
    elements, pieces, count = list[IntArray](), list[IntArray](), 0
    for group in (*([k] for k in numbered), *([together] if together else [])):
        own = np.flatnonzero(np.isin(named.labels, group))
        if shape.adjacency is None:
            more, piece = 1, np.zeros(len(own), np.int64)
        else:
            more, piece = shape.adjacency.components(own)
        elements.append(own)
        pieces.append(piece + count)
        count += more
    return np.concatenate(elements), np.concatenate(pieces)


def _main_pieces(shape: Shape, elements: IntArray, piece: IntArray, n: int) -> IntArray:
    """(k,) int: which of at most `n` pieces each element belongs to, largest first."""
    if n == 1:
        return np.zeros(len(elements), np.int64)
    areas = np.bincount(piece, shape.areas[elements])
    centers = np.stack(
        [
            np.bincount(piece, shape.areas[elements] * column) / areas.clip(min=1e-300)
            for column in shape.points[elements].T
        ],
        axis=1,
    )
    main = np.argsort(-areas, kind="stable")[:n]
    distances = np.linalg.norm(centers[:, None] - centers[main], axis=2)
    nearest: IntArray = distances.argmin(axis=1)
    nearest[main] = np.arange(len(main))
    return nearest[piece]


def labels_by_overlap(parts: IntArray, labels: IntArray, areas: FloatArray) -> IntArray:
    """Unnamed parts, each with the label that most of its area bears elsewhere.

    Parameters
    ----------
    parts : (F,) int
    labels : (F,) int
        From 0; all elements have one.
    areas : (F,) float

    Returns
    -------
    (F,) int

    Examples
    --------
    >>> import numpy as np
    >>> labels_by_overlap(np.array([7, 7, 7, 2]), np.array([1, 1, 0, 0]), np.ones(4)).tolist()
    [1, 1, 1, 0]
    """
    _, part = np.unique(parts, return_inverse=True)
    overlap = np.zeros((int(part.max()) + 1, int(labels.max()) + 1))
    np.add.at(overlap, (part, labels), areas)
    labels_of_parts: IntArray = overlap.argmax(axis=1)
    return labels_of_parts[part]
