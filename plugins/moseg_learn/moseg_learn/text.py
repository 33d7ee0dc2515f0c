"""The text of a learned recipe, with what its owner needs to know in order to change it.

Comments say of each line what it stands for, in the words of somebody who has never seen the
formulas. They are no part of the recipe: whoever reads it, :func:`moseg_core.load_recipe` above
all, gets what :meth:`moseg_core.Recipe.toml` says.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from moseg_core import Recipe

_BEFORE = {
    "labels": "The parts to find. leg{4} are four: leg1, leg2, leg3 and leg4.",
    "variants": """\
The sets of parts that were seen, and last all parts together where no example has them all: leg{4}
are four, leg1 to leg4. Add a set by hand where you know of another. Each is searched for, and the
one taken whose parts fit best on the mean, so that fewer parts are no advantage. What is said below
of parts that a set lacks is left out with them.""",
    "minimize": """\
What a segmentation costs; the search looks for the cheapest. It is a sum: the number before a term
says how much the term counts, 1 where there is none. leg* stands for every leg.
  is(leg*, given=leg)     how far each leg is from the measures in the table [given.leg]
  likely(leg*, kind=leg, among=looks)
                          how little the surface of each leg looks as it did on the examples' legs
  touching(body, leg*)    whether the first part touches each of the others
  apart(head, leg*)       whether any two of all these parts touch, legs among themselves too
  separate_parts          parts should be joined along short lines, in creases
Before touching and apart stand 2 and 0.5 for each pair of parts, unless asked otherwise; they say
what always, or never, was so. Change any number, delete a term, or add one, as + narrow(leg*): legs
longer than wide. 'moseg plugin list' names what there is.""",
    "parameterization": """\
How it is searched; nothing here says what is looked for. 'moseg plugin explain voronoi' says what a
name means.""",
}
"""What is said before the line of a key."""

_PROFILES = """\
What each kind of part measures on the examples: its typical value +- by how much parts usually
differ from it, more or less, twice which costs four times as much. What must be positive is
compared by ratio: half as much is as far off as twice as much. Make the number behind +- smaller
to insist on a value, delete a line that should not count.
  area                       share of the whole surface
  length, width, depth       along the part's own three axes, the longest first; 1 is the diagonal
                             of the box around the whole shape, here and below
  spread                     how far it reaches for its area: a ball 0.28, a square sheet 0.41
  offcenter                  how far its middle is from that of the whole shape, in diagonals
  thickness                  from each place straight through to the other side, on the mean, in
                             diagonals; a bent sheet is deep but not thick
  unevenness                 how much thickness varies, over its mean; 0 where it is the same
                             everywhere
  remoteness                 how far it is along the surface to everywhere else, beside the place
                             from which that is least: 1 in the middle of the shape, 2 at tips
  nearest, farthest          the remoteness of its innermost and of its outermost place
  boundary                   length of the line where it is joined on, over the square root of its
                             area; 3.5 for a disc
  crease                     how sharp a crease that line lies in: 0 where flat, 1 where the
                             surface turns by 60 degrees; negative along a ridge"""

_LOOKS = """\
What single places on each kind of part look like. Such a table is a fit: each number says how much
more (less, where negative) a place is taken for this kind where a quantity is greater by one, and
'constant' is added. Quantities that end in within_8 are of what lies within 8 % of the diagonal
around a place: area, length, width, depth, mean thickness, concavity and remoteness there; offset,
how far the middle of all that is from the place, and hollow, how far in front of it; flatness,
bending and doming, whether it is like a plane, a tube or a ball. concavity: how sharp a crease the
place itself lies in. from_center, lengthwise, from_axis: where in the whole shape it lies; outward,
facing_along, facing_across: which way it faces there. What begins with relative_ compares the place
with the rest of its shape: from -1, far less than usual, to 1, far more. The numbers mean something
together only, and are not made to be changed by hand; to do without them, delete these tables and
the terms 'likely'."""


def annotated(recipe: Recipe) -> str:
    r"""The TOML text of a recipe with comments.

    Parameters
    ----------
    recipe : Recipe
        Made by the learner ``profiles``; others get the comments that suit them.

    Examples
    --------
    >>> from moseg_core import Recipe, Statement
    >>> recipe = Recipe(name="mine", statement=Statement(labels=("a", "b"), minimize="narrow(a)"))
    >>> print(*annotated(recipe).splitlines()[:2], sep="\n")
    # The parts to find. leg{4} are four: leg1, leg2, leg3 and leg4.
    labels = ["a", "b"]
    """
    return "\n".join(_lines(recipe.toml().splitlines())) + "\n"


def _lines(lines: list[str]) -> Iterator[str]:
    said: set[str] = set()
    for line in lines:
        key = re.match(r"(\w+) = ", line)
        table = re.match(r"\[given\.(\w+)(\.\w+)?\]", line)
        if key and key[1] in _BEFORE and not said & {"profiles", "looks"}:
            yield from _comment(_BEFORE[key[1]])
        if table:
            which = "looks" if table[2] else "profiles"
            if which not in said:
                yield from _comment(_LOOKS if table[2] else _PROFILES)
                yield ""
            said.add(which)
        yield line


def _comment(text: str) -> Iterator[str]:
    yield from (f"# {line}".rstrip() for line in text.splitlines())
