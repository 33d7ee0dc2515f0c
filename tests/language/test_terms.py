"""Terms as text, and what takes part in comparing them."""

from __future__ import annotations

import dataclasses

import pytest

from moseg_core.language import Argument, Expression, Term, parse


@pytest.mark.parametrize(
    ("pattern", "is_glob"), [("leg", False), ("leg*", True), ("*", True), ("1", False)]
)
def test_a_star_makes_a_glob(pattern, is_glob):
    assert Argument(pattern).is_glob is is_glob


@pytest.mark.parametrize(
    ("term", "call", "text"),
    [
        (Term("f"), "f", "f"),
        (Term("f", weight=3.0), "f", "3*f"),
        (Term("f", weight=-1.0), "f", "-1*f"),
        (Term("b:f", (Argument("leg*"), Argument("x"))), "b:f(leg*, x)", "b:f(leg*, x)"),
        (Term("f", parameters=(("k", 2.0), ("j", -0.5))), "f(k=2, j=-0.5)", "f(k=2, j=-0.5)"),
        (Term("f", (Argument("a"),), (("k", 1e-9),), 0.1), "f(a, k=1e-09)", "0.1*f(a, k=1e-09)"),
    ],
)
def test_a_term_as_text(term, call, text):
    assert term.call == call
    assert str(term) == text


@pytest.mark.parametrize(
    ("weights", "text"),
    [
        ([1], "f0"),
        ([-1], "-f0"),
        ([2, -3], "2*f0 - 3*f1"),
        ([-2, -1, 1, 0.5], "-2*f0 - f1 + f2 + 0.5*f3"),
    ],
)
def test_a_sum_as_text(weights, text):
    terms = tuple(Term(f"f{k}", weight=float(weight)) for k, weight in enumerate(weights))
    assert str(Expression(terms)) == text


def test_places_and_the_original_text_take_no_part_in_comparisons():
    spread, tight = parse("  2 * f( a , k = 1 )"), parse("2*f(a,k=1)")
    assert spread == tight
    assert hash(spread) == hash(tight)
    assert spread.text != tight.text
    assert spread.terms[0].span != tight.terms[0].span
    assert spread.terms[0].keys != tight.terms[0].keys


@pytest.mark.parametrize("other", ["3*f(a, k=1)", "2*g(a, k=1)", "2*f(b, k=1)", "2*f(a, k=2)"])
def test_everything_else_does(other):
    assert parse("2*f(a, k=1)") != parse(other)


def test_the_order_of_terms_and_of_labels_is_kept():
    assert parse("f + g") != parse("g + f")
    assert parse("f(a, b)") != parse("f(b, a)")


def test_places_are_those_in_the_text():
    text = "3*basic : narrow( leg* ,x, power =2)"
    (term,) = parse(text).terms
    assert text[slice(*term.span)] == "basic : narrow"
    assert [text[slice(*argument.span)] for argument in term.arguments] == ["leg*", "x"]
    assert [text[slice(*span)] for span in term.keys] == ["power"]
    assert parse(text).text == text


def test_terms_cannot_be_changed():
    with pytest.raises(dataclasses.FrozenInstanceError):
        parse("f").terms[0].weight = 2.0
