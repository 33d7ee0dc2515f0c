"""Components at work in processes with other hash seeds, for what only shows there.

The order of sets and the hashes of texts differ from process to process, by ``PYTHONHASHSEED``; a
result that hangs on them can be neither repeated nor resumed. :func:`drive_elsewhere` runs a
component in a child process with a hash seed of its own. Starting one takes seconds, so that each
child goes on to serve all components of a run; a child that dies is started anew.

Requests and answers are pickles through a pipe, to and from our own children only. What a component
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
from multiprocessing.connection import Connection, Pipe

from moseg_core.components.faults import FAULTS, describe
from moseg_core.testing.check import Subject
from moseg_core.testing.fixtures.comparison import Answers

_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]);"
    " from moseg_core.testing.processes.other_hash_seed import serve; serve(int(sys.argv[2]))"
)
_CHILDREN: dict[int, _Child] = {}
_LOCK = threading.Lock()


class ChildError(RuntimeError):
    """The component could not be run in the child; says why."""


def drive_elsewhere(subject: Subject, *, hash_seed: int) -> Answers:
    """What came of a component in a process with a certain hash seed.

    Parameters
    ----------
    subject : Subject
        Its module has to be importable there, on the same ``sys.path``.
    hash_seed : int

    Returns
    -------
    dict of str to value
        As of :func:`moseg_core.testing.fixtures.drivers.drive`.

    Raises
    ------
    ChildError
        The component cannot be run there, or the process ended.
    """
    with _LOCK:
        if hash_seed not in _CHILDREN:
            _CHILDREN[hash_seed] = _Child(hash_seed)
        pipe = _CHILDREN[hash_seed].pipe
        try:
            pipe.send((subject.component, subject.registry))
            answers, failure = pipe.recv()
        except (OSError, EOFError) as error:
            _CHILDREN.pop(hash_seed).end()
            raise ChildError("the process ended") from error
    if failure:
        raise ChildError(failure)
    found: Answers = answers
    return found


class _Child:
    """A process with a hash seed, and our end of the pipe to it."""

    def __init__(self, hash_seed: int) -> None:
        self.pipe, theirs = Pipe()
        path = json.dumps([path or os.getcwd() for path in sys.path])
        self._process = subprocess.Popen(
            [sys.executable, "-c", _START, path, str(theirs.fileno())],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=(theirs.fileno(),),
            env={**os.environ, "PYTHONHASHSEED": str(hash_seed)},
        )
        theirs.close()

    def end(self) -> None:
        """Whatever it is doing."""
        self._process.kill()
        self._process.wait()
        self.pipe.close()


@atexit.register
def _end_all() -> None:
    while _CHILDREN:
        _CHILDREN.popitem()[1].end()


def serve(descriptor: int) -> None:
    """Answer requests from a pipe until there are no more: what the child does."""
    pipe = Connection(descriptor)
    requests: queue.Queue[bytes] = queue.Queue()

    def listen() -> None:
        # The parent is gone when its end is closed; a component that never returns would otherwise
        # live on.
        try:
            while True:
                requests.put(pipe.recv_bytes())
        except (OSError, EOFError):
            os._exit(0)

    threading.Thread(target=listen, daemon=True).start()
    while True:
        pipe.send(_answer(requests.get()))


def _answer(request: bytes) -> tuple[Answers, str]:
    from moseg_core.testing.fixtures.drivers import drive

    try:
        component, registry = pickle.loads(request)
        return drive(Subject(component=component, registry=registry)), ""
    except FAULTS as error:
        return {}, describe(error)
