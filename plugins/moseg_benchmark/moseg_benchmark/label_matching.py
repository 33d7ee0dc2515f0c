"""Names of parts and labels of a recipe beside each other.

People name kinds of parts, a recipe wants instances: four legs are all ``leg`` in the benchmark
and ``leg1`` to ``leg4`` in the recipe; and one of the two may tell apart what the other does not.
To ask what the people's parts *cost* under the recipe, each of its labels needs a part, and the
area that is *named right* is that of the same labels:

- named parts get the recipe's label of the same kind, or where it has none, of the kind that they
  belong to (:class:`Naming`); where the recipe has several labels of the kind, they go to the
  connected pieces, largest first, and further pieces to the nearest of those;
- a person's part, which has no name, gets the label of the named part that most of its area is in.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from moseg_core import Labelling, Shape, UsageError, unknown
from moseg_core.agreement import fold

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
