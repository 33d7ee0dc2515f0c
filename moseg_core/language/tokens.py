"""Characters to tokens, each with its place in the text.

The one subtlety is ``*``: between a number and a name it multiplies, inside parentheses it is
always part of a glob, so that ``10*narrow(leg*)`` means what it looks like. The tokenizer
therefore counts parentheses. After a number ``+-`` is one sign, as ``±`` is everywhere. Between
double quotes every character stands for itself, but for the quote and the backslash, which a
backslash announces; :func:`quoted` and :func:`unquoted` are the two directions, and
:func:`format_number` is the way back of numbers. The characters ``/ { } ..`` are reserved for
later.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Literal

from moseg_core.errors import ExpressionError

TokenKind = Literal["number", "word", "path", "glob", "quoted", "symbol", "end"]

_SPACE = re.compile(r"\s*")
_NUMBER = re.compile(r"(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?(?![\w.])", re.ASCII)
_WORD = re.compile(r"\w+", re.ASCII)
_PATH = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+", re.ASCII)
_GLOB = re.compile(r"[\w*]+", re.ASCII)
_OPEN_QUOTATION = re.compile(r'"(?:[^"\\]|\\["\\])*')
_ESCAPED = re.compile(r'\\(["\\])')
_RESERVED = re.compile(r"\.\.|[/{}]")

GIVE_OR_TAKE = ("+-", "±")
"""What stands between the value of a target and its spread."""


@dataclass(frozen=True)
class Token:
    """A token: ``text``, with its quotes if it has any, stands at ``start`` in the expression."""

    kind: TokenKind
    text: str
    start: int

    @property
    def stop(self) -> int:
        """Where the token ends."""
        return self.start + len(self.text)


def tokenize(text: str) -> list[Token]:
    """Split an expression into tokens; the last one has the kind "end".

    Raises
    ------
    ExpressionError
        A character that means nothing here, or is reserved; a quote that does not end.

    Examples
    --------
    >>> [token.text for token in tokenize("10*narrow(leg*)")][:-1]
    ['10', '*', 'narrow', '(', 'leg*', ')']
    """
    tokens: list[Token] = []
    depth = 0
    value_next = False
    at = 0
    while True:
        at = _SPACE.match(text, at).end()  # type: ignore[union-attr]  # matches everywhere
        if at == len(text):
            tokens.append(Token("end", "", at))
            return tokens
        if text.startswith("+-", at) and tokens and tokens[-1].kind == "number":
            token = Token("symbol", "+-", at)
        else:
            token = _token_at(text, at, inside=depth > 0, value=value_next)
        depth += {"(": 1, ")": -1}.get(token.text, 0)
        value_next = token.text in ("=", *GIVE_OR_TAKE) or (value_next and token.text in "+-")
        tokens.append(token)
        at = token.stop


def _token_at(text: str, at: int, *, inside: bool, value: bool) -> Token:
    """The token at a place; `inside` parentheses words may be globs, a `value` a number or path."""
    number = _NUMBER.match(text, at)
    if number and (value or not inside):
        return Token("number", number.group(), at)
    if value and (path := _PATH.match(text, at)):
        return Token("path", path.group(), at)
    if inside and (glob := _GLOB.match(text, at)):
        return Token("glob" if "*" in glob.group() else "word", glob.group(), at)
    if not inside and (word := _WORD.match(text, at)):
        return Token("word", word.group(), at)
    if text[at] == '"':
        return _quotation(text, at)
    if reserved := _RESERVED.match(text, at):
        raise ExpressionError(
            f"'{reserved.group()}' is reserved for later versions", text, at, reserved.end()
        )
    if text[at] in "+-*(),=:@±":
        return Token("symbol", text[at], at)
    raise ExpressionError(f"unexpected character {text[at]!r}", text, at)


def _quotation(text: str, at: int) -> Token:
    """The quoted word that begins at a place."""
    stop = _OPEN_QUOTATION.match(text, at).end()  # type: ignore[union-attr]  # a quote is there
    after = text[stop : stop + 1]
    if after == "\\":
        reason = "in quotes a backslash stands before a quote or another backslash"
        raise ExpressionError(f"{reason}; write two for one", text, stop)
    if not after:
        raise ExpressionError("the quote does not end; close it with another", text, at, stop)
    return Token("quoted", text[at : stop + 1], at)


def is_path(text: str) -> bool:
    """Whether a text is words with points between them.

    Examples
    --------
    >>> is_path("looks.leg"), is_path("looks"), is_path("0.5")
    (True, False, False)
    """
    return _PATH.fullmatch(text) is not None


def quoted(word: str) -> str:
    r"""A word in quotes, whatever is in it.

    Examples
    --------
    >>> print(quoted('12" pipe'))
    "12\" pipe"
    """
    escaped = word.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def unquoted(text: str) -> str:
    r"""The word that a quoted token stands for.

    Examples
    --------
    >>> print(unquoted(r'"12\" pipe"'))
    12" pipe
    """
    return _ESCAPED.sub(r"\1", text[1:-1])


def format_number(value: Real | float) -> str:
    """The shortest text that reads back as the same number; a truth value as 1 or 0.

    Examples
    --------
    >>> format_number(3.0), format_number(0.1), format_number(1e-6), format_number(2**60 + 1)
    ('3', '0.1', '1e-06', '1152921504606846977')
    """
    if isinstance(value, Integral):
        return str(int(value))
    text = repr(float(value))
    # Without its point -0.0 would be read as a whole number, which has no sign there.
    return text[:-2] if text.endswith(".0") and text != "-0.0" else text
