"""The recipe of the paper's Figure 9 that unfolds the shape, as a TOML file beside this."""

from __future__ import annotations

from importlib.resources import files

PAPER_OCTOPUS = files(__name__).joinpath("paper_octopus.toml").read_text(encoding="utf-8")
