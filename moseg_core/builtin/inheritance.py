"""What children have of their parents, where an individual is a labelled list of places.

Algorithm 3 (:mod:`moseg_core.builtin.evolution`) breeds sets of centres and asks anew in each
generation which label suits which. Here labels are inherited: a child has the leg of one parent and
the head of the other, so what a label has found out about its place is not lost, and the fitness is
the cost of the labels that the individual has.

Random numbers are drawn in this order:

- a crossover: ``random(g)``, the first parent's where it is below a half;
- a mutation: ``random()`` for what happens, ``integers(g)`` for the label, and then, below 0.35:
  ``integers(k)`` for a near place; below 0.65: ``integers(s)`` for any place; below 0.85:
  ``integers`` for a label of the same role to exchange places with; else ``integers(4)`` for the
  size class, where the label has one, and any place where not;
- of places that come twice in a child the later one: ``integers(s)`` until it is a new one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from moseg_core.builtin.places import Places
from moseg_core.builtin.sizes import CLASSES, Sizes
from moseg_core.types import IntArray

#: Of mutations, those below the first move to a near place, below the second to any, below the
#: third exchange two labels; the rest change the class of a size.
_NEAR, _ANY, _EXCHANGE = 0.35, 0.65, 0.85


@dataclass(frozen=True, eq=False, kw_only=True)
class Individual:
    """Places by label.

    Parameters
    ----------
    places : (g,) int
        Numbers of g different places.
    classes : (g,) int
        Class of each label's size.
    """

    places: IntArray
    classes: IntArray

    @property
    def key(self) -> bytes:
        """The same for equal individuals."""
        return self.places.tobytes() + self.classes.tobytes()


def cross(first: Individual, second: Individual, rng: np.random.Generator) -> Individual:
    """A child that has the place and the size of each label from either parent.

    Places may come twice in it: see :func:`without_repeats`.
    """
    own = rng.random(len(first.places)) < 0.5
    return Individual(
        places=np.where(own, first.places, second.places),
        classes=np.where(own, first.classes, second.classes),
    )


def mutate(
    individual: Individual,
    places: Places,
    sizes: Sizes,
    roles: IntArray,
    rng: np.random.Generator,
) -> Individual:
    """The individual with one change: of a label's place, of two labels' places, or of a size.

    Places may come twice in it: see :func:`without_repeats`.

    Parameters
    ----------
    individual : Individual
    places : Places
    sizes : Sizes
    roles : (g,) int
        Only labels in the same role exchange places.
    rng : numpy.random.Generator
    """
    chosen, classes = individual.places.copy(), individual.classes
    what, label = rng.random(), int(rng.integers(len(chosen)))
    near = places.near[chosen[label]]
    others = np.flatnonzero(roles == roles[label])
    if what < _NEAR and len(near):
        chosen[label] = near[rng.integers(len(near))]
    elif _ANY <= what < _EXCHANGE and len(others) > 1:
        others = others[others != label]
        other = others[rng.integers(len(others))]
        chosen[[label, other]] = chosen[[other, label]]
    elif what >= _EXCHANGE and sizes.evolve[label]:
        classes = classes.copy()
        classes[label] = rng.integers(len(CLASSES))
    else:
        chosen[label] = rng.integers(len(places))
    return replace(individual, places=chosen, classes=classes)


def without_repeats(individual: Individual, n_places: int, rng: np.random.Generator) -> Individual:
    """The individual with a new place for each label whose place an earlier label has."""
    chosen = individual.places.tolist()
    if len(set(chosen)) == len(chosen):
        return individual
    taken: set[int] = set()
    for k in range(len(chosen)):
        while chosen[k] in taken:
            chosen[k] = int(rng.integers(n_places))
        taken.add(chosen[k])
    return replace(individual, places=np.array(chosen))
