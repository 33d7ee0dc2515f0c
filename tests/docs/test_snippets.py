"""Python in the README and on the pages runs as it is written.

A page is run from top to bottom in one namespace, in a folder with files of the names that pages
use: shapes of some hundred faces, so that a search takes a moment. What cannot be run says so to
sybil in a comment on the page, ``<!--- skip: next "why" -->``; what a reader has from the text
before stands in one that is run, ``<!--- invisible-code-block: python``.
"""

from __future__ import annotations

import itertools
import json
import re
import sys
from contextlib import suppress
from functools import partial
from pathlib import Path
from unittest import SkipTest

import numpy as np
import pytest
import trimesh
from sybil import Sybil
from sybil.parsers.myst import PythonCodeBlockParser, SkipParser

import moseg_core as moseg
from tests import shapes

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("plugins/*/README.md")])
WITH_PYTHON = [
    page
    for page in PAGES
    if re.search(r"^```python$", page.read_text(), re.MULTILINE) and "generated" not in page.parts
]
SYBIL = Sybil(parsers=[PythonCodeBlockParser(), SkipParser()])


def cubes(*spans: tuple[range, range, range]) -> shapes.Mesh:
    """A body of unit cubes: all those within the spans."""
    return shapes.solid(cell for span in spans for cell in itertools.product(*span))


#: Small shapes for the names of files that pages read.
SHAPES = {
    "hammer.ply": shapes.tee(stem=6, bar=5),
    "horse.ply": cubes(
        (range(6), range(2), range(3, 5)),  # the body
        (range(-2, 0), range(2), range(4, 6)),  # the head
        *((range(x, x + 1), range(y, y + 1), range(3)) for x in (0, 5) for y in (0, 1)),
    ),
}
SHAPES["bulldog.ply"] = SHAPES["octopus.off"] = SHAPES["horse.ply"]


#: What is given to a search where a page does not say it.
SHORT = {"restarts": 1, "optimizer": "pattern_search(max_evaluations=50)"}

#: A module of the reader's own.
MINE = "".join(
    re.search(r"^```python\n(.*?)^```", (ROOT / "docs/authors" / page).read_text(), re.M | re.S)[1]
    for page in ("optimizer.md", "seeder.md")
)


def animal_labels(points: np.ndarray) -> dict[str, list]:
    """Of each place on the small animal its part, as a file of labels."""
    x, y, z = points.T
    leg = 2 + 2 * (x > 3) + (y > 1)
    labels = np.where(x < 0, 1, np.where(z < 3, leg, 0))
    names = ["body", "head", "leg1", "leg2", "leg3", "leg4"]
    return {"labels": labels.tolist(), "names": names}


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """A folder with the files that pages read, which is the current one."""
    for name, mesh in SHAPES.items():
        vertices, faces = shapes.fan(mesh)
        trimesh.Trimesh(vertices, faces, process=False).export(tmp_path / name)
        labels = animal_labels(vertices[np.array(faces)].mean(axis=1))
        (tmp_path / name).with_suffix(".json").write_text(json.dumps(labels))
    (tmp_path / "my_module.py").write_text(MINE + "\n\nMySeeder = Spread\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("segment", "segment_hierarchy", "segment_variants"):
        monkeypatch.setattr(moseg, name, partial(getattr(moseg, name), **SHORT))
    yield tmp_path
    sys.modules.pop("my_module", None)


@pytest.mark.parametrize("page", WITH_PYTHON, ids=lambda page: str(page.relative_to(ROOT)))
def test_what_a_page_says_in_python_runs(page, folder):
    document = SYBIL.parse(page)
    for example in document.examples():
        with suppress(SkipTest):
            example.evaluate()
