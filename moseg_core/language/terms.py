"""What an expression is once read: a sum of weighted calls.

The classes know their own text, so that ``parse(str(e)) == e``; the places in the user's text,
kept for error messages, take no part in comparisons.
"""

from __future__ import annotations

from dataclasses import dataclass, field


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
    parameters : tuple of (str, float or str)
        In the order written; words only where :func:`~moseg_core.language.parse_constraint`
        allows them.
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
    parameters: tuple[tuple[str, float | str], ...] = ()
    weight: float = 1.0
    span: tuple[int, int] = field(default=(0, 0), compare=False)
    keys: tuple[tuple[int, int], ...] = field(default=(), compare=False)
    space: str = ""
    space_span: tuple[int, int] = field(default=(0, 0), compare=False)

    @property
    def call(self) -> str:
        """The term without its weight: ``narrow(leg*)``, ``convex_parts @ mds``."""
        inside = [argument.pattern for argument in self.arguments]
        inside += [
            f"{key}={value if isinstance(value, str) else format_number(value)}"
            for key, value in self.parameters
        ]
        bare = f"{self.name}({', '.join(inside)})" if inside else self.name
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


def format_number(value: float) -> str:
    """The shortest text that reads back as the same number.

    Examples
    --------
    >>> format_number(3.0), format_number(0.1), format_number(1e-6)
    ('3', '0.1', '1e-06')
    """
    text = repr(float(value))
    return text[:-2] if text.endswith(".0") else text
