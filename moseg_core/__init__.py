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
import re
from pathlib import Path
from typing import Any

from moseg_core.components.discovery import contract

__version__ = contract.VERSION

_HOMES = {
    name: home
    for home, name in re.findall(
        r"^from (\S+) import (\w+) as \2$",
        Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
}

__all__ = ["__version__", *_HOMES]


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _HOMES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    value = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
