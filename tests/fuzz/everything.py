"""All cases, in the order in which they are made."""

from __future__ import annotations

from functools import cache

from tests.fuzz.case import Case, checked
from tests.fuzz.checkpoints import checkpoint_cases
from tests.fuzz.clouds import cloud_cases
from tests.fuzz.counts import count_cases
from tests.fuzz.damage import damaged
from tests.fuzz.documents import document_cases
from tests.fuzz.grids import grid_cases
from tests.fuzz.labellings import label_cases
from tests.fuzz.polygons import polygon_cases
from tests.fuzz.scenes import scene_cases

SOURCES = (
    *(damaged, polygon_cases, count_cases, scene_cases, grid_cases, cloud_cases, label_cases),
    *(document_cases, checkpoint_cases),
)


@cache
def all_cases() -> tuple[Case, ...]:
    """Every case once."""
    return tuple(checked(case for source in SOURCES for case in source()))
