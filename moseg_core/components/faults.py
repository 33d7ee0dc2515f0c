"""What a component may raise, and how that is told: in one line, with the author's own line.

Components are strangers' code. Whoever calls one catches :data:`FAULTS`, says which component it
was, and raises a :class:`~moseg_core.errors.PluginError` from what was caught, as
:func:`guarded` does. The line that the
user then reads ends with :func:`describe`: kind, message, and the innermost line of the author's
own package, which is where the author begins to look. Deeper frames are of the libraries that the
line called, and frames above it are of the core.

Whatever computes something is also noted as at work (:mod:`~moseg_core.components.at_work`) and
timed (:mod:`~moseg_core.components.profile`); terms, which are many, have words of their own.
"""

from __future__ import annotations

import linecache
import opcode
import os
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from moseg_core.components.at_work import at_work
from moseg_core.components.process_state import working_directory
from moseg_core.components.profile import timed
from moseg_core.components.side_effects import without_side_effects
from moseg_core.errors import REPORT, MosegError, PluginError

FAULTS: tuple[type[BaseException], ...] = (Exception, SystemExit)
"""What a check is guarded against: ``sys.exit()`` too, but not Ctrl-C.

In a search more is a component's fault; see :func:`is_fault`.
"""

BYSTANDERS = {"moseg_core", "pluggy", "numpy", "scipy", "numba"} | set(sys.stdlib_module_names)
"""Packages whose frames are nobody's fault: the core, Python, and what the core stands on."""

#: The instruction of a ``raise`` statement.
_RAISE = opcode.opmap["RAISE_VARARGS"]

#: Characters of a source line that are shown.
_LONGEST = 80


@contextmanager
def guarded(
    who: str,
    how: str = "failed",
    *,
    name: str,
    source: str,
    passes: tuple[type[BaseException], ...] = (MosegError,),
) -> Iterator[None]:
    """A context for the call of a component, whose faults become errors that name it.

    Parameters
    ----------
    who : str
        The component and where it comes from, for messages.
    how : str
        What it did, ``"cannot be made"``.
    name, source : str
        What it is called in a profile, and the distribution that it comes from.
    passes : tuple of types
        Errors that say already what is wrong, such as moseg's own.

    Raises
    ------
    PluginError
        Anything else was raised.
    """
    try:
        with at_work(who), timed("component", name, source), without_side_effects(who):
            yield
    except passes:
        raise
    except BaseException as error:
        if not is_fault(error):
            raise
        raise PluginError(f"{who} {how}: {describe(error)}; {REPORT}") from error


def is_fault(error: BaseException) -> bool:
    """Whether what came out of a component's call is a fault of it, and not somebody's Ctrl-C.

    Anything that is raised is, :class:`SystemExit` and other exceptions beside
    :class:`Exception` among them. Python raises :class:`KeyboardInterrupt` wherever it happens to
    be when a signal comes; only where the component's own code says ``raise`` it is the
    component's.

    Examples
    --------
    >>> is_fault(SystemExit(0)), is_fault(KeyboardInterrupt())
    (True, False)
    """
    if isinstance(error, GeneratorExit):
        return False
    return not isinstance(error, KeyboardInterrupt) or _says_raise(error)


def _says_raise(error: BaseException) -> bool:
    """Whether the innermost frame is at a ``raise`` statement that is not the core's."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None or _package(trace.tb_frame) == "moseg_core":
        return False
    return trace.tb_frame.f_code.co_code[trace.tb_lasti] == _RAISE


def summary(error: BaseException) -> str:
    r"""Kind and message of an error, in one line.

    Examples
    --------
    >>> summary(ValueError("not\n  today"))
    'ValueError: not today'
    """
    try:
        text = " ".join(str(error).split())
    except BaseException as failure:  # a stranger's object decides what it does when it is shown
        if not is_fault(failure):
            raise
        text = "it does not say what"
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def safe_repr(value: object, *, most: int = 80) -> str:
    """A stranger's object as a message shows it, whatever it does when it is asked.

    Examples
    --------
    >>> safe_repr("narrow"), safe_repr([1] * 100, most=8)
    ("'narrow'", '[1, 1...')
    >>> class Shy:
    ...     def __repr__(self):
    ...         raise RuntimeError("no")
    >>> safe_repr(Shy())
    'a Shy, which cannot be shown'
    """
    try:
        text = " ".join(repr(value).split())
    except BaseException as error:
        if not is_fault(error):
            raise
        return f"a {type(value).__name__}, which cannot be shown"
    return text if len(text) <= most else f"{text[: most - 3]}..."


def place(error: BaseException) -> str:
    """File, line and source line where the author's code was when an error was raised.

    The author is whose package comes first below the core's frames; of its frames the innermost
    is meant. Empty where there is none, as for an import that fails, and for moseg's own errors,
    which say themselves what is wrong.

    Examples
    --------
    >>> place(ValueError("never raised"))
    ''
    """
    if isinstance(error, MosegError):
        return ""
    author, found = "", None
    for frame, number in traceback.walk_tb(error.__traceback__):
        package = _package(frame)
        if package not in BYSTANDERS and package == (author or package):
            author, found = package, (frame, number)
    if found is None:
        return ""
    frame, number = found
    file = frame.f_code.co_filename
    line = " ".join(linecache.getline(file, number, frame.f_globals).split())
    shown = line if len(line) <= _LONGEST else f"{line[: _LONGEST - 3]}..."
    return f"{shortest(file)}:{number}" + (f': "{shown}"' if shown else "")


def describe(error: BaseException) -> str:
    """Kind and message of an error and the :func:`place` of it, in one line.

    Examples
    --------
    >>> describe(ValueError("never raised"))
    'ValueError: never raised'
    """
    where = place(error)
    return f"{summary(error)} ({where})" if where else summary(error)


def _package(frame: FrameType) -> str:
    """The outermost package of the module that a frame is of."""
    return str(frame.f_globals.get("__name__", "")).partition(".")[0]


def shortest(file: str) -> str:
    """A file as seen from the working directory where it is below that; else in full."""
    here = os.path.join(working_directory(), "")
    return file.removeprefix(here)
