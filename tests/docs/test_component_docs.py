"""The page of all components is what the code says today."""

from __future__ import annotations

from tools.make_component_docs import PAGE, page


def test_the_page_is_up_to_date():
    assert PAGE.read_text() == page(), "run: python tools/make_component_docs.py"
