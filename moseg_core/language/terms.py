"""What an expression is once read: a sum of weighted calls.

The classes know their own text, so that ``parse(str(e)) == e``; the places in the user's text,
kept for error messages, take no part in comparisons. :func:`format_call` writes the calls of all
who use them, components that somebody chose included.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Real

from moseg_core.language.target import Target
from moseg_core.language.tokens import format_number, is_path, quoted

Value = float | str | Target | None
"""Of a parameter: a number (int and bool are some), a word, a target, or nothing."""

LITERALS: dict[str, Value] = {"true": True, "false": False, "none": None}
"""Words that mean themselves only in quotes."""

_WORD = re.compile(r"[A-Za-z_]\w*\Z", re.ASCII)


def is_word(text: str) -> bool:
    """Whether a text is a word of the language: a letter or ``_``, then also digits.

    Examples
    --------
    >>> is_word("leg2"), is_word("2nd"), is_word("a b")
    (True, False, False)
    """
    return _WORD.match(text) is not None


@dataclass(frozen=True)
class Argument:
    """A label or a glob over labels.

    Parameters
    ----------
    pattern : str
        Letters, digits, ``_`` and, in a glob, ``*``.
    span : (int, int)
        Its place in the expression.
    """

    pattern: str
    span: tuple[int, int] = field(default=(0, 0), compare=False)

    @property
    def is_glob(self) -> bool:
        """Whether the pattern can stand for several labels."""
        return "*" in self.pattern


@dataclass(frozen=True)
class Term:
    """A weighted call of one objective.

    Parameters
    ----------
    name : str
        As written: ``narrow`` or ``basic:narrow``.
    arguments : tuple of Argument
    parameters : tuple of (str, float, str, Target or None)
        In the order written.
    weight : float
        With the sign that the term has in the sum.
    span : (int, int)
        Place of the name in the expression.
    keys : tuple of (int, int)
        Places of the parameters' names.
    space : str
        Where the term is evaluated, the word after ``@``; empty where it does not say.
    space_span : (int, int)
        Its place in the expression.
    """

    name: str
    arguments: tuple[Argument, ...] = ()
    parameters: tuple[tuple[str, Value], ...] = ()
    weight: float = 1.0
    span: tuple[int, int] = field(default=(0, 0), compare=False)
    keys: tuple[tuple[int, int], ...] = field(default=(), compare=False)
    space: str = ""
    space_span: tuple[int, int] = field(default=(0, 0), compare=False)

    @cached_property
    def call(self) -> str:
        """The term without its weight: ``narrow(leg*)``, ``convex_parts @ mds``."""
        labels = [argument.pattern for argument in self.arguments]
        bare = format_call(self.name, labels, self.parameters)
        return f"{bare} @ {self.space}" if self.space else bare

    def __str__(self) -> str:
        return self.call if self.weight == 1 else f"{format_number(self.weight)}*{self.call}"


@dataclass(frozen=True)
class Expression:
    """A sum of terms.

    Parameters
    ----------
    terms : tuple of Term
    text : str
        What the user wrote.

    Examples
    --------
    >>> from moseg_core.language import parse
    >>> str(parse("3*narrow( handle )-convex_parts"))
    '3*narrow(handle) - convex_parts'
    """

    terms: tuple[Term, ...]
    text: str = field(default="", compare=False)

    def __str__(self) -> str:
        out = ""
        for term in self.terms:
            size = abs(term.weight)
            bare = term.call if size == 1 else f"{format_number(size)}*{term.call}"
            minus = term.weight < 0
            out += (" - " if minus else " + ") + bare if out else ("-" if minus else "") + bare
        return out


def format_call(
    name: str, labels: Iterable[str] = (), parameters: Iterable[tuple[str, object]] = ()
) -> str:
    """A call as text, from which :func:`~moseg_core.language.parse_call` reads it again.

    Examples
    --------
    >>> format_call("greedy", parameters=[("order", "head,body")])
    'greedy(order="head,body")'
    """
    inside = [*labels, *(f"{key}={format_value(value)}" for key, value in parameters)]
    return f"{name}({', '.join(inside)})" if inside else name


def format_value(value: object) -> str:
    """The value of a parameter as text: words in quotes where they would not be read as such.

    Examples
    --------
    >>> [format_value(value) for value in (2.0, "exact", "1.5", "none", None, Target(2, 0.5))]
    ['2', 'exact', '"1.5"', '"none"', 'none', '2+-0.5']
    """
    if value is None:
        return "none"
    if isinstance(value, Real):
        return format_number(value)
    if isinstance(value, Target):
        return str(value)
    word = str(value)
    plain = is_path(word) or (is_word(word) and word not in LITERALS)
    return word if plain else quoted(word)
