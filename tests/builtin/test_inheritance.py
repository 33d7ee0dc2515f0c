"""What children have of their parents."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.builtin.inheritance import Individual, cross, mutate, without_repeats
from moseg_core.builtin.places import Places
from moseg_core.builtin.sizes import CLASSES, Sizes

S = 12
PLACES = Places(
    elements=np.arange(S), near=np.array([[(k + 1) % S, (k - 1) % S] for k in range(S)])
)
SIZES = Sizes.of(np.array([np.nan, 0.3, np.nan, 0.1]), "expected")
ROLES = np.array([0, 0, 1, 0])

individuals = st.builds(
    lambda places, classes: Individual(places=np.array(places), classes=np.array(classes)),
    st.lists(st.integers(0, S - 1), min_size=4, max_size=4, unique=True),
    st.lists(st.integers(0, len(CLASSES) - 1), min_size=4, max_size=4),
)
seeds = st.integers(0, 500)


@given(first=individuals, second=individuals, seed=seeds)
def test_a_child_has_place_and_size_of_each_label_from_the_same_parent(first, second, seed):
    child = cross(first, second, np.random.default_rng(seed))
    own = np.random.default_rng(seed).random(4) < 0.5
    for k in range(4):
        parent = first if own[k] else second
        assert child.places[k] == parent.places[k]
        assert child.classes[k] == parent.classes[k]


@given(individual=individuals, seed=seeds)
def test_a_mutation_is_one_change_that_roles_and_sizes_allow(individual, seed):
    before = individual.key
    mutant = mutate(individual, PLACES, SIZES, ROLES, np.random.default_rng(seed))
    assert individual.key == before
    moved = np.flatnonzero(mutant.places != individual.places)
    grown = np.flatnonzero(mutant.classes != individual.classes)
    assert len(grown) == 0 or (len(grown) == 1 and len(moved) == 0 and SIZES.evolve[grown[0]])
    assert len(moved) <= 2
    if len(moved) == 2:
        assert mutant.places[moved].tolist() == individual.places[moved[::-1]].tolist()
        assert ROLES[moved[0]] == ROLES[moved[1]]


def test_every_kind_of_mutation_happens_as_often_as_it_should():
    individual = Individual(places=np.array([0, 3, 6, 9]), classes=np.full(4, 2))
    sizes = Sizes.of(np.full(4, np.nan), "expected")
    rng, roles = np.random.default_rng(0), np.zeros(4, int)
    counts = {"near": 0, "exchange": 0, "size": 0}
    for _ in range(4000):
        mutant = mutate(individual, PLACES, sizes, roles, rng)
        moved = np.flatnonzero(mutant.places != individual.places)
        if len(moved) == 2:
            counts["exchange"] += 1
        elif len(moved) == 1:
            step = (mutant.places - individual.places)[moved[0]] % S
            counts["near"] += step in (1, S - 1)
        counts["size"] += (mutant.classes != individual.classes).any()
    assert abs(counts["near"] / 4000 - (0.35 + 0.3 * 2 / 12)) < 0.04
    assert abs(counts["exchange"] / 4000 - 0.2) < 0.03
    assert abs(counts["size"] / 4000 - 0.15 * 3 / 4) < 0.03


@given(places=st.lists(st.integers(0, 5), min_size=5, max_size=5), seed=seeds)
def test_repeats_get_new_places_and_nothing_else_does(places, seed):
    child = Individual(places=np.array(places), classes=np.arange(5) % 4)
    found = without_repeats(child, 6, np.random.default_rng(seed))
    assert len(set(found.places.tolist())) == 5
    assert found.classes.tolist() == child.classes.tolist()
    first = [k for k in range(5) if places[k] not in places[:k]]
    taken = [places[k] for k in first]
    kept = [k for k in first if found.places[k] == places[k]]
    # A first holder loses its place only to a repeat that drew it before its turn.
    assert kept == first or any(found.places[k] in taken for k in range(5) if k not in first)
    assert set(found.places.tolist()) <= set(range(6))


def test_one_label_and_one_place_leave_nothing_to_change():
    alone = Places(elements=np.arange(1), near=np.empty((1, 0), int))
    individual = Individual(places=np.array([0]), classes=np.array([2]))
    equal = Sizes.of(np.array([np.nan]), "equal")
    for seed in range(30):
        mutant = mutate(individual, alone, equal, np.zeros(1, int), np.random.default_rng(seed))
        assert mutant.key == individual.key
