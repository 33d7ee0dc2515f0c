"""Limits on what a file may become: read from words, each refusal naming itself."""

from __future__ import annotations

import math
from dataclasses import astuple
from pathlib import Path

import pytest

from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.read.limits import FEW_CELLS, FEW_TRIANGLES, LIMITS, ReadLimits

FILE = Path("a.glb")


def test_none_lifts_one_or_all_and_the_last_word_counts():
    assert ReadLimits.read([]) == LIMITS
    assert ReadLimits.read(["cells=5", "cells = 7"]).cells == 7
    assert ReadLimits.read(["cells=none"]).cells == math.inf
    assert set(astuple(ReadLimits.read(["cells=7", "none"]))) == {math.inf}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("cell=7", "unknown limit 'cell'; did you mean 'cells'?"),
        ("cells", "a limit is a number above 0 or 'none', such as cells=10000000, not 'cells'"),
        ("cells=0", "not 'cells=0'"),
        ("cells=nan", "not 'cells=nan'"),
        ("columns=many", "such as columns=1000, not 'columns=many'"),
    ],
)
def test_words_that_are_no_limit(text, says):
    with pytest.raises(UsageError) as caught:
        ReadLimits.read([text])
    assert says in str(caught.value)


def test_what_is_few_is_read_from_the_shortest_file():
    LIMITS.refuse_triangles(FILE, FEW_TRIANGLES, 1)
    LIMITS.refuse_cells(FILE, occupied=FEW_CELLS, grid=FEW_CELLS, size=1)
    with pytest.raises(ShapeError, match=r"^a\.glb .* --limit triangles_per_byte=\.\.\. raises it"):
        LIMITS.refuse_triangles(FILE, FEW_TRIANGLES + 1, 1)
    with pytest.raises(ShapeError, match="1,000,001 occupied cells in 1 bytes"):
        LIMITS.refuse_cells(FILE, occupied=FEW_CELLS + 1, grid=0, size=1)


def test_each_limit_of_a_grid_is_named():
    limits = ReadLimits(cells=10, grid_cells=20)
    with pytest.raises(ShapeError, match=r"holds 11 occupied cells; resample .* cells=10"):
        limits.refuse_cells(FILE, occupied=11, grid=20, size=1)
    with pytest.raises(ShapeError, match="a grid of 21 cells; the limit is grid_cells=20"):
        limits.refuse_cells(FILE, occupied=1, grid=21, size=1)
    with pytest.raises(ShapeError, match="rows of 1,001 cells"):
        limits.refuse_columns(FILE, 1001)
