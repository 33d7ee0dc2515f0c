"""Files that are files: nothing that never ends is read, nothing that never begins waited for."""

from __future__ import annotations

import os
import socket

import pytest

from moseg_core.untrusted.regular_file import read_regular_file, refuse_irregular


@pytest.fixture
def pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    return tmp_path / "pipe"


def test_a_pipe_is_refused_without_waiting_for_a_writer(pipe):
    for look in (read_regular_file, refuse_irregular):
        with pytest.raises(OSError, match="it is a pipe, not a file"):
            look(pipe)


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null"])
def test_a_device_is_refused(path):
    with pytest.raises(OSError, match="it is a device, not a file"):
        read_regular_file(path)


def test_a_folder_and_a_socket_are_refused(tmp_path, monkeypatch):
    with pytest.raises(OSError, match="it is a folder, not a file"):
        read_regular_file(tmp_path)
    monkeypatch.chdir(tmp_path)  # a socket's name is short
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind("s")
        with pytest.raises(OSError, match=r"No such device|it is a socket"):
            read_regular_file("s")
        with pytest.raises(OSError, match="it is a socket"):
            refuse_irregular("s")


def test_links_to_files_are_followed_and_those_to_devices_refused(tmp_path):
    (tmp_path / "file").write_bytes(b"abc")
    (tmp_path / "link").symlink_to("file")
    (tmp_path / "bad").symlink_to("/dev/zero")
    (tmp_path / "circle").symlink_to("circle")
    assert read_regular_file(tmp_path / "link") == b"abc"
    for name in ("bad", "circle"):
        with pytest.raises(OSError):  # noqa: PT011  # what the system says differs
            read_regular_file(tmp_path / name)


def test_no_more_is_read_than_is_allowed(tmp_path):
    file = tmp_path / "sparse"
    with file.open("wb") as stream:
        stream.truncate(2**40)
    with pytest.raises(OSError, match="it is larger than 3 MB"):
        read_regular_file(file, most=3 * 2**20)
    (tmp_path / "three").write_bytes(b"abc")
    assert read_regular_file(tmp_path / "three", most=3) == b"abc"
    with pytest.raises(OSError, match="it is larger than 2 bytes"):
        read_regular_file(tmp_path / "three", most=2)


@pytest.mark.parametrize("name", ["a\0b", "x" * 300, "no/such"])
def test_what_is_wrong_with_a_name_is_an_error_of_the_system(name, tmp_path):
    with pytest.raises(OSError) as caught:  # noqa: PT011  # what the system says differs
        read_regular_file(tmp_path / name)
    assert caught.value.strerror
