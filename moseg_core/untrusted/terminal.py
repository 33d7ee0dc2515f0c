r"""What may be written to a terminal of text that comes from somewhere else.

Names of labels, of files and of what is in them, warnings in a result, the message of a component:
any of these can hold characters that a terminal obeys instead of showing them. An escape sequence
sets its title or wipes what was said before (ECMA-48); marks of direction turn around what is read
(Unicode Standard Annex 9, "Trojan Source"); a line break forges a message. Everything that the
command line prints goes through one function, :func:`printable`, which shows such characters as
Python writes them in a string: ``\x1b``, ``\u202e``, ``\n``. What is printable is not this
module's opinion but Unicode's: letters, marks, numbers, punctuation, symbols and the plain blank
(:meth:`str.isprintable`). Half a surrogate pair, which no terminal can be sent, is not.

:mod:`moseg_core.cli.console` applies it to messages, tables and JSON. A command of a bundle that
prints by itself calls it as ``moseg_core.printable``.
"""

from __future__ import annotations

import re

LONGEST = 2000
"""Characters of a message, or of a cell of a table, that are shown; of more the middle is not."""

#: The two lines that the message of a malformed expression ends with: the text, and a caret.
_CARET = re.compile(r"\n  (?P<text>[^\n]*)\n  (?P<caret> *\^+)\Z")


def printable(text: str, *, longest: int = LONGEST) -> str:
    r"""One line that is safe to print, whatever a text holds.

    Parameters
    ----------
    text : str
    longest : int
        Of a longer text the middle is left out.

    Returns
    -------
    str
        The text itself where it is printable and short enough.

    Examples
    --------
    >>> print(printable("leg\x1b[2J\u202e"))
    leg\x1b[2J\u202e
    >>> print(printable("größe 5 µm"))
    größe 5 µm
    >>> print(printable("abcdefghij" * 10, longest=50))
    abcdefghijabcdefghijabcdefghijabcd[... 50 of 100 characters ...]efghijabcdefghij
    """
    if len(text) > longest:
        text = _shortened(text, longest)
    if text.isprintable():
        return text
    return _shortened(escaped(text), longest)


def escaped(text: str) -> str:
    r"""A text with each character that is not printable shown as an escape sequence of Python.

    Examples
    --------
    >>> print(escaped("a\tb\x9b\ud800"))
    a\tb\x9b\ud800
    """
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )


def printable_message(text: str) -> str:
    r"""A message as it is printed: one line, and the two of a caret where it ends with them.

    Parameters
    ----------
    text : str
        Such as the message of an :class:`~moseg_core.errors.ExpressionError`, also within that of
        another error.

    Examples
    --------
    >>> print(printable_message("'\x1b' in \"narow(a)\"\n  narow(a)\n  ^^^^^"))
    '\x1b' in "narow(a)"
      narow(a)
      ^^^^^
    >>> print(printable_message("unknown label 'a\nmoseg: wrote r.json'"))
    unknown label 'a\nmoseg: wrote r.json'
    """
    drawn = _CARET.search(text)
    if drawn is None or len(drawn.group()) > LONGEST:
        return printable(text)
    said = printable(text[: drawn.start()])
    return f"{said}\n  {escaped(drawn['text'])}\n  {drawn['caret']}"


def printable_json(text: str) -> str:
    r"""The text of a JSON document with what is not printable in its strings escaped as JSON does.

    Parameters
    ----------
    text : str
        As :func:`json.dumps` makes it, indented or not.

    Examples
    --------
    >>> print(printable_json('{\n "a": "\u202e\x9b"\n}'))
    {
     "a": "\u202e\u009b"
    }
    """
    if text.replace("\n", "").isprintable():
        return text
    return "".join(c if c.isprintable() or c == "\n" else _as_in_json(c) for c in text)


def _as_in_json(character: str) -> str:
    units = character.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[k]:02x}{units[k + 1]:02x}" for k in range(0, len(units), 2))


def _shortened(text: str, longest: int) -> str:
    """A text of at most so many characters, but for the words that say how many there were."""
    if len(text) <= longest:
        return text
    tail = longest // 3
    left = len(text) - longest
    return f"{text[: longest - tail]}[... {left} of {len(text)} characters ...]{text[-tail:]}"
