"""From free numbers to all coordinates: constraints put together (Sec. 8).

"The user need only provide a constraint function which takes in the non-redundant parameters and
produces the others." Each constraint determines the centres of some labels, from those of others
and maybe from a few numbers of its own. Together with the coordinates of all other labels these
numbers are the *free vector* ``z`` that the search sees, so that its dimension really drops; for
a bulldog, whose head and body lie on a plane and two of whose legs mirror the others, from 24 to
14. :meth:`Constraints.expand` leads from ``z`` to the vector ``x`` of the parameterization, and
:meth:`Constraints.reduce` back.

Constraints that read what others determine come after them; a label that two determine, and a
circle, are refused. Without any constraint ``z`` is ``x``, to the bit.

Labels that are in the same *role* can change places and the constraints still hold: two centres
on the plane, or two pairs of a leg and its mirror image. Seeders and labelers may exchange these
and no others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, permutations, product
from typing import Any

import numpy as np

from moseg_core.components.protocols import Centers, Constraint, Parameterization
from moseg_core.errors import REPORT, PluginError, UsageError
from moseg_core.problem.constraint_calls import BoundConstraint
from moseg_core.shape.shape import Shape
from moseg_core.types import BoolArray, FloatArray, IntArray

#: How often centres are made feasible, at most, while some of them are held.
_TURNS = 60
#: Up to so many permutations of labels are tried one by one.
_MOST_TRIED = 50_000


@dataclass(frozen=True, kw_only=True)
class Group:
    """Labels that move together: one with numbers of its own, and those that follow it.

    Parameters
    ----------
    members : tuple of int
        Labels, the leader first.
    role : tuple
        Equal for groups that may change places.
    """

    members: tuple[int, ...]
    role: tuple[Any, ...]


class Constraints:
    """All constraints of a problem, on one shape.

    Parameters
    ----------
    given : sequence of BoundConstraint
    partition : Parameterization
    shape : Shape
        The one that the partition is of.
    names : sequence of str
        The labels, for messages.

    Raises
    ------
    UsageError
        Two constraints determine one label, they go in a circle, they put two centres in one
        place, or they are about a label that has several centres; names them.
    PluginError
        A constraint breaks its word.
    """

    def __init__(
        self,
        given: Sequence[BoundConstraint],
        partition: Parameterization,
        shape: Shape,
        names: Sequence[str],
    ) -> None:
        self._partition, self._frame, self._names = partition, shape.frame, tuple(names)
        self._constraints = _in_order([(bound, bound.make(shape)) for bound in given], self._names)
        self.groups = _groups(self._constraints, len(self._names))
        if not self._constraints:
            return
        self._check_single()
        determined = sorted(k for _, c in self._constraints for k in c.determines)
        #: Coordinates of x that follow, and those that are free as they stand.
        self._follow: IntArray = np.concatenate([partition.coordinates(k) for k in determined])
        self._plain = np.setdiff1d(np.arange(len(partition.lower)), self._follow)
        sizes = [len(c.lower) for _, c in self._constraints]
        self._ends = len(self._plain) + np.cumsum([0, *sizes])
        self._check_apart()

    @property
    def active(self) -> bool:
        """Whether there are any."""
        return bool(self._constraints)

    @property
    def n_free(self) -> int:
        """Number of coordinates that the search sees, k."""
        return int(self._ends[-1]) if self.active else self.n_all

    @property
    def n_all(self) -> int:
        """Number of coordinates of the parameterization, m."""
        return len(self._partition.lower)

    @property
    def lower(self) -> FloatArray:
        """(k,) float: least value of each free number."""
        if not self.active:
            return self._partition.lower
        own = [c.lower for _, c in self._constraints]
        return np.concatenate([self._partition.lower[self._plain], *own])

    @property
    def upper(self) -> FloatArray:
        """(k,) float: greatest value of each free number."""
        if not self.active:
            return self._partition.upper
        own = [c.upper for _, c in self._constraints]
        return np.concatenate([self._partition.upper[self._plain], *own])

    @property
    def scale(self) -> FloatArray:
        """(k,) float: the natural size of a step of 1."""
        if not self.active:
            return self._partition.scale
        own = [np.ones(len(c.lower)) for _, c in self._constraints]
        return np.concatenate([self._partition.scale[self._plain], *own])

    def coordinates(self, label: int) -> IntArray:
        """Places in z of what decides about a label, for keeping it as it is.

        Of a label that follows another one these are the other's.
        """
        for i, (_, member) in enumerate(self._constraints):
            if label in member.determines:
                own = np.arange(self._ends[i], self._ends[i + 1])
                read = [self.coordinates(k) for k in member.reads]
                return np.unique(np.concatenate([own, *read])).astype(np.int64)
        own_places = self._partition.coordinates(label)
        if not self.active:
            return own_places
        places: IntArray = np.searchsorted(self._plain, own_places)
        return places

    def expand(self, free: FloatArray) -> FloatArray:
        """(B, m) float: whole vectors from (B, k) free ones."""
        if not self.active:
            return free
        whole = np.zeros((len(free), self.n_all))
        whole[:, self._plain] = free[:, : len(self._plain)]
        for row, numbers in zip(whole, free, strict=True):
            centers = self._rows(row)
            for i, (bound, member) in enumerate(self._constraints):
                own = numbers[self._ends[i] : self._ends[i + 1]]
                rows = bound.call(member.expand, own, centers)
                centers = _checked_rows(bound, rows, centers.shape)
            row[self._follow] = self._vector(centers)[self._follow]
        return whole

    def reduce(self, vector: FloatArray) -> FloatArray:
        """(k,) float: the free numbers of feasible centres near to those of a vector.

        The nearest ones, where no label is read by two constraints.
        """
        if not self.active:
            return vector
        centers = self._rows(vector)
        own: list[FloatArray] = []
        for bound, member in reversed(self._constraints):
            free, moved = bound.call(member.reduce, centers)
            centers = _checked_rows(bound, moved, centers.shape)
            own.append(np.asarray(free, dtype=np.float64))
        read_labels = [k for _, member in self._constraints for k in member.reads]
        whole = vector.copy()
        if read_labels:
            read = np.concatenate([self._partition.coordinates(k) for k in read_labels])
            whole[read] = self._vector(centers)[read]
        return np.concatenate([whole[self._plain], *own[::-1]])

    def feasible(self, vector: FloatArray) -> FloatArray:
        """(m,) float: feasible centres near to those of a vector."""
        return self.expand(self.reduce(vector)[None])[0] if self.active else vector

    def holding(self, vector: FloatArray, labels: Sequence[int]) -> FloatArray:
        """(m,) float: feasible centres, those of certain labels where the vector has them.

        Where the constraints do not allow this, these are near. By turns all centres are made
        feasible and these are put back, until that changes nothing: a leg that is held so draws its
        mirror image after it, whichever of the two leads.
        """
        found = self.feasible(vector)
        if not self.active or not labels:
            return found
        places = np.concatenate([self._partition.coordinates(k) for k in labels])
        apart = np.inf
        for _ in range(_TURNS):
            before, apart = apart, float(np.abs(found[places] - vector[places]).max())
            if apart <= 1e-15 or apart > 0.99 * before:
                break
            again = found.copy()
            again[places] = vector[places]
            found = self.feasible(again)
        return found

    def completed(self, vector: FloatArray) -> FloatArray:
        """(m,) float: feasible centres, those that follow others computed from these.

        Those with numbers of their own are only moved as far as they must; those that follow come
        after them, wherever they were.
        """
        if not self.active:
            return vector
        centers = self._rows(vector)
        for bound, member in self._constraints:
            free = np.empty(0)
            if len(member.lower):
                free = bound.call(member.reduce, centers)[0]
            centers = _checked_rows(bound, bound.call(member.expand, free, centers), centers.shape)
        whole = vector.copy()
        whole[self._follow] = self._vector(centers)[self._follow]
        return whole

    def within(self, vectors: FloatArray) -> BoolArray:
        """(B,) bool: which whole vectors are within the parameterization's bounds."""
        bounded = (vectors >= self._partition.lower) & (vectors <= self._partition.upper)
        inside: BoolArray = np.all(bounded & np.isfinite(vectors), axis=1)
        return inside

    def nearest_order(self, vector: FloatArray, alike: Sequence[Sequence[int]]) -> IntArray:
        """(n,) int: an exchange of alike labels, after which `feasible` moves centres least.

        Parameters
        ----------
        vector : (m,) float
            Centres of labels, not feasible yet.
        alike : sequence of sequence of int
            Classes of labels that may be exchanged, such as four legs.

        Returns
        -------
        (n,) int
            Label ``j`` goes to the centre of label ``order[j]``. Of equally good ones the first.
        """
        n = self._partition.n_parts
        best = np.arange(n)
        if not self.active:
            return best
        classes = [list(group) for group in alike if len(group) > 1]

        def moved(order: IntArray) -> float:
            asked = self._partition.permute(vector, order)
            return float(((self.feasible(asked) - asked) ** 2).sum())

        least = moved(best)
        if math.prod(math.factorial(len(group)) for group in classes) <= _MOST_TRIED:
            for chosen in product(*(permutations(group) for group in classes)):
                order = np.arange(n)
                for group, places in zip(classes, chosen, strict=True):
                    order[group] = places
                if (now := moved(order)) < least - 1e-12:
                    best, least = order, now
            return best
        better = True
        while better:  # too many to try: exchange two as long as it helps
            better = False
            for group in classes:
                for i, j in combinations(group, 2):
                    order = best.copy()
                    order[[i, j]] = order[[j, i]]
                    if (now := moved(order)) < least - 1e-12:
                        best, least, better = order, now, True
        return best

    def _rows(self, vector: FloatArray) -> FloatArray:
        """(n, 4) float: centres in unit coordinates, and weights.

        Of labels that have several centres the first; no constraint is about these.
        """
        centers = self._partition.decode(vector).first
        return np.column_stack([self._frame.to_unit(centers.positions), centers.weights])

    def _vector(self, rows: FloatArray) -> FloatArray:
        """(m,) float: the vector of such rows."""
        positions = self._frame.to_model(rows[:, :3])
        return self._partition.encode(Centers(positions=positions, weights=rows[:, 3]))

    def _check_single(self) -> None:
        """Refuse constraints about a label that has more than one centre."""
        counts = np.asarray(getattr(self._partition, "centers_per_part", np.ones(len(self._names))))
        for bound, constraint in self._constraints:
            for k in (*constraint.determines, *constraint.reads):
                if counts[k] > 1:
                    raise UsageError(
                        f"'{bound.text}' is about the one centre of a label, and"
                        f" '{self._names[k]}' has {counts[k]}; leave the constraint out, or give"
                        f" '{self._names[k]}' one centre"
                    )

    def _check_apart(self) -> None:
        """Refuse constraints that always put two centres in one place."""
        rng = np.random.default_rng(0)
        free = rng.uniform(0.25, 0.75, (2, self.n_free))
        rows = [self._rows(vector) for vector in self.expand(free)]
        for i, j in combinations(range(len(self._names)), 2):
            if all(np.allclose(r[i], r[j], rtol=0, atol=1e-12) for r in rows):
                texts = [r.text for r, c in self._constraints if {i, j} & {*c.determines, *c.reads}]
                raise UsageError(
                    f"the constraints {_listed(texts)} put the centres of '{self._names[i]}' and"
                    f" '{self._names[j]}' in one place; leave one of them out"
                )


def _in_order(
    made: Sequence[tuple[BoundConstraint, Constraint]], names: Sequence[str]
) -> list[tuple[BoundConstraint, Constraint]]:
    """Constraints, those that read after those that determine what they read."""
    owner: dict[int, BoundConstraint] = {}
    for bound, constraint in made:
        labels = (*constraint.determines, *constraint.reads)
        if not constraint.determines or not all(0 <= k < len(names) for k in labels):
            raise PluginError(
                f"constraint '{bound.id}' of {bound.distribution} determines no label of the"
                f" problem; {REPORT}"
            )
        for k in constraint.determines:
            if k in constraint.reads:
                raise UsageError(f"in '{bound.text}' the label '{names[k]}' would follow itself")
            if k in owner:
                raise UsageError(
                    f"label '{names[k]}' cannot follow both '{owner[k].text}' and '{bound.text}';"
                    f" leave one of them out"
                )
            owner[k] = bound
    waiting, done, ordered = list(made), set(range(len(names))) - set(owner), []
    while waiting:
        ready = [pair for pair in waiting if done.issuperset(pair[1].reads)]
        if not ready:
            texts = [bound.text for bound, _ in waiting]
            raise UsageError(f"the constraints {_listed(texts)} go in a circle; leave one out")
        for pair in ready:
            waiting.remove(pair)
            ordered.append(pair)
            done.update(pair[1].determines)
    return ordered


def _groups(members: Sequence[tuple[BoundConstraint, Constraint]], n: int) -> tuple[Group, ...]:
    """Labels that move together, with the roles in which they do."""
    labels: dict[int, list[int]] = {k: [k] for k in range(n)}
    role: dict[int, list[Any]] = {k: [] for k in range(n)}
    leader = list(range(n))
    for bound, constraint in members:
        follows = len(constraint.lower) == 0
        if follows and len(constraint.determines) == 1 and len(constraint.reads) == 1:
            (k,), (source,) = constraint.determines, constraint.reads
            leader[k] = leader[source]
            place = labels[leader[k]].index(source)
            labels[leader[k]].append(k)
            role[leader[k]].append((bound.role, place))
            del labels[k]
        elif not follows and len(constraint.determines) == 1 and not constraint.reads:
            role[constraint.determines[0]].append(bound.role)
        else:
            # Nothing is known of such a constraint: what it touches stays where it is.
            for k in (*constraint.determines, *constraint.reads):
                role[leader[k]].append(("fixed", k))
                if follows and k in constraint.determines and constraint.reads:
                    new = leader[constraint.reads[0]]
                    leader[k] = new
                    labels[new] += labels.pop(k, [])
    return tuple(Group(members=tuple(labels[k]), role=tuple(role[k])) for k in sorted(labels))


def _checked_rows(bound: BoundConstraint, rows: Any, shape: tuple[int, ...]) -> FloatArray:
    """Rows that a constraint returned, checked."""
    array = np.asarray(rows, dtype=np.float64)
    if array.shape != shape:
        raise PluginError(
            f"constraint '{bound.id}' of {bound.distribution} returned an array of shape"
            f" {array.shape}; centres are {shape}; {REPORT}"
        )
    return array


def _listed(texts: Sequence[str]) -> str:
    return " and ".join(f"'{text}'" for text in texts)
