"""Messages arrive whole, however they are cut up, and noise is told from them."""

from __future__ import annotations

import os

import pytest

from moseg_core.batching.wire import Inbox, send


@pytest.fixture
def pipe():
    ours, theirs = os.pipe()
    yield ours, theirs
    for descriptor in (ours, theirs):
        try:
            os.close(descriptor)
        except OSError:
            continue


def test_messages_arrive_in_order(pipe):
    ours, theirs = pipe
    for number in range(3):
        send(theirs, {"number": number, "text": "ä\udcff"})
    inbox = Inbox(ours)
    assert [inbox.receive()["number"] for _ in range(3)] == [0, 1, 2]
    os.close(theirs)
    assert inbox.receive() is None


def test_a_message_in_pieces_is_whole_in_the_end(pipe):
    ours, theirs = pipe
    send(theirs, {"text": "x" * 1000})
    data = os.read(ours, 10_000)
    inbox = Inbox(ours)
    for byte in data[:-1]:
        os.write(theirs, bytes([byte]))
        assert inbox.fetch()
        assert inbox.pending() is None
    os.write(theirs, data[-1:])
    assert inbox.receive() == {"text": "x" * 1000}


@pytest.mark.parametrize("noise", [b"noise noise noise", b"\0\0\0\x02[]", b"\0\0\0\x02{{"])
def test_noise_is_no_message(pipe, noise):
    ours, theirs = pipe
    os.write(theirs, noise)
    with pytest.raises(ValueError, match=r"."):
        Inbox(ours).receive()
