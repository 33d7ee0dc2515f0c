"""Tokens to terms: texts that read back as themselves, and every mistake with its place."""

from __future__ import annotations

import ast
import dataclasses
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import moseg_core.language
from moseg_core.errors import ExpressionError
from moseg_core.language import Argument, Expression, Target, Term, parse, parse_call, parse_target
from moseg_core.language.tokens import tokenize

NAMES = st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,6}", fullmatch=True)
OBJECTIVES = st.one_of(NAMES, st.tuples(NAMES, NAMES).map(":".join))
PATTERNS = st.from_regex(r"[A-Za-z0-9_*]{1,6}", fullmatch=True)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
TRICKY = [
    "a b",
    "1.5",
    "-3",
    "1e5",
    "x,y",
    "",
    "tête",
    '"',
    "\\",
    '\\"',
    "a*",
    "a.b",
    "a.1",
    "a.b.",
    "true",
    "none",
    "\n",
    "=",
    ")",
]
WORDS = st.one_of(NAMES, st.sampled_from(TRICKY), st.text())
INTEGERS = st.integers(-(10**300), 10**300)
TARGETS = st.builds(
    Target,
    st.one_of(NUMBERS, INTEGERS),
    st.floats(0, exclude_min=True, allow_infinity=False),
)
VALUES = st.one_of(NUMBERS, st.sampled_from([1e-300, -1e-300]), INTEGERS, WORDS, st.none(), TARGETS)
TERMS = st.builds(
    Term,
    name=OBJECTIVES,
    arguments=st.lists(st.builds(Argument, PATTERNS), max_size=3).map(tuple),
    parameters=st.dictionaries(NAMES, VALUES, max_size=3).map(lambda d: tuple(d.items())),
    weight=st.one_of(st.sampled_from([1.0, -1.0]), NUMBERS.filter(bool)),
    space=st.one_of(st.just(""), NAMES),
)
EXPRESSIONS = st.builds(Expression, st.lists(TERMS, min_size=1, max_size=4).map(tuple))
SPACES = st.sampled_from(["", " ", "\n", "\t  ", "\r\n"])


@given(EXPRESSIONS)
@example(Expression((Term("f", parameters=(("k", -0.0),)),)))
def test_an_expression_reads_back_as_itself(expression):
    again = parse(str(expression))
    assert again == expression
    assert str(again) == str(expression)
    assert all(len(term.keys) == len(term.parameters) for term in again.terms)


@given(EXPRESSIONS, st.data())
def test_space_changes_nothing(expression, data):
    tokens = tokenize(str(expression))
    spread = "".join(data.draw(SPACES) + token.text for token in tokens)
    assert parse(spread) == expression


@given(TERMS)
def test_a_term_reads_back_as_itself(term):
    assert parse(str(term)).terms == (term,)


@given(TERMS)
def test_a_call_about_labels_reads_back_as_itself(term):
    call = dataclasses.replace(term, weight=1.0, space="")
    assert parse_call(str(call), labels=True) == call


@given(TERMS)
def test_a_call_without_labels_reads_back_as_itself(term):
    call = dataclasses.replace(term, arguments=(), weight=1.0, space="")
    assert parse_call(str(call)) == call
    assert parse(str(call)).terms == (call,)


@given(st.dictionaries(NAMES, VALUES, max_size=3))
def test_values_read_back_with_their_types(parameters):
    read = dict(parse_call(str(Term("f", parameters=tuple(parameters.items())))).parameters)
    for key, value in parameters.items():
        whole = isinstance(value, float) and value.is_integer()
        assert isinstance(read[key], type(value)) or whole


@pytest.mark.parametrize(
    ("text", "weight"),
    [
        ("f", 1.0),
        ("+f", 1.0),
        ("-f", -1.0),
        ("3*f", 3.0),
        ("-3*f", -3.0),
        ("+ 3. * f", 3.0),
        (".5*f", 0.5),
        ("1e-3*f", 0.001),
        ("- 1E2 * f", -100.0),
        ("5e-324*f", 5e-324),
    ],
)
def test_weights(text, weight):
    assert [term.weight for term in parse(text).terms] == [weight]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("f(k=2)", 2.0),
        ("f(k=-2)", -2.0),
        ("f(k=+.5)", 0.5),
        ("f(k= - 1e-3)", -0.001),
        ("f(k=0)", 0),
        ("f(k=-9007199254740993)", -9007199254740993),
        ("f(k=" + "0" * 5000 + "7)", 7),
        ("f(k=exact)", "exact"),
        ("f(k=_1)", "_1"),
        ("f(k=looks.leg)", "looks.leg"),
        ('f(k="looks.leg")', "looks.leg"),
        ("f(k=a.none)", "a.none"),
        ('f(k="exact")', "exact"),
        ('f( k = "two words" )', "two words"),
        ('f(k="1.5")', "1.5"),
        ('f(k="")', ""),
        (r'f(k="a\"b\\")', 'a"b\\'),
        ('f(k="ê / { } ..")', "ê / { } .."),
        ("f(k=true)", True),
        ("f(k=false)", False),
        ("f(k=none)", None),
        ('f(k="true")', "true"),
        ('f(k="none")', "none"),
        ("f(k=0.06+-0.02)", Target(0.06, 0.02)),
        ("f(k=0.06±0.02)", Target(0.06, 0.02)),
        ("f(k = 6 +- 2)", Target(6.0, 2.0)),
        ("f(k= - .5 ± 1e-3 )", Target(-0.5, 0.001)),
        ("f(k=+1e2+-5)", Target(100.0, 5.0)),
        ("f(k=0+-5e-324)", Target(0.0, 5e-324)),
        ('f(k="0.06+-0.02")', "0.06+-0.02"),
    ],
)
def test_values_of_parameters(text, value):
    assert parse(text).terms[0].parameters == (("k", value),)


@given(TARGETS)
def test_a_target_reads_back_as_itself(target):
    again = parse_target(str(target))
    assert again == target
    assert str(again) == str(target)
    assert parse(f"f(k={str(target).replace('+-', ' ± ')})") == parse(f"f(k={target})")


@pytest.mark.parametrize(
    ("reason", "text", "carets"),
    [
        ("expected a target such as 0.06+-0.02", "0.06", "^"),
        ("expected a target such as 0.06+-0.02", "small", "^"),
        ("expected a number or a word, found the end", "", "^"),
        ("expected the end, found ','", "1+-2, 3", "    ^"),
        ("expected the end, found '+-'", "1+-2+-3", "    ^^"),
    ],
)
def test_mistakes_in_a_target_by_itself(reason, text, carets):
    with pytest.raises(ExpressionError) as caught:
        parse_target(text)
    error = caught.value
    assert (error.reason, error.start, error.stop) == (reason, carets.index("^"), len(carets))


def test_an_empty_pair_of_parentheses_is_none():
    assert parse("f()") == parse("f") == parse("f( )")


def test_a_star_between_a_number_and_a_name_multiplies_and_inside_parentheses_is_a_glob():
    (term,) = parse("10*narrow(leg*, *, 1*)").terms
    assert term.weight == 10
    assert [argument.pattern for argument in term.arguments] == ["leg*", "*", "1*"]
    assert all(argument.is_glob for argument in term.arguments)


def test_lines_of_a_toml_string_are_one_expression():
    assert parse("\n3*narrow(handle)\n  + convex_parts\n") == parse("3*narrow(handle)+convex_parts")


# Each text is followed by a line with a caret under each offending character.
MISTAKES = [
    ("the expression is empty; write a term", "", "^"),
    ("the expression is empty; write a term", "   ", "^"),
    ("expected the name of an objective, found the end", "-", " ^"),
    ("expected the name of an objective, found the end", "3*", "  ^"),
    ("expected the name of an objective, found the end", "f +", "   ^"),
    ("expected the name of an objective, found '+'", "f + + g", "    ^"),
    ("expected the name of an objective, found '-'", "--f", " ^"),
    ("expected the name of an objective, found '-'", "3*-f", "  ^"),
    ("expected the name of an objective, found '3'", "3*3*f", "  ^"),
    ("expected the name of an objective, found '3d'", "2*3d(a)", "  ^^"),
    ("expected the name of an objective, found '1e'", "1e*f", "^^"),
    ("expected the name of an objective, found '*'", "*f", "^"),
    ("expected the name of an objective, found '('", "(a)", "^"),
    ("expected the name of an objective, found ':'", ":f(a)", "^"),
    ("expected the name of an objective, found ','", ",", "^"),
    ("expected a name after ':', found the end", "basic:", "      ^"),
    ("expected a name after ':', found '('", "basic:(a)", "      ^"),
    ("expected a name after ':', found '2'", "basic:2", "      ^"),
    ("expected '*', found 'narrow'", "3 narrow(a)", "  ^^^^^^"),
    ("expected '*', found the end", "3", " ^"),
    ("expected '*', found '('", "3(a)", " ^"),
    ("expected '+' or '-', found 'g'", "f g", "  ^"),
    ("expected '+' or '-', found '3'", "f(a) 3*g", "     ^"),
    ("expected '+' or '-', found '*'", "f*3", " ^"),
    ("expected '+' or '-', found ')'", "f(a))", "    ^"),
    ("expected '+' or '-', found '='", "f = 3", "  ^"),
    ("expected '+' or '-', found ':'", "a:b:c", "   ^"),
    ("expected '+' or '-', found ','", "f, g", " ^"),
    ("expected ',' or ')', found the end", "f(a", "   ^"),
    ("expected ',' or ')', found the end", "f(a  ", "     ^"),
    ("expected ',' or ')', found 'b'", "f(a b)", "    ^"),
    ("expected ',' or ')', found 'long'", "f(k=1 long)", "      ^^^^"),
    ("expected ',' or ')', found '('", "f(g(a))", "   ^"),
    ("expected ',' or ')', found ':'", "f(b:a)", "   ^"),
    ("expected a label, found the end", "f(", "  ^"),
    ("expected a label, found the end", "f(a,", "    ^"),
    ("expected a label, found ')'", "f(a, )", "     ^"),
    ("expected a label, found ','", "f(,a)", "  ^"),
    ("expected a label, found '-'", "f(-2)", "  ^"),
    ("expected a label, found '='", "f(=2)", "  ^"),
    ("expected a label, found '('", "f((a))", "  ^"),
    ("expected a number or a word, found ')'", "f(k=)", "    ^"),
    ("expected a number or a word, found 'leg*'", "f(k=leg*)", "    ^^^^"),
    ("expected a number or a word, found '1e'", "f(k=1e)", "    ^^"),
    ("expected a number, found '-'", "f(k=--1)", "     ^"),
    ("expected a number, found 'x'", "f(k=-x)", "     ^"),
    ("expected a number, found '\"1\"'", 'f(k=-"1")', "     ^^^"),
    ("expected a number or a word, found the end", "f(k=", "    ^"),
    ("expected a number or a word, found '='", "f(k==1)", "    ^"),
    ("'2k' cannot be the name of a parameter; names begin with a letter or '_'", "f(2k=1)", "  ^^"),
    ("'k*' cannot be the name of a parameter; names begin with a letter or '_'", "f(k*=1)", "  ^^"),
    ("the quote does not end; close it with another", 'f(k="a)', "    ^^^"),
    ("the quote does not end; close it with another", 'f(k="a\\")', "    ^^^^^"),
    (
        "in quotes a backslash stands before a quote or another backslash; write two for one",
        'f(k="a\\b")',
        "      ^",
    ),
    ("expected the name of an objective, found '\"f\"'", '"f"', "^^^"),
    ("parameter 'k' is given twice", "f(k=1, j=2, k=3)", "            ^"),
    ("labels come before parameters", "f(a, k=1, leg*)", "          ^^^^"),
    ("a weight of 0 leaves the term out; remove it", "f + 0.0*g", "    ^^^"),
    ("a weight of 0 leaves the term out; remove it", "-0*g", " ^"),
    ("a weight of 0 leaves the term out; remove it", "1e-999*g", "^^^^^^"),
    ("the number is too large", "1e999*g", "^^^^^"),
    ("the number is too large", "g(k=-1e400)", "     ^^^^^"),
    ("'..' is reserved for later versions", "f(leg1..leg4)", "      ^^"),
    ("'/' is reserved for later versions", "f(a)/2", "    ^"),
    ("'{' is reserved for later versions", "f({a})", "  ^"),
    ("expected '+' or '-', found '('", "f@half(a)", "      ^"),
    (
        "expected the name of a space after '@', such as original, found the end",
        "f(a) @",
        "      ^",
    ),
    ("expected the name of a space after '@', such as original, found '3'", "f(a) @ 3", "       ^"),
    ("unexpected character '.'", "f.g(a)", " ^"),
    ("expected a label, found '\"a\"'", 'f("a")', "  ^^^"),
    ("unexpected character 'ê'", "f(tête)", "   ^"),
    ("unexpected character '.'", "f(k=1.2.3)", "     ^"),
    (
        "the spread of a target must be positive; write how far from 0.06 is still usual",
        "f(k=0.06+-0.0)",
        "          ^^^",
    ),
    (
        "the spread of a target must be positive; write how far from -1 is still usual",
        "f(k=-1±1e-999)",
        "       ^^^^^^",
    ),
    (
        "expected the spread of a target after '+-', a positive number, found '-'",
        "f(k=1+--2)",
        "       ^",
    ),
    (
        "expected the spread of a target after '±', a positive number, found ')'",
        "f(k=1±)",
        "      ^",
    ),
    (
        "expected the spread of a target after '+-', a positive number, found the end",
        "f(k=1+-",
        "       ^",
    ),
    ("the number is too large", "f(k=1+-1e400)", "       ^^^^^"),
    ("expected ',' or ')', found '+-'", "f(k=1+-2+-3)", "        ^^"),
    ("expected ',' or ')', found '+'", "f(k=1+ -2)", "     ^"),
    ("expected ',' or ')', found '±'", "f(k=few±2)", "       ^"),
    ("expected a number or a word, found '±'", "f(k=±2)", "    ^"),
    ("expected '*', found '+-'", "3+-f", " ^^"),
    ("expected '+' or '-', found '±'", "f ± g", "  ^"),
]


@pytest.mark.parametrize(("reason", "text", "carets"), MISTAKES, ids=[m[1] for m in MISTAKES])
def test_every_mistake_is_named_with_its_place(reason, text, carets):
    with pytest.raises(ExpressionError) as caught:
        parse(text)
    error = caught.value
    assert error.reason == reason
    assert error.text == text
    assert (error.start, error.stop) == (carets.index("^"), len(carets))
    assert str(error).splitlines()[1:] == [f"  {text}", f"  {carets}"]
    assert error.exit_code == 2


@pytest.mark.parametrize("gap", ["\n", "\n  ", "\r\n", "\n\n"])
def test_the_caret_is_under_the_mistake_in_a_text_of_several_lines(gap):
    text = f"narrow(a){gap}+ flat(b wide)"
    with pytest.raises(ExpressionError) as caught:
        parse(text)
    error = caught.value
    assert text[error.start : error.stop] == "wide"
    *_, above, carets = str(error).splitlines()
    assert above[carets.index("^") : carets.rindex("^") + 1] == "wide"
    assert len(str(error).splitlines()) == 3


def expression_or_error(text: str) -> Expression | ExpressionError:
    try:
        return parse(text)
    except ExpressionError as error:
        return error


ALPHABET = st.sampled_from(
    [*'ab13.e*+-±(),=:_ "\\', "+-", "..", "leg*", "k=", "1e5", "f(", "\n", "@"]
)


@given(st.one_of(st.text(), st.lists(ALPHABET, max_size=14).map("".join)))
@example("f(" * 500)
@example("-" * 500)
@example("1" * 5000 + "*f")
@example("\ud800")
@example("f(a)\0")
def test_any_text_either_reads_or_is_refused_with_a_place(text):
    found = expression_or_error(text)
    if isinstance(found, ExpressionError):
        assert 0 <= found.start < found.stop
        assert found.start <= len(text)
        assert found.stop <= len(text) + 1
        assert found.reason.partition("; ")[0] in str(found)
    else:
        assert found.terms
        assert parse(str(found)) == found


@given(st.one_of(st.text(), st.lists(ALPHABET, max_size=14).map("".join)))
def test_any_text_is_a_call_or_refused(text):
    try:
        term = parse_call(text)
    except ExpressionError:
        return
    assert term.weight == 1
    assert term.arguments == ()
    assert parse_call(term.call) == term


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').mkdir('made')",
        "exec('import os')",
        "f(k=__import__('os'))",
        "().__class__",
        "[].append(1)",
        "lambda: 0",
        "f(a); import os",
        "f(k=2**9**9)",
        "f(a) if f else g",
    ],
)
def test_python_is_not_run(text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ExpressionError):
        parse(text)
    assert list(tmp_path.iterdir()) == []


def test_the_language_is_read_without_evaluating_anything():
    forbidden = {"eval", "exec", "compile", "__import__", "literal_eval"}
    (folder,) = moseg_core.language.__path__
    sources = sorted(Path(folder).glob("*.py"))
    assert len(sources) >= 4
    for source in sources:
        names = {n.id for n in ast.walk(ast.parse(source.read_text())) if isinstance(n, ast.Name)}
        assert not names & forbidden, source


@pytest.mark.parametrize(
    ("text", "name", "parameters"),
    [
        ("kmeans", "kmeans", ()),
        ("core:kmeans", "core:kmeans", ()),
        (" kmeans ( ) ", "kmeans", ()),
        ("search(expansion=2, limit=-1e3)", "search", (("expansion", 2.0), ("limit", -1000.0))),
    ],
)
def test_calls(text, name, parameters):
    term = parse_call(text)
    assert (term.name, term.parameters, term.arguments, term.weight) == (name, parameters, (), 1.0)


WITHOUT_LABELS = 'expected key=value; words with other characters stand in quotes: key="a,b"'


@pytest.mark.parametrize(
    ("reason", "text", "carets"),
    [
        (WITHOUT_LABELS, "kmeans(rounds)", "       ^^^^^^"),
        (WITHOUT_LABELS, "kmeans(5)", "       ^"),
        (WITHOUT_LABELS, "kmeans(*)", "       ^"),
        (WITHOUT_LABELS, "greedy(order=a, b)", "                ^"),
        ("expected key=value, found '\"a\"'", 'kmeans("a")', "       ^^^"),
        ("expected the end, found '@'", "kmeans @ mds", "       ^"),
        ("expected the end, found '+'", "kmeans + given", "       ^"),
        ("expected the end, found 'given'", "kmeans given", "       ^^^^^"),
    ],
)
def test_mistakes_in_calls(reason, text, carets):
    with pytest.raises(ExpressionError) as caught:
        parse_call(text)
    error = caught.value
    assert error.reason == reason
    assert (error.start, error.stop) == (carets.index("^"), len(carets))


@pytest.mark.parametrize("text", ["", "3*kmeans", "-kmeans", "(a)"])
def test_a_call_is_not_said_to_be_an_objective(text):
    with pytest.raises(ExpressionError, match=r"^expected ") as caught:
        parse_call(text)
    assert caught.value.start == 0
    assert "objective" not in caught.value.reason
