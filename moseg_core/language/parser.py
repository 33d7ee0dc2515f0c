"""Tokens to terms, by recursive descent; every complaint points at its place in the text.

There is one grammar of calls (:mod:`moseg_core.language`). An expression puts weights and spaces
around them; a constraint is a single call; the choice of a component is one without labels.
"""

from __future__ import annotations

import math
from dataclasses import replace

from moseg_core.errors import ExpressionError
from moseg_core.language.target import Target
from moseg_core.language.terms import LITERALS, Argument, Expression, Term, Value, is_word
from moseg_core.language.tokens import GIVE_OR_TAKE, Token, tokenize, unquoted

MOST_CHARACTERS = 100_000
"""Characters of an expression, or of any other text of the language."""

LONGEST_WORD = 200
"""Characters of a name, a label, a glob or a key."""


def parse(text: str) -> Expression:
    """Read an expression.

    Parameters
    ----------
    text : str
        Such as ``"3*narrow(handle) + perpendicular(handle, head) + convex_parts"``.

    Returns
    -------
    Expression

    Raises
    ------
    ExpressionError
        With a caret under what cannot be understood, and what was expected there.

    Examples
    --------
    >>> [term.weight for term in parse("3*narrow(a) - flat(b)").terms]
    [3.0, -1.0]
    >>> parse("narrow(a")
    Traceback (most recent call last):
        ...
    moseg_core.errors.ExpressionError: expected ',' or ')', found the end in "narrow(a"
      narrow(a
              ^
    """
    return _Parser(text).expression()


def parse_call(text: str, *, labels: bool = False) -> Term:
    """Read a single call without weight or space, such as ``pattern_search(expansion=2)``.

    Parameters
    ----------
    text : str
    labels : bool
        Whether the call is about labels, as a constraint is; a component is not.

    Returns
    -------
    Term
        Of weight 1.

    Raises
    ------
    ExpressionError
        Anything else.

    Examples
    --------
    >>> parse_call('mds(landmarks=50, geodesics="exact")').parameters
    (('landmarks', 50), ('geodesics', 'exact'))
    >>> term = parse_call("mirror(leg2, leg1, plane=x)", labels=True)
    >>> [argument.pattern for argument in term.arguments], term.parameters
    (['leg2', 'leg1'], (('plane', 'x'),))
    """
    return _Parser(text, labels=labels).lone_call()


def parse_target(text: str) -> Target:
    """Read a target by itself, as a recipe's table has it: ``{ size = "0.06+-0.02" }``.

    Raises
    ------
    ExpressionError
        Anything else.

    Examples
    --------
    >>> parse_target("-0.5 ± 0.1")
    Target(value=-0.5, spread=0.1)
    """
    return _Parser(text).lone_target()


class _Parser:
    """The state of one parse: the tokens and the place reached.

    `labels` says whether calls may be about labels.
    """

    def __init__(self, text: str, *, labels: bool = True) -> None:
        self.text = text
        self.labels = labels
        if len(text) > MOST_CHARACTERS:
            raise ExpressionError(
                f"an expression has at most {MOST_CHARACTERS} characters, and this one {len(text)};"
                " say less, or put values into tables",
                text,
                MOST_CHARACTERS,
            )
        self.tokens = tokenize(text)
        self.at = 0

    def expression(self) -> Expression:
        if self.at_end:
            raise ExpressionError("the expression is empty; write a term", self.text, 0)
        terms = [self.term(self.sign(optional=True))]
        while not self.at_end:
            terms.append(self.term(self.sign(optional=False)))
        return Expression(tuple(terms), self.text)

    def lone_call(self) -> Term:
        term = self.call(1.0, what="a name")
        if not self.at_end:
            self.fail("the end")
        return term

    def lone_target(self) -> Target:
        value = self.value()
        if not isinstance(value, Target):
            raise ExpressionError("expected a target such as 0.06+-0.02", self.text, 0)
        if not self.at_end:
            self.fail("the end")
        return value

    def sign(self, *, optional: bool) -> float:
        if self.peek.text in ("+", "-"):
            return -1.0 if self.take().text == "-" else 1.0
        if not optional:
            self.fail("'+' or '-'")
        return 1.0

    def term(self, sign: float) -> Term:
        weight = sign
        if self.peek.kind == "number":
            token = self.peek
            weight *= self.number()
            if weight == 0:
                raise ExpressionError(
                    "a weight of 0 leaves the term out; remove it", self.text, *_span(token)
                )
            self.expect("*")
        return self.placed(self.call(weight))

    def placed(self, term: Term) -> Term:
        """The term with the space behind it, where one is named."""
        if self.peek.text != "@":
            return term
        self.take()
        space = self.word("the name of a space after '@', such as original")
        return replace(term, space=space.text, space_span=_span(space))

    def call(self, weight: float, *, what: str = "the name of an objective") -> Term:
        first = self.word(what)
        name, stop = first.text, first.stop
        if self.peek.text == ":":
            self.take()
            second = self.word("a name after ':'")
            name, stop = f"{first.text}:{second.text}", second.stop
        arguments: list[Argument] = []
        parameters: list[tuple[str, Value]] = []
        keys: dict[str, tuple[int, int]] = {}
        if self.peek.text == "(":
            self.take()
            if self.peek.text != ")":
                self.argument(arguments, parameters, keys)
                while self.peek.text == ",":
                    self.take()
                    self.argument(arguments, parameters, keys)
            if self.peek.text != ")":
                self.fail("',' or ')'")
            self.take()
        return Term(
            name=name,
            arguments=tuple(arguments),
            parameters=tuple(parameters),
            weight=weight,
            span=(first.start, stop),
            keys=tuple(keys.values()),
        )

    def argument(
        self,
        arguments: list[Argument],
        parameters: list[tuple[str, Value]],
        keys: dict[str, tuple[int, int]],
    ) -> None:
        token = self.peek
        if token.kind not in ("word", "glob"):
            self.fail("a label" if self.labels else "key=value")
        self.take()
        if self.peek.text == "=":
            if not is_word(token.text):
                raise ExpressionError(
                    f"'{token.text}' cannot be the name of a parameter; names begin with a letter"
                    " or '_'",
                    self.text,
                    *_span(token),
                )
            if token.text in keys:
                raise ExpressionError(
                    f"parameter '{token.text}' is given twice", self.text, *_span(token)
                )
            self.take()
            parameters.append((token.text, self.value()))
            keys[token.text] = _span(token)
        elif not self.labels:
            raise ExpressionError(
                'expected key=value; words with other characters stand in quotes: key="a,b"',
                self.text,
                *_span(token),
            )
        elif parameters:
            raise ExpressionError("labels come before parameters", self.text, *_span(token))
        else:
            arguments.append(Argument(token.text, _span(token)))

    def value(self) -> Value:
        if self.peek.kind == "quoted":
            return unquoted(self.take().text)
        if self.peek.kind == "word" and is_word(self.peek.text):
            word = self.take().text
            return LITERALS.get(word, word)
        if self.peek.kind == "path":
            return self.take().text
        if self.peek.text in ("+", "-"):
            negative = self.take().text == "-"
            value = self.number("a number")
            return self.give_or_take(-value if negative else value)
        return self.give_or_take(self.number("a number or a word"))

    def give_or_take(self, value: float) -> Value:
        """The value by itself, or the target that it begins."""
        if self.peek.text not in GIVE_OR_TAKE:
            return value
        sign = self.take().text
        token = self.peek
        spread = self.number(f"the spread of a target after '{sign}', a positive number")
        if spread == 0:
            raise ExpressionError(
                f"the spread of a target must be positive; write how far from {value:g} is still"
                " usual",
                self.text,
                *_span(token),
            )
        return Target(value, spread)

    def number(self, what: str = "a number") -> float:
        """The number here: an int where it is written as one, which may be exact beyond 2^53."""
        token = self.peek
        if token.kind != "number":
            self.fail(what)
        value = float(self.take().text)
        if not math.isfinite(value):
            raise ExpressionError("the number is too large", self.text, *_span(token))
        # Zeros in front would count towards the greatest number of digits that int() reads.
        return int(token.text.lstrip("0") or "0") if token.text.isdigit() else value

    def word(self, what: str) -> Token:
        if self.peek.kind != "word" or not is_word(self.peek.text):
            self.fail(what)
        return self.take()

    def expect(self, symbol: str) -> None:
        if self.peek.text != symbol:
            self.fail(f"'{symbol}'")
        self.take()

    @property
    def peek(self) -> Token:
        return self.tokens[self.at]

    @property
    def at_end(self) -> bool:
        return self.peek.kind == "end"

    def take(self) -> Token:
        token = self.tokens[self.at]
        if token.kind in ("word", "glob") and len(token.text) > LONGEST_WORD:
            raise ExpressionError(
                f"a word of {len(token.text)} characters; the longest has {LONGEST_WORD}",
                self.text,
                *_span(token),
            )
        self.at += 1
        return token

    def fail(self, expected: str) -> None:
        token = self.peek
        found = "the end" if token.kind == "end" else f"'{token.text}'"
        raise ExpressionError(f"expected {expected}, found {found}", self.text, *_span(token))


def _span(token: Token) -> tuple[int, int]:
    return token.start, max(token.stop, token.start + 1)
