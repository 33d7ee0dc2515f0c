"""What a guarded child does: one job after the other, until its guard is gone.

Started as ``python -m moseg_core.batching.child`` by :mod:`moseg_core.batching.guard`, in a
session of its own. It begins by saying what it is made of, since other versions find other parts.
It never outlives its guard: the kernel ends it (``PR_SET_PDEATHSIG``), and where the kernel cannot,
a thread watches. When memory runs out in the whole machine, it is the first to go.

Between jobs it undoes what components may have left behind and what the next shape would notice:
the working directory and the state of the global random generators. Whatever else they do is their
guard's business.
"""

from __future__ import annotations

import ctypes
import faulthandler
import gc
import mmap
import os
import random
import resource
import signal
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

from moseg_core.batching.wire import Inbox, send

_PR_SET_PDEATHSIG = 1
#: Seconds between two looks for the guard, where the kernel does not do that.
_WATCH = 0.5


def main(arguments: list[str]) -> None:
    """Serve the guard.

    Parameters
    ----------
    arguments : list of str
        Numbers of the descriptors for requests, answers, the name of what is at work, and the
        report of a crash; and of the guard's process.
    """
    requests, answers, notes, crashes, guard = map(int, arguments)
    _die_with(guard)
    _be_first_to_go()
    silence = os.open(os.devnull, os.O_RDWR)
    for standard in (0, 1, 2):
        os.dup2(silence, standard)
    for descriptor in (requests, answers, notes, crashes):
        os.set_inheritable(descriptor, False)  # what components start has no part in this
    faulthandler.enable(file=crashes, all_threads=False)

    gc.disable()  # nothing of what is imported goes away again
    from moseg_core.batching.compilation import telling_of_compiling
    from moseg_core.batching.solving import do_job
    from moseg_core.batching.versions import own_versions
    from moseg_core.components.at_work import SIZE, note_in

    memory = (ctypes.c_char * SIZE).from_buffer(mmap.mmap(notes, SIZE))
    note_in(memory)
    send(answers, {"kind": "hello", "versions": own_versions()})
    gc.freeze()
    gc.enable()
    inbox = Inbox(requests)
    with telling_of_compiling(partial(_tell, answers)):
        while (request := inbox.receive()) is not None:
            send(answers, _answer(do_job if request["task"] == "solve" else _describe, request))
            note_in(memory)  # nothing is at work, whatever was left


def _answer(do: Callable[..., dict[str, Any]], request: dict[str, Any]) -> dict[str, Any]:
    """Do a job as if it were the first; whatever is raised is an answer too."""
    from moseg_core.components.faults import describe

    began = time.monotonic()
    try:
        os.chdir(request["here"])
        _seed(request["seed"])
        answer = do(request["shape"], request["outputs"], request["instructions"])
    except OSError as error:  # the folder is not there
        answer = {"kind": "failed", "message": f"'{request['here']}': {error.strerror or error}"}
    except BaseException as error:  # noqa: BLE001  # a component may raise what it likes
        answer = {"kind": "plugin error", "message": f"a component raised {describe(error)}"}
    return {**answer, "seconds": round(time.monotonic() - began, 3)}


def _describe(*given: Any) -> dict[str, Any]:
    """Draw and measure a result; few batches ask for that, and it needs more modules."""
    from moseg_core.batching.report.describing import describe_result

    return describe_result(*given)


def _tell(answers: int, begins: bool) -> None:
    send(answers, {"kind": "compiling" if begins else "compiled"})


def _seed(seed: int) -> None:
    """Bring the global random generators, which moseg does not use, to a known state."""
    import numpy as np

    random.seed(seed)
    np.random.seed(seed % 2**32)  # noqa: NPY002  # it is the global one that components may use


def _die_with(guard: int) -> None:
    """End when the guard ends, however that does."""
    try:
        set_up = ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(signal.SIGKILL), 0, 0, 0) == 0
    except (OSError, AttributeError):
        set_up = False
    if os.getppid() != guard:  # it has ended meanwhile
        os._exit(1)
    if not set_up:
        threading.Thread(target=_watch, args=(guard,), daemon=True).start()


def _watch(guard: int) -> None:
    while os.getppid() == guard:
        time.sleep(_WATCH)
    os.kill(os.getpid(), signal.SIGKILL)


def _be_first_to_go() -> None:
    """Ask the kernel to end this process, and no other, when the machine's memory runs out.

    Nor is what it had in memory written to the user's folder when it crashes.
    """
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        with open("/proc/self/oom_score_adj", "w", encoding="ascii") as file:
            file.write("1000")
    except OSError:  # another system, or not allowed
        return


if __name__ == "__main__":
    main(sys.argv[1:])
