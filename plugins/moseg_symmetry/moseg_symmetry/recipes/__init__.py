"""The recipes of the paper's Figure 9 with symmetry constraints, as TOML files beside this."""

from __future__ import annotations

from importlib.resources import files

BULLDOG = files(__name__).joinpath("bulldog.toml").read_text(encoding="utf-8")
DOVE = files(__name__).joinpath("dove.toml").read_text(encoding="utf-8")
