"""Components at work in other processes, for what only shows there.

The order of sets and the hashes of texts differ from process to process, by ``PYTHONHASHSEED``; a
result that hangs on them can be neither repeated nor resumed. :func:`drive_elsewhere` runs a
component in a child process with a hash seed of its own. Starting one takes seconds, so that each
child goes on to serve all components of a run; one that dies is started anew.

Requests and answers are pickles over pipes, to and from our own children only. What a component
prints there goes nowhere.
"""

from __future__ import annotations

import atexit
import json
import os
import pickle
import queue
import subprocess
import sys
import threading
from contextlib import suppress
from typing import Any, BinaryIO

from moseg_core.components.discovery.registry import Component, Registry, describe
from moseg_core.testing.check import Subject

_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]);"
    " from moseg_core.testing.processes.other_hash_seed import serve; serve()"
)
_CHILDREN: dict[int, subprocess.Popen[bytes]] = {}
_LOCK = threading.Lock()


class ChildError(RuntimeError):
    """The component could not be run in the child; says why."""


def drive_elsewhere(subject: Subject, *, hash_seed: int) -> dict[str, Any]:
    """What came of a component in a process with a certain hash seed.

    Parameters
    ----------
    subject : Subject
        Its module has to be importable there, on the same ``sys.path``.
    hash_seed : int

    Returns
    -------
    dict of str to value
        As of :func:`moseg_core.testing.fixtures.drivers.drive`; objects that are not plain are
        represented by their type's name.

    Raises
    ------
    ChildError
        The component cannot be run there, or the process ended.
    """
    request = pickle.dumps((subject.component, subject.registry))
    with _LOCK:
        if hash_seed not in _CHILDREN:
            _CHILDREN[hash_seed] = _start(hash_seed)
        child = _CHILDREN[hash_seed]
        assert child.stdin is not None
        assert child.stdout is not None  # pipes, as asked for
        try:
            _send(child.stdin, request)
            answer = _receive(child.stdout)
        except OSError:
            answer = b""
        if not answer:
            _end(_CHILDREN.pop(hash_seed))
            raise ChildError("the process ended")
    found, failure = pickle.loads(answer)
    if failure:
        raise ChildError(failure)
    result: dict[str, Any] = found
    return result


def _start(hash_seed: int) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-c", _START, json.dumps([path or os.getcwd() for path in sys.path])],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONHASHSEED": str(hash_seed)},
    )


@atexit.register
def _end_all() -> None:
    while _CHILDREN:
        _end(_CHILDREN.popitem()[1])


def _end(child: subprocess.Popen[bytes]) -> None:
    child.kill()
    child.wait()
    for pipe in (child.stdin, child.stdout):
        if pipe is not None:
            with suppress(OSError):  # what was not sent any more
                pipe.close()


def _send(pipe: BinaryIO | Any, message: bytes) -> None:
    pipe.write(len(message).to_bytes(8, "little") + message)
    pipe.flush()


def _receive(pipe: BinaryIO | Any) -> bytes:
    """The next message; empty at the end."""
    size = int.from_bytes(pipe.read(8), "little")
    message: bytes = pipe.read(size)
    return message if len(message) == size else b""


def serve() -> None:
    """Answer requests until there are no more: what the child does."""
    answers = os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    requests: queue.Queue[bytes] = queue.Queue()

    def listen() -> None:
        # The parent is gone when its pipe is closed; a component that never returns would
        # otherwise live on.
        while message := _receive(sys.stdin.buffer):
            requests.put(message)
        os._exit(0)

    threading.Thread(target=listen, daemon=True).start()
    while True:
        component, registry = pickle.loads(requests.get())
        _send(answers, _answer(component, registry))


def _answer(component: Component, registry: Registry) -> bytes:
    from moseg_core.testing.fixtures.drivers import drive

    try:
        found = drive(Subject(component=component, registry=registry))
        return pickle.dumps((found, ""))
    except (Exception, SystemExit) as error:  # noqa: BLE001  # a stranger's component
        return pickle.dumps(({}, describe(error)))
