"""Places drawn for labels by what the problem says of places.

An evolution that begins with places at random has to find out by chance that one hand is on the
left and the other on the right, and so for each pair of limbs. Where terms of the problem are means
of fields (:mod:`moseg_core.builtin.data_term`), such as how unlikely it is that a place is part of
a hand, the fields already say where a label may be. A place `s`, with the area `A(s)` of the
elements nearest to it, is then drawn for a label with a chance in proportion to

    A(s) exp(-6 (c(s) - min c) / sigma_c) d(s)^2,

where `c(s)` is the mean over those elements of what the label costs there, `sigma_c` its standard
deviation over the surface, and `d(s)` the distance to the nearest place that was drawn for a label
of which the same is said: so that two hands go to both sides, as centres of clusters do in
k-means++ (Arthur and Vassilvitskii 2007). The labels come in random order, and each gets another
place.

Dividing by `sigma_c` makes chances independent of weights and units. On 19 searches for the parts
of armadillos, people, a four-legged animal and a vase results were 7 to 8 % cheaper than without,
with 3 in place of 6 they were 6 to 7 % cheaper.

:mod:`moseg_core.builtin.sized_evolution` draws some of its first generation so.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from moseg_core.builtin.data_term import place_costs, place_terms
from moseg_core.problem.problem import Problem
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, IntArray

#: How much a standard deviation of its cost speaks against a place, as a logarithm.
_SHARPNESS = 6.0


@dataclass(frozen=True, eq=False, kw_only=True)
class LikelyPlaces:
    """The chances of places for labels.

    Parameters
    ----------
    points : (s, 3) float, model units
        Where the places are.
    chances : (s, g) float
        In proportion to how often each is drawn for a label, while no other label is near.
    alike : (g,) int
        Equal for labels of which the same is said.
    """

    points: FloatArray
    chances: FloatArray
    alike: IntArray

    @classmethod
    def of(
        cls, problem: Problem, shape: Shape, elements: IntArray, labels: IntArray
    ) -> LikelyPlaces | None:
        """The chances that a problem gives to places, or None where it says nothing of any.

        Parameters
        ----------
        problem : Problem
        shape : Shape
            The version that is searched.
        elements : (s,) int
            The places.
        labels : (g,) int
            The labels to draw places for. One of which no term speaks may be anywhere.

        Raises
        ------
        MosegError
            See :func:`~moseg_core.builtin.data_term.place_costs`.
        """
        terms = place_terms(problem)
        if not any(set(term.labels) & set(labels.tolist()) for term in terms):
            return None
        points = shape.points[elements]
        nearest: IntArray = np.asarray(cKDTree(points).query(shape.points)[1], np.int64)
        areas = np.bincount(nearest, shape.areas, len(points)).astype(np.float64)
        chances = np.tile(areas[:, None], len(labels))
        costs = place_costs(problem, shape, np.arange(shape.n_elements))
        said = [
            tuple(k for k, term in enumerate(terms) if label in term.labels)
            for label in labels.tolist()
        ]
        for column, label in enumerate(labels.tolist()):
            if said[column]:
                own = costs[:, label]
                chances[:, column] *= _chance(own, shape.areas, nearest, len(points))
        known = list(dict.fromkeys(said))
        return cls(points=points, chances=chances, alike=np.array([known.index(s) for s in said]))

    def draw(self, rng: np.random.Generator) -> IntArray:
        """(g,) int: numbers of different places, one for each label.

        Draws ``permutation(g)`` for the order of the labels and, for each, ``random()``.
        """
        n_places, g = self.chances.shape
        drawn = np.full(g, -1)
        free = np.ones(n_places, np.bool_)
        for label in rng.permutation(g).tolist():
            chances = np.where(free, self.chances[:, label], 0.0)
            like = drawn[(self.alike == self.alike[label]) & (drawn >= 0)]
            if len(like):
                apart = ((self.points[:, None] - self.points[like]) ** 2).sum(axis=2)
                chances = chances * apart.min(axis=1)
            up_to = np.cumsum(chances if chances.sum() > 0 else free.astype(np.float64))
            place = int(np.searchsorted(up_to, rng.random() * up_to[-1], side="right"))
            drawn[label] = place = min(place, int(np.flatnonzero(np.diff(up_to, prepend=0))[-1]))
            free[place] = False
        return drawn


def _chance(costs: FloatArray, areas: FloatArray, nearest: IntArray, n_places: int) -> FloatArray:
    """(s,) float: how likely a label is at each place by what elements cost, 1 where most.

    Parameters
    ----------
    costs, areas : (F,) float
        Of the elements.
    nearest : (F,) int
        The place nearest to each.
    n_places : int
    """
    sigma = np.sqrt(np.average((costs - np.average(costs, weights=areas)) ** 2, weights=areas))
    if sigma == 0:
        return np.ones(n_places)
    weights = np.bincount(nearest, areas, n_places)
    # A place that is nearest to no element has no area either, and is not drawn.
    means = np.bincount(nearest, areas * costs, n_places) / np.where(weights > 0, weights, 1.0)
    least = means[weights > 0].min()
    found: FloatArray = np.exp(np.minimum(0.0, -_SHARPNESS * (means - least) / sigma))
    return found
