"""A result shown: its page in a notebook, and in the browser."""

from __future__ import annotations

import html
import re
from pathlib import Path

import pytest

from moseg_core.errors import MosegError
from moseg_core.search.showing import open_page
from moseg_core.view.page.writer import write_html
from tests.results import result_on


@pytest.fixture
def opened(monkeypatch, tmp_path):
    """The addresses that the browser was told; temporary files are in a folder of the test."""
    addresses = []
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("webbrowser.open", lambda address: addresses.append(address) or True)
    return addresses


def test_a_notebook_shows_the_page_in_a_frame_of_its_own(box):
    result = result_on(box)
    shown = result._repr_html_()
    assert re.match(r'<iframe srcdoc="[^"]*" sandbox="allow-scripts" ', shown)
    held = html.unescape(re.search(r'srcdoc="([^"]*)"', shown).group(1))
    assert held.encode() == write_html(result)


def test_show_opens_the_page(box, opened, tmp_path):
    result = result_on(box)
    path = result.show()
    assert path.parent == tmp_path
    assert path.read_bytes() == write_html(result)
    assert opened == [path.as_uri()]


def test_pages_that_are_shown_one_after_the_other_are_all_there(opened):
    (one, _), (other, _) = open_page(b"one"), open_page(b"other")
    assert (one.read_bytes(), other.read_bytes()) == (b"one", b"other")


def test_it_is_said_where_nothing_opened(opened, monkeypatch):
    assert open_page(b"page", browser=False)[1] is False
    assert opened == []
    monkeypatch.setattr("webbrowser.open", lambda address: False)
    assert open_page(b"page")[1] is False


def test_no_place_for_the_file_is_an_error_of_one_line(monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "gone"))
    with pytest.raises(MosegError, match="cannot write the page"):
        open_page(b"page")


def test_the_result_imports_no_pictures():
    source = Path(__file__).parents[2] / "moseg_core" / "search"
    for module in ("result.py", "showing.py"):
        assert "moseg_core.view" not in (source / module).read_text()
