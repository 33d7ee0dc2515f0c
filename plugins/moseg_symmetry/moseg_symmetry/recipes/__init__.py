"""The recipes of the paper's Figure 9 with symmetry constraints, as TOML files beside this."""

from __future__ import annotations

from importlib.resources import files

PAPER_BULLDOG = files(__name__).joinpath("paper_bulldog.toml").read_text(encoding="utf-8")
PAPER_DOVE = files(__name__).joinpath("paper_dove.toml").read_text(encoding="utf-8")
