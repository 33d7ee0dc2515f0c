"""What a process has one of, and a component has no business to change.

The working directory, the global generators of random numbers, the handlers of signals and the rest
of :data:`ITEMS` belong to the whole program. A component that changes one of them changes what
others compute, where files land, or whether Ctrl-C is heard. :func:`look` notes how things are,
:func:`changed` says in words what is no longer so, and :func:`restore` puts back what can be.

Three look: the first import of a bundle (:mod:`moseg_core.components.discovery.trial`), every call
of a component now and then (:mod:`moseg_core.components.side_effects`), and the contract kit
(:mod:`moseg_core.testing.checks.side_effects`). Imports nothing heavy: numpy is only looked at
where somebody has imported it.
"""

from __future__ import annotations

import gc
import locale
import os
import random
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Collection, Mapping
from typing import Any

State = dict[str, Any]
"""How each item was, by its name."""


def working_directory() -> str:
    """The working directory; empty where it is no more.

    Examples
    --------
    >>> working_directory() == os.getcwd()
    True
    """
    try:
        return os.getcwd()
    except OSError:
        return ""


def _numpy_random() -> Any:
    return sys.modules.get("numpy.random")


def _numpy_generator() -> tuple[Any, ...] | None:
    """The state of numpy's global generator, in what Python can compare."""
    module = _numpy_random()
    if module is None:
        return None
    name, key, *rest = module.get_state()
    return (name, key.tobytes(), *rest)


def _restore_numpy_generator(state: tuple[Any, ...] | None) -> None:
    module = _numpy_random()
    if module is not None and state is not None:
        name, key, *rest = state
        module.set_state((name, _words(key), *rest))


def _words(key: bytes) -> Any:
    import numpy as np

    return np.frombuffer(key, np.uint32)


def _handlers() -> dict[str, Any]:
    """The handler of each signal that a program may handle."""
    found = {}
    for number in signal.valid_signals():
        try:
            found[signal.Signals(number).name] = signal.getsignal(number)
        except ValueError:  # a real-time signal, which has no name
            continue
    return found


def _restore_handlers(handlers: Mapping[str, Any]) -> None:
    if threading.current_thread() is not threading.main_thread():
        return  # nobody may from here
    for name, handler in handlers.items():
        number = signal.Signals[name]
        if signal.getsignal(number) != handler and handler is not None:
            signal.signal(number, handler)


def _threads() -> frozenset[threading.Thread]:
    """Threads that are alive, but for moseg's own."""
    return frozenset(t for t in threading.enumerate() if not t.name.startswith("moseg-"))


def _environment() -> dict[str, str]:
    return dict(os.environ)


def _restore_environment(before: Mapping[str, str]) -> None:
    for name in set(os.environ) - set(before):
        del os.environ[name]
    os.environ.update(before)


def _restore_filters(before: tuple[Any, ...]) -> None:
    warnings.filters[:] = list(before)  # type: ignore[index]  # a list, whatever its stub says
    warnings._filters_mutated()  # type: ignore[attr-defined]  # what warnings does itself


def _numpy_errors() -> dict[str, str] | None:
    module = sys.modules.get("numpy")
    return None if module is None else dict(module.geterr())


def _restore_numpy_errors(before: Mapping[str, str] | None) -> None:
    module = sys.modules.get("numpy")
    if module is not None and before is not None:
        module.seterr(**before)


def _mask() -> int:
    """The mask of file modes; it can only be read by setting it."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask


def _streams() -> tuple[Any, ...]:
    return sys.stdin, sys.stdout, sys.stderr


def _restore_streams(before: tuple[Any, ...]) -> None:
    sys.stdin, sys.stdout, sys.stderr = before


def _restore_directory(before: str) -> None:
    if before and working_directory() != before:
        os.chdir(before)


ITEMS: dict[str, tuple[Callable[[], Any], Callable[[Any], object]]] = {
    "the working directory": (working_directory, _restore_directory),
    "the global generator of random": (random.getstate, random.setstate),
    "the global generator of numpy.random": (_numpy_generator, _restore_numpy_generator),
    "the handlers of signals": (_handlers, _restore_handlers),
    "the threads that run": (_threads, lambda before: None),
    "sys.stdin, sys.stdout and sys.stderr": (_streams, _restore_streams),
    "the mask of file modes": (_mask, os.umask),
    "the limit of recursion": (sys.getrecursionlimit, sys.setrecursionlimit),
    "the function that traces": (sys.gettrace, sys.settrace),
    "the environment": (_environment, _restore_environment),
    "the filters of warnings": (lambda: tuple(warnings.filters), _restore_filters),
    "numpy's handling of floating-point errors": (_numpy_errors, _restore_numpy_errors),
    "the locale": (
        lambda: locale.setlocale(locale.LC_ALL),
        lambda before: locale.setlocale(locale.LC_ALL, before),
    ),
    "whether garbage is collected": (
        gc.isenabled,
        lambda before: gc.enable() if before else gc.disable(),
    ),
}
"""How each thing is looked at, and put back."""

AT_IMPORT = frozenset(ITEMS) - {
    "the environment",
    "the filters of warnings",
    "numpy's handling of floating-point errors",
}
"""What importing a bundle must leave alone for it to be used: what its libraries do is excused."""

AT_WORK = (
    "the working directory",
    "the global generator of random",
    "the global generator of numpy.random",
    "the handlers of signals",
)
"""What is looked at in the middle of a search."""


def look(items: Collection[str] = tuple(ITEMS)) -> State:
    """How things are.

    Parameters
    ----------
    items : collection of str
        Of :data:`ITEMS`; all by default.
    """
    return {name: ITEMS[name][0]() for name in ITEMS if name in items}


def changed(before: State, *, draws: bool = False) -> dict[str, str]:
    """What is no longer as it was, each with more about it in words; empty where all is.

    What was not there before, numpy for one, has not changed.

    Parameters
    ----------
    before : dict
        As :func:`look` gave it.
    draws : bool
        Whether a global generator from which numbers were drawn has changed too. Some libraries
        draw when they are imported, which may be in the middle of a call; that somebody has seeded
        a generator is told anyway.

    Examples
    --------
    >>> before = look(["the limit of recursion"])
    >>> sys.setrecursionlimit(before["the limit of recursion"] + 1)
    >>> changed(before)
    {'the limit of recursion': ''}
    >>> restore(before)
    >>> changed(before)
    {}
    """
    found = {}
    for name, was in before.items():
        now = ITEMS[name][0]()
        if name in _GENERATORS and not draws and now != was and _GENERATORS[name](was, now):
            continue
        if was is None and name.startswith(("numpy", "the global generator of numpy")):
            continue
        if name == "the threads that run":
            if left := sorted(thread.name for thread in now - was):
                found[name] = f"left running: {', '.join(left)}"
        elif now != was:
            found[name] = _how(name, was, now)
    return found


def _drawn(was: Any, now: Any) -> bool:
    """Whether the generator of random comes from one state to the other by drawing some numbers."""
    ahead = random.Random()
    ahead.setstate(was)
    for _ in range(_TWISTS):
        if ahead.getstate()[1][:-1] == now[1][:-1]:
            return True
        ahead.getrandbits(32 * _WORDS)
    return False


def _drawn_from_numpy(was: Any, now: Any) -> bool:
    """The same of numpy's; both are Mersenne twisters."""
    if was is None or was[0] != now[0]:
        return was is None
    ahead = _numpy_random().RandomState()
    _, key, place, *rest = was
    ahead.set_state((was[0], _words(key), place, *rest))
    for _ in range(_TWISTS):
        if ahead.get_state()[1].tobytes() == now[1]:
            return True
        ahead.bytes(4 * _WORDS)
    return False


#: Words of a twister's state, which are made anew once they are used up, and how often that is
#: followed.
_WORDS, _TWISTS = 624, 100

_GENERATORS = {
    "the global generator of random": _drawn,
    "the global generator of numpy.random": _drawn_from_numpy,
}


def _how(name: str, was: Any, now: Any) -> str:
    """What is known of a change."""
    if name == "the working directory":
        return f"from {was} to {now or 'one that is gone'}"
    if isinstance(was, Mapping):
        keys = sorted(key for key in {*was, *now} if was.get(key) != now.get(key))
        return ", ".join(keys[:3])
    return ""


def restore(before: State) -> None:
    """Put back what can be; threads go on."""
    for name, was in before.items():
        ITEMS[name][1](was)


def told(changes: Mapping[str, str]) -> str:
    """Changes in words.

    Examples
    --------
    >>> told({"the working directory": "from /home to /", "the locale": ""})
    'the working directory (from /home to /) and the locale'
    """
    return " and ".join(f"{name} ({how})" if how else name for name, how in changes.items())
