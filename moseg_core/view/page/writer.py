"""The page of a result as a format that results are saved in."""

from __future__ import annotations

from moseg_core.search.result import Result
from moseg_core.view.page.content import PageContent
from moseg_core.view.page.document import page_document
from moseg_core.view.page.html import page_html


def write_html(result: Result) -> bytes:
    """One file to turn the shape in, with parts, areas and costs; opens without a network."""
    return page_html(page_document(PageContent.of_result(result)))
