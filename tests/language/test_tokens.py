"""Characters to tokens: what is a number, a word, a glob, and what is refused where."""

from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from moseg_core.errors import ExpressionError
from moseg_core.language.tokens import Token, format_number, quoted, tokenize, unquoted


def kinds(text: str) -> list[tuple[str, str]]:
    return [(token.kind, token.text) for token in tokenize(text)][:-1]


def test_an_expression_in_full():
    assert kinds("-3*b:f(leg*, x) + g(k=-.5)") == [
        ("symbol", "-"),
        ("number", "3"),
        ("symbol", "*"),
        ("word", "b"),
        ("symbol", ":"),
        ("word", "f"),
        ("symbol", "("),
        ("glob", "leg*"),
        ("symbol", ","),
        ("word", "x"),
        ("symbol", ")"),
        ("symbol", "+"),
        ("word", "g"),
        ("symbol", "("),
        ("word", "k"),
        ("symbol", "="),
        ("symbol", "-"),
        ("number", ".5"),
        ("symbol", ")"),
    ]


@pytest.mark.parametrize(
    "number",
    ["3", "3.", ".5", "0.25", "1e-3", "1E+5", "12.5e2", "3.e1", ".5e-10", "007", "1e999"],
)
def test_numbers_before_a_name_and_after_an_equals_sign(number):
    assert kinds(f"{number}*f")[0] == ("number", number)
    assert kinds(f"f(k={number})")[4] == ("number", number)
    assert kinds(f"f(k=-{number})")[5] == ("number", number)
    assert kinds(f"f( k = +  {number} )")[5] == ("number", number)


@pytest.mark.parametrize("text", ["3a", "1e", "1e5x", "1_000", "0x10", "1j", "3e"])
def test_what_merely_begins_like_a_number_is_a_word(text):
    assert kinds(text) == [("word", text)]


def test_a_number_does_not_end_in_the_middle_of_another():
    with pytest.raises(ExpressionError, match="unexpected character") as caught:
        tokenize("1.2.3*f")
    assert caught.value.start == 1


@pytest.mark.parametrize("label", ["3", "1e3", "007", "leg1", "_", "__a", "E"])
def test_words_inside_parentheses_are_labels_even_where_they_look_like_numbers(label):
    assert kinds(f"f({label})")[2] == ("word", label)


@pytest.mark.parametrize("glob", ["*", "leg*", "*leg", "l*g", "**", "1*", "*3", "1e*"])
def test_a_star_inside_parentheses_belongs_to_a_glob(glob):
    assert kinds(f"f({glob})")[2] == ("glob", glob)


def test_a_star_outside_parentheses_multiplies_also_after_some():
    assert kinds("2*f(a*)*g") == [
        ("number", "2"),
        ("symbol", "*"),
        ("word", "f"),
        ("symbol", "("),
        ("glob", "a*"),
        ("symbol", ")"),
        ("symbol", "*"),
        ("word", "g"),
    ]


def test_only_the_value_itself_is_read_as_a_number():
    # After the value, and after a sign that belongs to no value, labels are labels again.
    assert kinds("f(k=1, 2)")[-2] == ("word", "2")
    assert kinds("f(-2)")[3] == ("word", "2")


@pytest.mark.parametrize("mark", ["/", "{", "}", ".."])
@pytest.mark.parametrize("before", ["a", "f(a", "3*f(a) + ", "f(a*, "])
def test_reserved_characters_say_so(mark, before):
    text = f"{before}{mark}b"
    with pytest.raises(ExpressionError) as caught:
        tokenize(text)
    error = caught.value
    assert error.reason == f"'{mark}' is reserved for later versions"
    assert text[error.start : error.stop] == mark
    assert error.start == len(before)


@pytest.mark.parametrize(
    "character",
    [*"$!'[];<>&|^%?~\\#`.", "é", "²", "\xd7", "\u2212", "\0", "\x7f", "\ud800", "\U0001d51e"],
)
@pytest.mark.parametrize("before", ["", "f(a", "3*f + "])
def test_other_characters_are_refused_where_they_stand(character, before):
    with pytest.raises(ExpressionError) as caught:
        tokenize(f"{before}{character} b")
    error = caught.value
    assert error.reason == f"unexpected character {character!r}"
    assert (error.start, error.stop) == (len(before), len(before) + 1)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ('""', ""),
        ('"a b"', "a b"),
        (r'"\""', '"'),
        (r'"\\"', "\\"),
        (r'"\\\""', '\\"'),
        ('"(,=*/{}..\n"', "(,=*/{}..\n"),
    ],
)
def test_between_quotes_characters_stand_for_themselves(text, word):
    middle = [("quoted", text), ("symbol", ","), ("glob", "a*"), ("symbol", ")")]
    assert kinds(f"f(k={text}, a*)")[4:] == middle
    assert unquoted(text) == word


@given(st.text())
def test_any_word_in_quotes_is_one_token_that_reads_back(word):
    token, end = tokenize(quoted(word))
    assert (token.kind, unquoted(token.text), end.kind) == ("quoted", word, "end")


@pytest.mark.parametrize("text", ["٣*f", "f(k=٣)", "٣", "३.५*f"])
def test_digits_are_those_of_ascii_like_letters(text):
    with pytest.raises(ExpressionError, match="unexpected character"):
        tokenize(text)


@pytest.mark.parametrize("space", [" ", "\t", "\n", "\r\n", "\v", "\u00a0", "\u3000", "  \n\t "])
def test_space_of_any_kind_separates_and_means_nothing(space):
    text = space.join(["", "3", "*", "f", "(", "a*", ",", "k", "=", "1", ")", ""])
    assert kinds(text) == kinds("3*f(a*,k=1)")


@pytest.mark.parametrize("text", ["", "  ", "\n"])
def test_nothing_is_just_the_end(text):
    (end,) = tokenize(text)
    assert (end.kind, end.text, end.start, end.stop) == ("end", "", len(text), len(text))


@pytest.mark.parametrize("sign", ["+-", "±"])
@pytest.mark.parametrize("space", ["", " ", "\n "])
def test_between_two_numbers_give_or_take_is_one_sign(sign, space):
    text = space.join(["f(k=", "-.5", sign, "1e-3", ")"])
    assert kinds(text)[3:] == [
        ("symbol", "="),
        ("symbol", "-"),
        ("number", ".5"),
        ("symbol", sign),
        ("number", "1e-3"),
        ("symbol", ")"),
    ]


def test_a_plus_and_a_minus_are_two_signs_anywhere_else():
    assert [text for _, text in kinds("f +-3*g(k=+-2)")] == [
        *("f", "+", "-", "3", "*", "g", "(", "k", "=", "+", "-", "2", ")")
    ]


def tokens_or_error(text: str) -> list[Token] | ExpressionError:
    try:
        return tokenize(text)
    except ExpressionError as error:
        return error


ALPHABET = st.sampled_from('ab1.e*+-±(),=: \n/"\\')


@given(st.one_of(st.text(), st.text(ALPHABET)))
@example("f(a")
@example(")a*(")
@example("((a*)b*)*")
def test_tokens_are_the_text_without_its_space_each_at_its_place(text):
    tokens = tokens_or_error(text)
    if isinstance(tokens, ExpressionError):
        assert 0 <= tokens.start < tokens.stop <= len(text)
        return
    between = [
        text[a.stop : b.start]
        for a, b in zip([Token("end", "", 0), *tokens[:-1]], tokens, strict=True)
    ]
    assert not "".join(between).strip()
    for token in tokens:
        assert text[token.start : token.stop] == token.text
    assert [token.kind for token in tokens].count("end") == 1
    assert tokens[-1].kind == "end"


@given(st.floats(allow_nan=False, allow_infinity=False))
@example(1e16)
@example(5e-324)
@example(-0.0)
def test_a_number_reads_back_as_itself(value):
    text = format_number(value)
    assert float(text) == value
    assert not text.endswith(".0") or text == "-0.0"  # "-0" would be the whole number 0


@pytest.mark.parametrize(
    ("value", "text"),
    [(3, "3"), (-3.0, "-3"), (0.1, "0.1"), (1e22, "1e+22"), (100, "100"), (1e-7, "1e-07")],
)
def test_numbers_are_written_shortly(value, text):
    assert format_number(value) == text
