"""What moseg says when something is wrong.

Every error that a user can cause derives from :class:`MosegError`, carries a message of one
line (an expression adds its caret) that says what was asked, what is allowed and what to do, and
knows the exit code with which the command line ends. Anything else that escapes is a bug.

====  ==============================================================
code  meaning
====  ==============================================================
0     success
1     failure: a plugin, the search or the disk
2     usage: an unknown name, a malformed expression or option
3     the shape cannot be used, or not with this problem
====  ==============================================================
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any, ClassVar

from moseg_core.untrusted.terminal import escaped, printable


class MosegError(Exception):
    """Base of all errors that moseg raises on purpose.

    Attributes
    ----------
    exit_code : int
        With which the command line ends.
    result : Result or None
        Where the error ended a search under way, the best that it had found by then.
    """

    exit_code: ClassVar[int] = 1
    result: Any = None  # a Result stands above: nothing here may import it


class UsageError(MosegError, ValueError):
    """A name, value or combination of options that moseg does not accept."""

    exit_code = 2


class ShapeError(MosegError, ValueError):
    """A shape that cannot be read, or cannot be used with the problem at hand."""

    exit_code = 3


class Terminated(KeyboardInterrupt):
    """Somebody told the program to end by SIGTERM or SIGHUP, and it did; like Ctrl-C no error.

    Parameters
    ----------
    number : int
        Of the signal; that of SIGTERM by default.
    """

    def __init__(self, number: int = 15) -> None:
        self.exit_code = 128 + number
        super().__init__(number)


class PluginError(MosegError):
    """A plugin that is missing, broken, or untrue to its kind; names the distribution."""


REPORT = "report it to its authors, or do without it"
"""What a user can do about a component that is untrue to its kind; the end of such messages."""


_LONG, _BESIDE = 160, 48
"""Characters of an expression that is shown whole, and beside a fault where one is not."""
_FAULT = 60
"""Characters of a fault that are shown; of a longer one the beginning is."""
_REASON = 600
"""Characters of a reason that are shown; of a longer one the middle is left out."""
_COMPARED = 200
"""Characters of a name beyond which none is like it: to compare two takes their product."""


class ExpressionError(UsageError):
    """An expression that cannot be understood, with the place in its text.

    Parameters
    ----------
    reason : str
        What is wrong, and the nearest thing that would be right.
    text : str
        The whole expression.
    start, stop : int
        The offending characters are ``text[start:stop]``; a caret is drawn under them. Of a long
        expression only what is around them is shown.

    Examples
    --------
    >>> print(ExpressionError("unknown objective 'narow'", "3*narow(a)", 2, 7))
    unknown objective 'narow' in "3*narow(a)"
      3*narow(a)
        ^^^^^
    """

    def __init__(self, reason: str, text: str, start: int, stop: int | None = None) -> None:
        self.reason = reason
        self.text = text
        self.start = start
        self.stop = max(start + 1, start if stop is None else stop)
        super().__init__(reason, text, start, stop)

    def __str__(self) -> str:
        reason, _, suggestion = self.reason.partition("; ")
        start, stop = self.start, min(self.stop, self.start + _FAULT)
        before = _on_one_line(self.text[max(0, start - _LONG) : start])
        fault = _on_one_line(self.text[start:stop])
        after = _on_one_line(self.text[stop : stop + _LONG])
        # What is not printable takes up to ten characters to show.
        if max(stop, len(self.text), len(before + fault + after)) > _LONG:
            before = f"...{before[-_BESIDE:]}" if len(before) > _BESIDE else before
            fault = fault[:_FAULT]
            after = f"{after[:_BESIDE]}..." if len(after) > _BESIDE else after
        text = before + fault + after
        said = printable(reason, longest=_REASON)
        headline = f'{said} in "{text}"'
        if suggestion:
            headline += f"; {printable(suggestion, longest=_REASON)}"
        # The fault may be behind the end of the text, where something is missing.
        caret = " " * len(before) + "^" * max(len(fault), 1)
        return f"{headline}\n  {text}\n  {caret}"


def _on_one_line(text: str) -> str:
    """Part of an expression as it is shown above its caret: blanks of all kinds are plain ones."""
    return escaped("".join(" " if c.isspace() else c for c in text))


def shown(value: object) -> str:
    """What was given, as Python writes it, in a message; whatever it is, of one short line.

    Examples
    --------
    >>> shown("two"), shown(10**5000)
    ("'two'", 'an int that is too large to be shown')
    """
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        return f"an {type(value).__name__} that is too large to be shown"
    return printable(text, longest=_FAULT)


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name most like `name`, or one of which it is a word; None where nothing is close.

    Examples
    --------
    >>> nearest("narow", ["flat", "narrow"])
    'narrow'
    >>> nearest("dove", ["hand", "paper_dove"])
    'paper_dove'
    >>> nearest("zzz", ["flat", "narrow"]) is None
    True
    """
    if len(name) > _COMPARED:
        return None
    names = [other for other in known if len(other) <= _COMPARED]
    matches = difflib.get_close_matches(name, names, n=1, cutoff=0.6)
    return next(iter(matches or (other for other in names if name in other.split("_"))), None)


def unknown(kind: str, name: str, known: Iterable[str]) -> str:
    """Say that a name is unknown, with the nearest name or else what is allowed.

    Examples
    --------
    >>> unknown("seeder", "kmean", ["kmeans", "given"])
    "unknown seeder 'kmean'; did you mean 'kmeans'?"
    >>> unknown("label", "x", ["head", "handle"])
    "unknown label 'x'; known: handle, head"
    """
    names = sorted(set(known))
    guess = nearest(name, names)
    name = name if len(name) <= _COMPARED else printable(name, longest=_COMPARED)
    if guess is not None:
        return f"unknown {kind} '{name}'; did you mean '{guess}'?"
    return f"unknown {kind} '{name}'; known: {', '.join(names) if names else 'none'}"
