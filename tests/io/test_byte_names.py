"""Names of files that are no UTF-8."""

from __future__ import annotations

import os

import pytest

from moseg_core.io.byte_names import path_entries, readable, with_path


@pytest.mark.parametrize("raw", [b"horse.off", "größe".encode(), b"M\xf6bel.off", b"\xff\xfe/\x80"])
def test_a_path_comes_back_from_any_text(raw):
    entries = path_entries(os.fsdecode(raw))
    assert all(value.encode() for value in entries.values())
    assert os.fsencode(with_path(entries)["file"]) == raw
    assert ("file_bytes" in entries) == (raw in (b"M\xf6bel.off", b"\xff\xfe/\x80"))


def test_what_stands_for_no_byte_is_shown_all_the_same():
    assert readable("\ud800") == "\\ud800"
    assert path_entries("\ud800") == {"file": "\\ud800"}


@pytest.mark.parametrize("wrong", ["no hexadecimal", 3, None])
def test_bytes_that_are_none_are_refused(wrong):
    with pytest.raises((ValueError, TypeError)):
        with_path({"file": "x", "file_bytes": wrong})
