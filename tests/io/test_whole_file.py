"""A file is written whole or not at all, as any other new file."""

from __future__ import annotations

import os
import stat

import pytest

from moseg_core.errors import MosegError
from moseg_core.io.whole_file import write_file


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path, monkeypatch):
    path = tmp_path / "x.json"
    write_file(path, b"old")
    write_file(path, b"new")
    assert path.read_bytes() == b"new"

    def no_space(*args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("moseg_core.io.whole_file.Path.replace", no_space)
    with pytest.raises(MosegError, match=r"cannot write '.*': No space left on device"):
        write_file(path, b"newer")
    assert path.read_bytes() == b"new"
    assert os.listdir(tmp_path) == ["x.json"]


def test_a_file_has_the_permissions_of_any_new_file(tmp_path):
    before = os.umask(0o027)
    try:
        write_file(tmp_path / "x.json", b"")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "x.json").stat().st_mode) == 0o640
