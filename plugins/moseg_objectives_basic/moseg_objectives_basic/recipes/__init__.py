"""Recipes, as TOML files beside this module.

Each says of a shape what a person would: how large, how thick and where its parts are, give or
take, what touches what, and that parts are separate. A name that begins with ``paper_``, and
``symmetry_then_convex``, stand for a recipe as the paper's Figures 8 and 9 print it.
"""

from __future__ import annotations

from importlib.resources import files


def _text(name: str) -> str:
    return files(__name__).joinpath(f"{name}.toml").read_text(encoding="utf-8")


ANY_SHAPE = _text("any_shape")
HAMMER = _text("hammer")
PAPER_HAMMER = _text("paper_hammer")
PAPER_HORSE = _text("paper_horse")
SYMMETRY_THEN_CONVEX = _text("symmetry_then_convex")
WORDS_BIRD = _text("words_bird")
WORDS_CHAIR = _text("words_chair")
WORDS_CUP = _text("words_cup")
WORDS_FOURLEG = _text("words_fourleg")
WORDS_HAND = _text("words_hand")
WORDS_OCTOPUS = _text("words_octopus")
WORDS_TABLE = _text("words_table")
