"""The page of all checks is what the code says."""

from __future__ import annotations

from moseg_core.testing import CHECKS
from tools.make_check_docs import PAGE, broken_components, page


def test_the_page_is_up_to_date():
    assert PAGE.read_text() == page(), "run: python tools/make_check_docs.py"


def test_every_check_is_on_it_once_with_what_fails_it():
    text = page()
    broken = broken_components()
    assert set(broken) == set(CHECKS)
    for id, check in CHECKS.items():
        (row,) = [line for line in text.splitlines() if line.startswith(f"| `{id}` |")]
        assert f"| {check.why} | {check.since} |" in row
        assert f"`{broken[id].target.partition(':')[2]}`" in row
