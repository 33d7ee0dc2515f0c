"""A distribution that is in order, for the tests of discovery."""

from __future__ import annotations

import pytest

GOOD = """
    from moseg_core import MeasureSpec, ObjectiveSpec, hookimpl

    @hookimpl
    def moseg_objectives():
        return [
            ObjectiveSpec(name="slim", target="good_parts:slim", summary="long and thin"),
            ObjectiveSpec(name="wide", target="good_parts:wide"),
        ]

    @hookimpl
    def moseg_measures():
        return [MeasureSpec(name="girth", target="good_parts:girth", keep=False)]
"""


@pytest.fixture
def good(site):
    """A site with one distribution that is in order."""
    site.add("Good-Parts", "1.2.3", bundles={"good": "good_bundle"}, good_bundle=GOOD)
    return site
