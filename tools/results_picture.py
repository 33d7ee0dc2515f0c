"""Draw ``docs/images/results.png``: the samples, as moseg cuts them, in a row.

Run it from anywhere::

    python tools/results_picture.py

Each shape is searched with the recipe that is named here and seed 0, so that whoever reads the
picture can make the same result.
"""

from __future__ import annotations

import io
from pathlib import Path

from PIL import Image

import moseg_core as moseg

DESTINATION = Path(__file__).resolve().parent.parent / "docs" / "images" / "results.png"
SIZE = (700, 420)
COLOURS = 96

#: For each sample the recipe that it is cut by.
RECIPES = {
    "octopus": "octopus",
    "horse": "fourleg",
    "hammer": "hammer",
    "bulldog": "fourleg",
}
