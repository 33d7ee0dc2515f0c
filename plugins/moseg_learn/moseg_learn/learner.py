"""The learner ``profiles``: a recipe of what the parts of the examples are like.

What it writes is what a person would, who had measured: for each kind a table of the typical value
and spread of each measure (:mod:`moseg_learn.profile`), which parts touch and which never do
(:mod:`moseg_learn.relations`), how many there are of each (:mod:`moseg_learn.label_sets`), how
likely each place is to bear the label (:mod:`moseg_learn.discriminant`), that parts are joined
along short lines in creases, and how to search for all that. Each is a term of the recipe's
expression, with a weight that its owner can change.

Parts judged as parts, and places judged one by one, agree better with people together than either
alone; Kalogerakis, Hertzmann and Singh 2010, doi:10.1145/1778765.1778839, learn the latter with
the relation of neighbours.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Any

from moseg_core import Example, Interval, Method, Recipe, Statement, Table, UsageError
from moseg_learn.discriminant import fit_looks
from moseg_learn.label_sets import LabelSets, label_sets_of
from moseg_learn.names import argument, check_numbers
from moseg_learn.pieces import Pieces, pieces_of
from moseg_learn.profile import profiles_of
from moseg_learn.relations import Relation, relations_of

_SEARCH = Method(
    parameterization="voronoi(centers=auto)",
    seeder="sized_evolution(population=40, generations=25, relocations=0)",
    optimizer="pattern_search(expansion=1, threshold=0.005, combine=true)",
)
"""How a learned recipe is searched: bodies of several cells, small parts found by their size.

A body, a head, four legs and a tail of up to three cells have 60 coordinates and more. Several
moves at once and steps that never grow took 18 to 63 % of the evaluations on a teddy, an armadillo
and a machine part, the less the more coordinates, and ended 1 to 3 % higher before the polish.

Where a refiner moves the boundaries and there are several label sets, nothing is polished: on 8
models of 19 label sets that took two fifths of the time and made results cheaper by .6 %; the area
named right was 84.9 % either way. Where there is one label set one result is polished: of 12 models
whose own parts had cost less than what was found, 7 were left.
"""

_PLACES = 2.0
"""What a refiner multiplies the negative logarithm of a place's likelihood by.

With it, in a band of two fifths of the diagonal, 1 - Rand Index was .116 and 89.9 % of the area
named right, the mean over 95 models left out in turn; .119 and 89.7 % in a band of a fifth, .117
and 89.5 % with twice the factor. Before any refiner it was .132 and 87.9 %.
"""

_STARTS = 4
"""How often, where there is one label set; where there are several, each is searched once.

With four starts in place of two, of five hands under three seeds 94.2 % of the area was named right
in place of 90.3: of one of them the thumb was found each time.
"""


def profiles(
    examples: Sequence[Example],
    *,
    numbers: str = "alike",
    separate: Annotated[float, Interval(0)] = 10.0,
    likely: Annotated[float, Interval(0)] = 0.5,
    touching: Annotated[float, Interval(0)] = 2.0,
    apart: Annotated[float, Interval(0)] = 0.5,
    refiner: str | None = "auto",
    prior: Annotated[float, Interval(0.5)] = 6.0,
    floor: Annotated[float, Interval(0.1)] = 2.0,
    resolution: Annotated[int, Interval(0)] = 2000,
) -> Recipe:
    """A recipe of what the parts of examples are like, and how they lie to each other.

    Parameters
    ----------
    examples : sequence of Example
        One is enough to begin with; each more says better what varies.
    numbers : str
        "alike": ``finger1`` and ``finger2`` are both of the kind ``finger``; "different": they are
        kinds of their own.
    separate : float
        Weight of ``separate_parts``; 0 leaves the term out, here and below. Of solids and clouds,
        which have no creases, it is that of ``short_boundaries``.
    likely : float
        Weight of how likely the places of a part are to bear its label. With 1 in place of 0.5,
        1 - Rand Index came out at .122 in place of .117, the mean over 95 models left out in turn.
    touching, apart : float
        Weight of each pair of parts that always touches, or never does.
    refiner : str or None
        What moves boundaries at the end, if anything; "auto" is a ``graph_cut`` that goes by
        creases and, with two or more examples, by how likely places are.
    prior : float
        How many parts the common spread counts as in the spread of a kind.
    floor : float
        How many times the least spread of each measure is added to the common one.
    resolution : int
        On how many super-elements the examples are measured; 0: on their own elements.

    Returns
    -------
    Recipe

    Raises
    ------
    UsageError
        All examples are of one part. Where others are not, those that are count for nothing: they
        do not show where parts meet.
    ShapeError
        A shape lacks what is measured.
    """
    check_numbers(numbers)
    seen = sorted(
        (pieces_of(example, numbers=numbers) for example in examples),
        key=lambda pieces: (pieces.described(), pieces.shape.fingerprint),
    )
    cut = [pieces for pieces in seen if len(pieces.kinds) > 1]
    if not cut:
        raise UsageError(
            f"'{seen[0].shape.name}' is one part, {seen[0].kinds[0]}; an example shows where parts"
            f" meet, so label two or more"
        )
    measured = [pieces.at(resolution) for pieces in cut]
    sets = label_sets_of([pieces.counts() for pieces in cut])
    tables = profiles_of(measured, prior=prior, floor=floor)
    relations = relations_of(measured)
    given: dict[str, Any] = dict(tables)
    looks = "" if not likely or not _has_looks(cut) else _free_name("looks", tables)
    if looks:
        given[looks] = fit_looks([pieces.as_kinds() for pieces in cut])
    terms = [
        *_profile_terms(sets),
        *(_likely_terms(likely, looks, sets) if looks else []),
        *_relation_terms("touching", touching, relations.touching, sets),
        *_relation_terms("apart", apart, relations.apart, sets),
        *_boundary_terms(separate, cut),
    ]
    moved = _refiner(refiner, likely if looks and len(cut) > 1 else 0.0)
    statement = Statement(
        labels=sets.stated,
        variants=sets.variants,
        minimize=" + ".join(terms),
        given=Table(given),
        search=replace(
            _SEARCH,
            refiner=moved,
            restarts=1 if sets.variants else _STARTS,
            polished=None if moved is None else int(not sets.variants),
        ),
    )
    n = len(cut)
    return Recipe(
        name="learned",
        statement=statement,
        description=f"Learned from {n} example{'s' * (n > 1)}.",
        learned_from=(
            *(pieces.described() for pieces in cut),
            *(f"{p.described()} (not learned from: one part)" for p in seen if p not in cut),
        ),
    )


def _refiner(asked: str | None, likely: float) -> str | None:
    """The refiner of the recipe.

    Parameters
    ----------
    asked : str or None
    likely : float
        Weight of likely places; 0 where these are not to move boundaries. Of one example it is not
        known how far what it looks like holds for others.
    """
    if asked != "auto":
        return asked
    if not likely:
        return "graph_cut(band=0.2)"
    return f"graph_cut(band=0.4, data={_PLACES / likely:g})"


def _profile_terms(sets: LabelSets) -> Iterator[str]:
    """``is(leg*, given=leg)`` for each kind."""
    for kind in sets.labels:
        yield f"is({_labels(kind, sets)}, given={kind})"


def _has_looks(examples: Sequence[Pieces]) -> bool:
    """Whether all are surfaces of which is known which elements touch."""
    return all(
        pieces.shape.adjacency is not None and pieces.shape.has_surface for pieces in examples
    )


def _boundary_terms(weight: float, examples: Sequence[Pieces]) -> Iterator[str]:
    """The term about where parts meet, as far as the examples' shapes can tell."""
    if weight and _has_looks(examples):
        yield _weighted(weight, "separate_parts")
    elif weight and all(pieces.shape.adjacency is not None for pieces in examples):
        yield _weighted(weight, "short_boundaries")


def _free_name(name: str, taken: Container[str]) -> str:
    """The name, with as many ``_`` behind it as tell it from others."""
    while name in taken:
        name += "_"
    return name


def _likely_terms(weight: float, looks: str, sets: LabelSets) -> Iterator[str]:
    """``likely(leg*, kind=leg, among=looks)`` for each kind."""
    for kind in sets.labels:
        yield _weighted(weight, f"likely({_labels(kind, sets)}, kind={kind}, among={looks})")


def _relation_terms(
    name: str, weight: float, relations: Sequence[Relation], sets: LabelSets
) -> Iterator[str]:
    """Calls of an objective whose value is a mean over pairs, with the weight of all of these."""
    for relation in relations if weight else ():
        labels = ", ".join(_labels(kind, sets) for kind in relation.kinds)
        yield _weighted(weight * relation.pairs, f"{name}({labels})")


def _labels(kind: str, sets: LabelSets) -> str:
    own = sets.labels[kind]
    others = (label for other, labels in sets.labels.items() if other != kind for label in labels)
    return argument(kind, own, others)


def _weighted(weight: float, call: str) -> str:
    return call if weight == 1 else f"{weight:g}*{call}"
