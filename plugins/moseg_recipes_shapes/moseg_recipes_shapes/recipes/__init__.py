"""Learned recipes, as TOML files beside this module; ``FOURLEG`` is the text of ``fourleg.toml``.

``tools/learn_shape_recipes.py`` makes them from the models of the Princeton Segmentation Benchmark
(Chen, Golovinskiy and Funkhouser 2009, doi:10.1145/1531326.1531379), with the names of parts of
Kalogerakis, Hertzmann and Singh 2010, doi:10.1145/1778765.1778839. They hold numbers that were
measured on those models, and no shape. One is read when it is asked for.
"""

from __future__ import annotations

from importlib.resources import files


def __getattr__(name: str) -> str:
    """The text of a recipe, by its name in upper case."""
    file = files(__name__).joinpath(f"{name.lower()}.toml")
    if name.isupper() and file.is_file():
        return file.read_text(encoding="utf-8")
    raise AttributeError(f"module '{__name__}' has no recipe '{name}'")
