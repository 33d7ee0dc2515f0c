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
    "labels": "The parts to find.",
    "variants": "The sets of parts that were seen; the one that fits a shape best is taken.",
    "minimize": """\
What a segmentation costs; the search looks for the cheapest. A number in front of a term says how
much it counts.
  is(leg*, given=leg)        each leg measures as the table [given.leg] says
  likely(leg*, kind=leg, ..) each leg lies where the surface looks as on the legs of the examples
  touching(body, leg*)       the first part touches each of the others
  apart(head, leg*)          no two of these parts touch
  separate_parts             parts are joined along short lines, in creases
Add a term of your own, such as + narrow(leg*); 'moseg plugin list' names what there is.""",
    "parameterization": "How it is searched; 'moseg plugin explain voronoi' says more.",
}
"""What is said before the line of a key."""

_PROFILES = """\
What each kind of part measures: the typical value +- how far from it is still usual. Narrow a
spread to insist on a value, delete a line where it should not count.
  area                       share of the whole surface
  length, width, depth       along the part's own three axes; 1 is the diagonal of the shape's box
  spread                     how far it reaches for its area: a ball 0.28, a square sheet 0.41
  offcenter                  how far its middle is from that of the shape, in diagonals
  thickness                  how thick it is, from one side to the other, in diagonals
  unevenness                 how much its thickness varies; 0 where it is the same everywhere
  remoteness                 how far out it lies: 1 in the middle of the shape, 2 and more at tips
  nearest, farthest          the remoteness of its innermost and of its outermost place
  boundary                   length of the line where it is joined on, over the root of its area
  crease                     how deep a crease that line lies in: 0 flat, positive in a crease"""

_LOOKS = """\
What places of each kind look like: how much more (or less, where negative) a place is taken to be
of the kind for each unit of a quantity. area_within_8 is about what lies within 8 % of the
diagonal. Such numbers are found by a fit, all together; to do without them, delete these tables
and the terms 'likely'."""


def annotated(recipe: Recipe) -> str:
    """The TOML text of a recipe with comments.

    Parameters
    ----------
    recipe : Recipe
        Made by the learner ``profiles``; others get the comments that suit them.

    Examples
    --------
    >>> from moseg_core import Recipe, Statement
    >>> recipe = Recipe(name="mine", statement=Statement(labels=("a", "b"), minimize="narrow(a)"))
    >>> annotated(recipe).splitlines()[:2]
    ['# The parts to find.', 'labels = ["a", "b"]']
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
