"""Relations: which parts always touch in the examples, and which never do.

For two kinds, or one of several parts, all pairs of parts in all examples are looked at. What was
seen in two pairs or more, and in at least 95 % of them, is taken for a rule. Rules are gathered
into few calls that can be read: ``touching(body, head, leg*)`` for what touches one part in the
middle, ``apart(head, tail, leg*)`` for kinds no two parts of which touch.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from moseg_learn.pieces import Pieces

SEEN = 2
"""So many pairs make a rule."""

_SHARE = 0.95
_TOUCH = 0.01
"""A boundary of less than this, in diagonals of the shape, is none: a corner, or a slip."""


@dataclass(frozen=True, kw_only=True)
class Relation:
    """A rule about some kinds.

    Parameters
    ----------
    kinds : tuple of str
        Of a rule of touching the first is the one that all others touch.
    pairs : int
        How many pairs of parts it is about, where there are as many of each kind as there can be.
    """

    kinds: tuple[str, ...]
    pairs: int


@dataclass(frozen=True, kw_only=True)
class Relations:
    """All rules that were found.

    Parameters
    ----------
    touching, apart : tuple of Relation
    """

    touching: tuple[Relation, ...]
    apart: tuple[Relation, ...]


def relations_of(examples: Sequence[Pieces]) -> Relations:
    """The rules that examples show; none where it is not known which elements touch.

    Parameters
    ----------
    examples : sequence of Pieces
    """
    seen, met = dict[tuple[str, str], int](), dict[tuple[str, str], int]()
    most: dict[str, int] = {}
    for pieces in examples:
        for kind, n in pieces.counts().items():
            most[kind] = max(n, most.get(kind, 0))
        if pieces.shape.adjacency is None:
            return Relations(touching=(), apart=())
        boundaries = pieces.segmentation.boundaries.lengths
        near = boundaries > _TOUCH * pieces.shape.input.frame.scale
        for i, j in itertools.combinations(range(len(pieces.kinds)), 2):
            pair = _pair(pieces.kinds[i], pieces.kinds[j])
            seen[pair] = seen.get(pair, 0) + 1
            met[pair] = met.get(pair, 0) + bool(near[i, j])
    usual = {pair for pair, n in seen.items() if n >= SEEN and met[pair] >= _SHARE * n}
    never = {pair for pair, n in seen.items() if n >= SEEN and met[pair] <= (1 - _SHARE) * n}
    return Relations(touching=tuple(_stars(usual, most)), apart=tuple(_cliques(never, most)))


def _pair(one: str, other: str) -> tuple[str, str]:
    return (one, other) if one <= other else (other, one)


def _stars(pairs: Iterable[tuple[str, str]], most: dict[str, int]) -> list[Relation]:
    """Pairs gathered by a kind of one part that many others touch, the most first."""
    left, found = set(pairs), list[Relation]()
    while left:
        around: dict[str, list[str]] = {}
        for one, other in left:
            for hub, spoke in ((one, other), (other, one)):
                if most[hub] == 1:
                    around.setdefault(hub, []).append(spoke)
        if not around:
            break
        hub = min(around, key=lambda kind: (-len(around[kind]), kind))
        spokes = sorted(around[hub])
        found.append(Relation(kinds=(hub, *spokes), pairs=sum(most[kind] for kind in spokes)))
        left -= {_pair(hub, spoke) for spoke in spokes}
    return found


def _cliques(pairs: Iterable[tuple[str, str]], most: dict[str, int]) -> list[Relation]:
    """Sets of kinds no two parts of which touch, so that each pair is in one of them.

    A kind of several parts is only in a set where these do not touch each other either, as a call
    is about all pairs of its labels.
    """
    rules = set(pairs)
    usable = {kind for kind, n in most.items() if n == 1 or (kind, kind) in rules}
    left = {pair for pair in rules if pair[0] in usable and pair[1] in usable}
    found: list[Relation] = []
    while left:
        # From the pair that comes first, by all that can join, those with most still to say first.
        one, other = min(left, key=lambda pair: (pair[0] == pair[1], pair))
        clique = [one] if one == other else [one, other]
        while True:
            joins = [
                kind
                for kind in sorted(usable - set(clique))
                if all(_pair(kind, member) in rules for member in clique)
                and any(_pair(kind, member) in left for member in clique)
            ]
            if not joins:
                break
            news = {kind: sum(_pair(kind, member) in left for member in clique) for kind in joins}
            clique.append(min(joins, key=lambda kind: (-news[kind], kind)))
        n = sum(most[kind] for kind in clique)
        found.append(Relation(kinds=tuple(sorted(clique)), pairs=n * (n - 1) // 2))
        left -= {_pair(a, b) for a in clique for b in clique}
    return found
