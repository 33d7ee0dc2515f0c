"""The recipes of the paper's Figures 8 and 9, as TOML files beside this module."""

from __future__ import annotations

from importlib.resources import files

HAMMER = files(__name__).joinpath("hammer.toml").read_text(encoding="utf-8")
HORSE = files(__name__).joinpath("horse.toml").read_text(encoding="utf-8")
SYMMETRY_THEN_CONVEX = (
    files(__name__).joinpath("symmetry_then_convex.toml").read_text(encoding="utf-8")
)
ANY_SHAPE = files(__name__).joinpath("any_shape.toml").read_text(encoding="utf-8")
