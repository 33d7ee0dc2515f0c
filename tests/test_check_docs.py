"""The page of all checks is what the code says."""

from __future__ import annotations

from moseg_core.testing import CHECKS
from tools.make_check_docs import KINDS, PAGE, page


def test_the_page_is_up_to_date():
    assert PAGE.read_text() == page(), "run: python tools/make_check_docs.py"


def test_every_check_is_on_it_once():
    text = page()
    for id, check in CHECKS.items():
        assert text.count(f"| `{id}` |") == 1
        assert check.why in text
    assert {kind for check in CHECKS.values() for kind in check.kinds} <= set(KINDS)
