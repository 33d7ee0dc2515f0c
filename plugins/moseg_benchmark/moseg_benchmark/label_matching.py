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
        Index into `labels`. Where there are fewer pieces than labels of a kind, some are not used.

    Raises
    ------
    UsageError
        A name that the recipe has no label for.
    """
    names = named.names or ()
    kinds = [fold(label) for label in labels]
    names_of_kind: dict[str, list[str]] = {}
    for name in sorted({names[k] for k in np.unique(named.labels)}):
        names_of_kind.setdefault(naming.kind(name, labels), []).append(name)
    matched = np.full(shape.n_elements, -1, np.int64)
    for kind, group in names_of_kind.items():
        numbers = [k for k, name in enumerate(names) if name in group]
        elements = np.flatnonzero(np.isin(named.labels, numbers))
        instances = [k for k, other in enumerate(kinds) if other == kind]
        matched[elements] = np.array(instances)[_pieces(shape, elements, len(instances))]
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
        The number of the set that has labels of most of the names, and of those the one whose
        labels of each kind are nearest in number to the connected pieces of that kind, specks left
        out; the first of several.

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
    """How many names have no label of their own; how many pieces have none, or labels no piece."""
    names = named.names or ()
    used = np.unique(named.labels)
    # The pieces of a name that has become part of another kind are no instances of that kind.
    own = {fold(label) for label in labels}
    pieces = dict.fromkeys(own, 0)
    lost = 0
    for name in sorted({names[k] for k in used}):
        kind = naming.kind(name, labels)
        elements = np.flatnonzero(np.isin(named.labels, [k for k in used if names[k] == name]))
        if kind == fold(name):
            pieces[kind] += _count_pieces(shape, elements)
        else:
            lost += 1
    wanted = [fold(label) for label in labels]
    return lost, sum(abs(pieces[kind] - wanted.count(kind)) for kind in own)


def _count_pieces(shape: Shape, elements: IntArray) -> int:
    """The number of connected pieces that are no specks, at least one."""
    if shape.adjacency is None:
        return 1
    count, component = shape.adjacency.components(elements)
    areas = np.bincount(component, shape.areas[elements], count)
    return max(1, int((areas >= _SPECK * shape.area).sum()))


def _pieces(shape: Shape, elements: IntArray, n: int) -> IntArray:
    """(k,) int: which of at most `n` connected pieces each element belongs to, largest first."""
    if n == 1 or shape.adjacency is None:
        return np.zeros(len(elements), np.int64)
    count, component = shape.adjacency.components(elements)
    areas = np.bincount(component, shape.areas[elements], count)
    centers = np.stack(
        [
            np.bincount(component, shape.areas[elements] * column, count) / areas.clip(min=1e-300)
            for column in shape.points[elements].T
        ],
        axis=1,
    )
    main = np.argsort(-areas, kind="stable")[:n]
    distances = np.linalg.norm(centers[:, None] - centers[main], axis=2)
    nearest: IntArray = distances.argmin(axis=1)
    nearest[main] = np.arange(len(main))
    return nearest[component]


def labels_by_overlap(parts: IntArray, labels: IntArray, areas: FloatArray) -> IntArray:
    """Unnamed parts, each with the label that most of its area bears elsewhere.

    Parameters
    ----------
    parts : (F,) int
    labels : (F,) int
        From 0.
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
