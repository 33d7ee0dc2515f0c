"""A file is written whole or not at all, as any other new file."""

from __future__ import annotations

import errno
import os
import stat
import threading

import pytest

from moseg_core.errors import MosegError
from moseg_core.io.whole_file import (
    check_destination,
    identity,
    is_stream,
    same_file,
    write_file,
)


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


def test_the_name_may_be_as_long_as_the_system_takes(tmp_path):
    for letter in ("n", "ß", "語"):
        path = tmp_path / (letter * (255 // len(letter.encode())))
        check_destination(path)
        write_file(path, b"")
        assert path.exists()


def test_a_file_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    done = []
    fsync, replace = os.fsync, os.replace
    monkeypatch.setattr("os.fsync", lambda number: (done.append("sync"), fsync(number)))
    monkeypatch.setattr("os.replace", lambda *names: (done.append("rename"), replace(*names)))
    write_file(tmp_path / "x.json", b"data")
    assert done == ["sync", "rename", "sync"]


def test_a_disk_that_fails_is_told_and_one_that_cannot_wait_is_not(tmp_path, monkeypatch):
    def fail(number):
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr("os.fsync", fail)
    with pytest.raises(MosegError, match="Input/output error"):
        write_file(tmp_path / "x.json", b"data")
    assert os.listdir(tmp_path) == []

    def unable(number):
        raise OSError(errno.EINVAL, "Invalid argument")

    monkeypatch.setattr("os.fsync", unable)
    write_file(tmp_path / "x.json", b"data")
    assert os.listdir(tmp_path) == ["x.json"]


def test_links_are_followed_also_to_what_is_not_there_yet(tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "x.json").symlink_to("folder/real.json")
    for content in (b"new", b"newer"):
        check_destination(tmp_path / "x.json")
        write_file(tmp_path / "x.json", content)
        assert (tmp_path / "x.json").is_symlink()
        assert (tmp_path / "folder" / "real.json").read_bytes() == content


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may give files away")
def test_a_file_keeps_owner_and_mode(tmp_path):
    path = tmp_path / "x.json"
    path.write_bytes(b"")
    os.chown(path, 1234, 1235)
    path.chmod(0o640)
    write_file(path, b"new")
    status = path.stat()
    assert (status.st_uid, status.st_gid) == (1234, 1235)
    assert stat.S_IMODE(status.st_mode) == 0o640


def test_a_reader_that_goes_away_is_told(tmp_path):
    os.mkfifo(tmp_path / "pipe.json")
    reader = os.open(tmp_path / "pipe.json", os.O_RDONLY | os.O_NONBLOCK)
    check_destination(tmp_path / "pipe.json")
    assert is_stream(tmp_path / "pipe.json")
    threading.Timer(0.2, os.close, [reader]).start()
    with pytest.raises(MosegError, match="nobody reads it any longer"):
        write_file(tmp_path / "pipe.json", bytes(1_000_000))  # more than a pipe holds


def test_pipes_and_devices_are_not_the_same_file_twice(tmp_path):
    assert not same_file(os.devnull, os.devnull)
    assert same_file(tmp_path / "new.json", tmp_path / "folder" / ".." / "new.json")
    assert identity("nul\0") is None


def test_a_file_has_the_permissions_of_any_new_file(tmp_path):
    before = os.umask(0o027)
    try:
        write_file(tmp_path / "x.json", b"")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "x.json").stat().st_mode) == 0o640
