"""The page as a format of results."""

from __future__ import annotations

import moseg_core as moseg
from moseg_core.samples import sample_labels_path, sample_path
from moseg_core.view.page.content import PageContent
from moseg_core.view.page.document import page_document
from moseg_core.view.page.html import page_html
from moseg_core.view.page.writer import write_html
from tests.results import result_on


def test_a_result_is_saved_as_its_page(box, tmp_path):
    result = result_on(box)
    moseg.save(result, tmp_path / "box.html")
    page = (tmp_path / "box.html").read_bytes()
    assert page == write_html(result)
    assert page == page_html(page_document(PageContent.of_result(result)))


def test_the_page_of_a_sample_is_small_enough_to_send():
    shape = moseg.load(sample_path("horse"))
    found = moseg.read_labels(sample_labels_path("horse"), shape)
    content = PageContent(shape=shape, labels=found.labels, names=found.names)
    assert len(page_html(page_document(content))) < 1_000_000
