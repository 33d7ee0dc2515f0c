r"""Messages between a guarded child and the process that guards it, over two pipes.

A message is a JSON object behind its length in bytes. The child keeps the two pipes at descriptors
of its own and gives components nothing but ``/dev/null`` to read and write, so that what they print
does not come between.
"""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Mapping
from typing import Any

_LENGTH = struct.Struct(">I")
#: Bytes of a message; longer ones are noise.
_LONGEST = 64_000_000
_CHUNK = 1 << 16


def send(descriptor: int, message: Mapping[str, Any]) -> None:
    """Write a message whole.

    Raises
    ------
    OSError
        Nobody is at the other end.
    """
    text = json.dumps(message).encode()
    data = memoryview(_LENGTH.pack(len(text)) + text)
    while data:
        data = data[os.write(descriptor, data) :]


class Inbox:
    """Messages that arrive at a descriptor, in pieces of whatever length.

    Parameters
    ----------
    descriptor : int

    Examples
    --------
    >>> ours, theirs = os.pipe()
    >>> send(theirs, {"kind": "ok"})
    >>> Inbox(ours).receive()
    {'kind': 'ok'}
    >>> os.close(ours), os.close(theirs)
    (None, None)
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._bytes = bytearray()

    def pending(self) -> dict[str, Any] | None:
        """A message that is there in full; None for none.

        Raises
        ------
        ValueError
            What is there is no message.
        """
        if len(self._bytes) < _LENGTH.size:
            return None
        (length,) = _LENGTH.unpack_from(self._bytes)
        if length > _LONGEST:
            raise ValueError(f"a message of {length} bytes")
        end = _LENGTH.size + length
        if len(self._bytes) < end:
            return None
        text = bytes(self._bytes[_LENGTH.size : end])
        del self._bytes[:end]
        message = json.loads(text)
        if not isinstance(message, dict):
            raise ValueError("a message that is no object")
        return message

    def fetch(self) -> bool:
        """Wait for more bytes; False where the other end is closed."""
        chunk = os.read(self._descriptor, _CHUNK)
        self._bytes += chunk
        return bool(chunk)

    def receive(self) -> dict[str, Any] | None:
        """Wait for the next message; None where the other end is closed.

        Raises
        ------
        ValueError
            What arrives is no message.
        """
        while True:
            message = self.pending()
            if message is not None:
                return message
            if not self.fetch():
                return None
