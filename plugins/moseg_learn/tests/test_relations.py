from __future__ import annotations

import numpy as np
from moseg_learn.pieces import Pieces, pieces_of
from moseg_learn.relations import Relation, _cliques, _stars, relations_of

from moseg_core import Example, Shape


def test_legs_touch_the_body_and_nothing_else(herd):
    found = relations_of([pieces_of(example) for example in herd])
    assert found.touching == (Relation(kinds=("body", "head", "leg"), pairs=4),)
    # Of the tail there is one pair with a head: too few to make a rule of.
    assert found.apart == (
        Relation(kinds=("head", "leg"), pairs=6),
        Relation(kinds=("leg", "tail"), pairs=6),
    )


def test_one_pair_makes_no_rule(make):
    found = relations_of([pieces_of(make.beast(legs=1))])
    assert found.touching == found.apart == ()


def test_what_is_seen_both_ways_is_no_rule(make):
    example = make.beast()
    apart = pieces_of(example)
    rng = np.random.default_rng(0)
    mixed = Pieces(
        shape=apart.shape, labels=rng.integers(0, 5, len(apart.labels)), kinds=apart.kinds
    )
    found = relations_of([apart, mixed])
    assert found.touching == (Relation(kinds=("body", "head", "leg"), pairs=4),)
    assert found.apart == ()


def test_nothing_is_said_where_it_is_not_known_what_touches():
    points = np.random.default_rng(0).normal(size=(40, 3))
    cloud = Example(Shape.from_points(points), np.arange(40) % 2, ("a", "b"))
    found = relations_of([pieces_of(cloud)])
    assert found.touching == found.apart == ()


def test_stars_cover_the_pairs_around_kinds_of_one_part():
    most = {"body": 1, "head": 1, "ear": 2, "leg": 4}
    pairs = {("body", "head"), ("body", "leg"), ("ear", "head"), ("ear", "leg")}
    assert _stars(pairs, most) == [
        Relation(kinds=("body", "head", "leg"), pairs=5),
        Relation(kinds=("head", "ear"), pairs=2),
    ], "ears and legs have no kind of one part between them"


def test_cliques_cover_the_pairs_and_say_nothing_that_was_not_seen():
    most = {"a": 1, "b": 1, "c": 1, "leg": 2, "fin": 2}
    pairs = {("a", "b"), ("a", "c"), ("b", "leg"), ("leg", "leg"), ("a", "fin")}
    found = _cliques(pairs, most)
    said = set()
    for relation in found:
        for one in relation.kinds:
            for other in relation.kinds:
                if one < other or (one == other and most[one] > 1):
                    said.add((one, other))
    # Whether two fins touch is not known, so a call could not speak of both.
    assert said == pairs - {("a", "fin")}
