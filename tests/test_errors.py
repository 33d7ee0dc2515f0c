"""Messages: carets, suggestions, exit codes."""

from __future__ import annotations

import copy
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import (
    ExpressionError,
    MosegError,
    PluginError,
    ShapeError,
    UsageError,
    nearest,
    unknown,
)


@pytest.mark.parametrize(
    ("kind", "code"),
    [(MosegError, 1), (PluginError, 1), (UsageError, 2), (ExpressionError, 2), (ShapeError, 3)],
)
def test_exit_codes(kind, code):
    assert kind.exit_code == code
    assert issubclass(kind, MosegError)


@pytest.mark.parametrize("kind", [UsageError, ExpressionError, ShapeError])
def test_wrong_values_are_value_errors_too(kind):
    assert issubclass(kind, ValueError)


def test_an_expression_error_draws_carets_under_its_place():
    error = ExpressionError("unknown objective 'narow'", "3*narow(a)", 2, 7)
    assert str(error).splitlines() == [
        "unknown objective 'narow' in \"3*narow(a)\"",
        "  3*narow(a)",
        "    ^^^^^",
    ]


def test_the_suggestion_comes_after_the_expression():
    error = ExpressionError("unknown label 'x'; did you mean 'y'?", "f(x)", 2, 3)
    assert str(error).splitlines()[0] == "unknown label 'x' in \"f(x)\"; did you mean 'y'?"


@pytest.mark.parametrize("at", [0, 100, 395])
def test_of_a_long_expression_what_is_around_the_place_is_shown(at):
    text = " + ".join(["flat(a)"] * 40)
    text = text[:at] + "wrong" + text[at + 5 :]
    headline, shown, carets = str(ExpressionError("unknown", text, at, at + 5)).splitlines()
    assert shown[carets.index("^") : carets.rindex("^") + 1] == "wrong"
    assert len(shown) < 120
    assert shown.strip() in headline
    assert shown.startswith("  ...") == (at > 0)
    assert shown.endswith("...") == (at < 395)


@pytest.mark.parametrize("stop", [None, 4, 3])
def test_there_is_a_caret_even_at_the_end(stop):
    error = ExpressionError("expected ')'", "f(a", 3, stop)
    assert error.stop == 4
    assert str(error).splitlines()[-1] == "     ^"


@pytest.mark.parametrize("through", [copy.copy, lambda e: pickle.loads(pickle.dumps(e))])
def test_an_expression_error_survives_copying(through):
    error = ExpressionError("a reason; and advice", "f(x)", 2, 3)
    again = through(error)
    assert type(again) is ExpressionError
    assert str(again) == str(error)
    assert (again.reason, again.text, again.start, again.stop) == (
        error.reason,
        error.text,
        error.start,
        error.stop,
    )


@pytest.mark.parametrize(
    ("name", "known", "found"),
    [
        ("narow", ["flat", "narrow"], "narrow"),
        ("narrow", ["narrow"], "narrow"),
        ("Narrow", ["flat", "narrow"], "narrow"),
        ("zzz", ["flat", "narrow"], None),
        ("a", [], None),
        ("", ["flat"], None),
        ("legs", ["leg1", "legs2", "leg"], "legs2"),
    ],
)
def test_the_nearest_name(name, known, found):
    assert nearest(name, known) == found


def test_names_may_come_from_any_iterable():
    assert nearest("narow", (name for name in ["flat", "narrow"])) == "narrow"
    assert unknown("x", "narow", (name for name in ["flat", "narrow"])).endswith("'narrow'?")


@pytest.mark.parametrize(
    ("known", "message"),
    [
        (["kmeans", "given"], "unknown seeder 'kmean'; did you mean 'kmeans'?"),
        (["b", "a", "b"], "unknown seeder 'kmean'; known: a, b"),
        ([], "unknown seeder 'kmean'; known: none"),
    ],
)
def test_unknown_names_are_answered_with_a_suggestion_or_all_there_are(known, message):
    assert unknown("seeder", "kmean", known) == message


def test_what_is_not_printable_makes_no_long_message():
    text = "narrow(a) + " + 70 * "\udcff" + "flat(b)" + 70 * "\udcff"
    said = str(ExpressionError("no such thing", text, 80, 150)).split("\n")
    assert len(said) == 3
    assert max(map(len, said)) < 300
    caret = said[2].index("^")
    assert said[1][caret : caret + 4] == "\\udc"


def test_a_long_name_is_told_shortly():
    assert len(unknown("seeder", "x" * 10_000, ["kmeans"])) < 300


WORDS = st.from_regex(r"[a-z]{1,8}", fullmatch=True)


@given(WORDS, st.lists(WORDS))
def test_a_suggestion_is_always_known(name, known):
    guess = nearest(name, known)
    assert guess is None or guess in known
    assert (guess is None) == ("did you mean" not in unknown("label", name, known))


@given(st.text(st.characters(codec="ascii", categories=["L", "N", "P"])), st.data())
def test_carets_stand_under_the_place_wherever_it_is(text, data):
    start = data.draw(st.integers(0, len(text)))
    stop = data.draw(st.integers(start, len(text)))
    error = ExpressionError("reason", text, start, stop)
    _, above, carets = str(error).splitlines()
    assert set(carets) == {" ", "^"}
    first, last = carets.index("^"), carets.rindex("^") + 1
    if start < stop:
        assert above[first:last] == text[start:stop]
    else:
        assert (first, last) == (2 + start, 3 + start)
