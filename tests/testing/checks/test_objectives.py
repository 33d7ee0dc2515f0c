"""Each check of objectives fails for the one that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import ObjectiveSpec
from tests.testing.broken.objectives import BROKEN
from tests.testing.outcomes import assert_fails_only, failures, outcomes


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("answers_in_words", {"objective-in-range"}),
        ("counts_triangles", {"objective-requires-what-it-reads"}),
        ("counts_pieces", {"objective-requires-what-it-reads"}),
        ("counts_triangles_or_points", set()),
        ("follows_its_boundary", {"objective-returns", "objective-requires-what-it-reads"}),
        ("follows_all_boundaries", {"objective-returns", "objective-requires-what-it-reads"}),
        ("asks_what_was_not_said", {"objective-fields-exist"}),
        ("reads_by_another_way", {"objective-declares-its-fields"}),
        ("names_a_field_alone", {"objective-is-the-mean-it-says"}),
        ("is_a_mean_of_nothing", {"objective-is-the-mean-it-says"}),
        ("scales_what_was_not_said", {"objective-is-the-mean-it-says"}),
    ],
)
def test_what_an_objective_may_read(name, expected):
    spec = ObjectiveSpec(name="own", target=f"tests.testing.broken.objectives:{name}")
    assert set(failures(spec)) == expected


@pytest.mark.parametrize(
    "name",
    [
        *("share", "near", "four", "sized", "level", "steep", "raised", "ragged", "at_edges"),
        "of_single_precision",
    ],
)
def test_unusual_objectives_pass(name):
    found = outcomes(ObjectiveSpec(name="odd", target=f"tests.testing.odd:{name}"))
    assert [outcome for outcome in found if outcome.status == "failed"] == []
    assert sum(outcome.status == "passed" for outcome in found) > 10


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("answers_in_words", "(a str), expected a real number"),
        ("divides_by_the_height", 'objectives.py:42: "return float(part.scales[0]) / '),
        ("leaves", "the error SystemExit: 0 (tests/testing/broken/objectives.py:"),
    ],
)
def test_what_is_said_of_values_and_errors(name, said):
    spec = ObjectiveSpec(name="own", target=f"tests.testing.broken.objectives:{name}")
    assert any(said in message for message in failures(spec).values())
