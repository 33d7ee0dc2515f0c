"""moseg: people who know a shape tell the computer how to cut it into named parts.

::

    import moseg_core as moseg

    shape = moseg.load("hammer.ply")
    problem = moseg.Problem(["handle", "head"],
                            "3*narrow(handle) + perpendicular(handle, head) + convex_parts")
    result = moseg.segment(shape, problem, seed=0)
    moseg.save(result, "hammer.glb")

Names are imported when they are first used, so that ``moseg --help`` and the listing of plugins
load no numerical library. Where each is defined is written once, in the stub ``__init__.pyi``
that type checkers read.
"""

from __future__ import annotations

import importlib
from functools import cache
from typing import Any

from moseg_core.components.discovery import contract

__version__ = contract.VERSION


@cache
def _homes() -> dict[str, str]:
    """Of each public name, the module that defines it; read on first use, as it takes a while."""
    import re
    from pathlib import Path

    stub = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    found = re.findall(r"^from (\S+) import (\w+) as \2$", stub, re.MULTILINE)
    return {name: home for home, name in found}


def __getattr__(name: str) -> Any:
    """Import a public name on first use; also make ``__all__``, the list of them."""
    if name == "__all__":
        value: Any = ["__version__", *_homes()]
    elif name in _homes():
        value = getattr(importlib.import_module(_homes()[name]), name)
    else:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__getattr__("__all__"))
