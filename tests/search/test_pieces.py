"""Small loose pieces: left out where that is asked for, else only spoken of."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.files import save
from moseg_core.io.result_json import read_result
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.search.levels import segment_hierarchy
from moseg_core.search.number_of_parts import segment_parts
from moseg_core.search.pieces import (
    on_large_pieces,
    searched_part,
    small_pieces_warning,
    without_small_pieces,
)
from moseg_core.search.segment import segment
from moseg_core.search.variants import segment_variants
from moseg_core.shape.shape import Shape
from tests import shapes

TEE = shapes.jitter(shapes.tee(), 5)
WHOLE = Shape.from_mesh(*TEE, name="tee")
N = WHOLE.n_elements
PROBLEM = Problem(["stem", "bar"], "3*narrow(stem) + perpendicular(stem, bar) + convex_parts")
QUICK = "pattern_search(threshold=0.02)"


def speck(x, y, z, size=0.02):
    return np.array([[x, y, z], [x + size, y, z], [x, y + size, z]]), [(0, 1, 2)]


#: Two specks near the ends of the tee; then the tee, so that elements change their numbers.
FIRST = shapes.joined(speck(-2, 0, 0), speck(2.5, 9, 0), TEE)
SPECKED = Shape.from_mesh(*FIRST, name="specked")


def run(shape=SPECKED, **options):
    return segment(shape, PROBLEM, optimizer=QUICK, restarts=1, **options)


def test_the_rest_is_searched_as_if_they_were_not_there():
    found, clean = run(ignore_pieces_below=0.001), run(WHOLE)
    assert found.shape is SPECKED
    assert found.labels[2:].tolist() == clean.labels.tolist()
    assert found.evaluation == clean.evaluation
    for k in (0, 1):
        near = 2 + ((WHOLE.points - SPECKED.points[k]) ** 2).sum(axis=1).argmin()
        assert found.labels[k] == found.labels[near]
    assert found.warnings[-1] == (
        "2 loose pieces were left out of the search and of the cost, with less than 0.1 % of the"
        " area each, and are labelled like the nearest part"
    )
    assert clean.warnings == ()


def test_the_method_says_so_and_can_be_given_again(tmp_path):
    found = run(ignore_pieces_below="0.1%")
    again = segment(SPECKED, PROBLEM, **found.method)
    assert again.labels.tolist() == found.labels.tolist()
    assert again.method == found.method
    save(found, tmp_path / "found.json")
    assert read_result(tmp_path / "found.json").search().ignore_pieces_below == 0.001


def test_unasked_there_is_only_a_word():
    assert small_pieces_warning(SPECKED) == [
        "2 loose pieces have less than 0.1 % of the area each, and may take a part for themselves;"
        " --ignore-pieces-below 0.1% leaves them out of the search"
    ]
    easier = Problem(["stem", "bar"], "3*narrow(stem)")
    found = segment(SPECKED, easier, optimizer=QUICK, restarts=1)
    assert [w for w in found.warnings if "loose" in w] == small_pieces_warning(SPECKED)
    assert small_pieces_warning(WHOLE) == []


@pytest.mark.parametrize("mesh", [shapes.soup(3, 2000), shapes.two_boxes()], ids=["soup", "two"])
def test_where_all_pieces_are_small_or_none_nothing_is_said(mesh):
    assert small_pieces_warning(Shape.from_mesh(*mesh)) == []


def test_points_that_nobody_joined_have_no_pieces():
    cloud = Shape.from_points(WHOLE.points)
    assert small_pieces_warning(cloud) == []
    with pytest.raises(ShapeError, match="not known which of its points touch; say so with --adj"):
        without_small_pieces(cloud, 0.001)


def test_something_must_be_left():
    two = Shape.from_mesh(*shapes.two_boxes(), name="two")
    with pytest.raises(
        ShapeError, match="no piece of 'two' has 60 % of the area; the largest of 2"
    ):
        without_small_pieces(two, 0.6)
    assert without_small_pieces(two, 0.3) is None


def test_they_are_found_once_for_a_shape():
    kept = without_small_pieces(SPECKED, 0.001)
    assert kept is without_small_pieces(SPECKED, 0.001)
    assert kept.elements.tolist() == list(range(2, N + 2))
    assert kept.count == 2
    assert searched_part(SPECKED, SearchOptions(ignore_pieces_below="0.1%")) is kept.shape
    assert searched_part(SPECKED, SearchOptions()) is SPECKED
    assert searched_part(WHOLE, SearchOptions(ignore_pieces_below="0.1%")) is WHOLE


def test_pinned_elements_go_by_their_own_numbers():
    clean = run(WHOLE)
    element = int(np.flatnonzero(clean.labels == 0)[0])
    found = run(ignore_pieces_below=0.001, pins={"bar": [element + 2], "stem": [0]})
    assert PROBLEM.labels[found.labels[element + 2]] == "bar"
    assert PROBLEM.labels[found.labels[0]] == "stem"
    with pytest.raises(UsageError, match=f"there is no element {N + 2}"):
        run(ignore_pieces_below=0.001, pins={"bar": [N + 2]})


def test_every_door_leaves_them_out():
    options = {"optimizer": QUICK, "restarts": 1, "ignore_pieces_below": 0.001}
    levels = segment_hierarchy(
        SPECKED,
        Hierarchy(PROBLEM, {"bar": Problem(["l", "r"], "narrow(l) + convex_parts")}),
        **options,
    )
    counted = Statement(
        labels=("stem", "bar{1..2}"), minimize="is(stem, area=0.6+-0.1) + is(bar*, area=0.4+-0.1)"
    )
    variants = segment_variants(SPECKED, counted, **options)
    parts = segment_parts(SPECKED, 2, **options)
    for found in (levels, variants, parts):
        assert found.shape is SPECKED
        assert len(found.labels) == N + 2
        assert sum("2 loose pieces were left out" in warning for warning in found.warnings) == 1
    assert list(levels.parts) == ["stem", "bar/l", "bar/r"]
    assert parts.parts["part1"].area >= parts.parts["part2"].area


def test_where_the_search_fails_they_are_back_in_what_it_had_found():
    def search(shape, options, pins):
        assert options.ignore_pieces_below == 0
        error = UsageError("no more")
        error.result = segment(shape, PROBLEM, optimizer="pattern_search(max_evaluations=1)")
        raise error

    with pytest.raises(UsageError, match="no more") as caught:
        on_large_pieces(SPECKED, SearchOptions(ignore_pieces_below=0.001), search)
    assert caught.value.result.shape is SPECKED


@pytest.mark.parametrize("share", ["-1%", 1.0, "many", True, None, float("nan")])
def test_a_share_that_makes_no_sense_is_refused(share):
    with pytest.raises(
        UsageError, match=r"must be from 0 to 1, or a percentage such as 0\.1%, not"
    ):
        SearchOptions(ignore_pieces_below=share)
