"""What an evolutionary seeder places: the centres that no others follow (Sec. 5.2 and 8).

Under constraints some centres follow from others: a leg from its mirror image, a head from the
plane that it lies on. An individual holds a place for each of the others, the leaders, and
whatever it says of them is completed here before the shape is partitioned. Places may be exchanged
only where their labels are in the same role. Without constraints there is a place for every label,
and one role.

:mod:`moseg_core.builtin.evolution` and :mod:`moseg_core.builtin.sized_evolution` share it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.components.protocols import Centers, Evaluator
from moseg_core.types import FloatArray, IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Genome:
    """What the places of an individual stand for.

    Parameters
    ----------
    evaluator : Evaluator
        Whose problem has the labels and the constraints.
    labels : (g,) int
        The label that each place is the centre of.
    roles : (g,) int
        Places with equal roles may be exchanged.
    """

    evaluator: Evaluator
    labels: IntArray
    roles: IntArray

    @classmethod
    def of(cls, evaluator: Evaluator) -> Genome:
        """The genome of a problem on a shape."""
        groups = evaluator.constraints.groups
        known = list(dict.fromkeys(group.role for group in groups))
        return cls(
            evaluator=evaluator,
            labels=np.array([group.members[0] for group in groups]),
            roles=np.array([known.index(group.role) for group in groups]),
        )

    def sorted(self, individual: IntArray) -> IntArray:
        """The individual with its elements in order within each role."""
        order = np.lexsort((individual, self.roles))
        ordered = np.empty_like(individual)
        ordered[np.argsort(self.roles, kind="stable")] = individual[order]
        return ordered

    def key(self, individual: IntArray) -> bytes:
        """The same for the same sets of elements, whatever their order."""
        return self.sorted(individual).tobytes()

    def vector(self, positions: FloatArray, weights: FloatArray | None = None) -> FloatArray:
        """(m,) float: the partition that centres stand for, those that follow filled in.

        Parameters
        ----------
        positions : (g, 3) float, model units
            A centre for each place.
        weights : (g,) float, optional
            1 by default, as those of the centres that follow are until they are filled in.
        """
        evaluator = self.evaluator
        partition = evaluator.parameterization
        everywhere = np.repeat(evaluator.shape.frame.center[None], partition.n_parts, axis=0)
        everywhere[self.labels] = positions
        whole = np.ones(partition.n_parts)
        if weights is not None:
            whole[self.labels] = weights
        vector = partition.encode(Centers(positions=everywhere, weights=whole))
        completed: FloatArray = evaluator.constraints.completed(vector)
        return completed

    def centers(self, positions: FloatArray, weights: FloatArray | None = None) -> Centers:
        """The first centre of each label, exactly as given where none follow."""
        if not self.evaluator.constraints.active:
            given = np.ones(len(positions)) if weights is None else weights
            return Centers(positions=positions, weights=given)
        return self.evaluator.parameterization.decode(self.vector(positions, weights)).first

    def places(self, order: IntArray) -> IntArray:
        """From parts that labels go to, to places that places go to."""
        place = np.empty(len(order), np.int64)
        place[self.labels] = np.arange(len(self.labels))
        chosen: IntArray = place[order[self.labels]]
        return chosen
