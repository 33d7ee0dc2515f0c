"""Names to objectives, labels and parameters; each mistake with its place and advice."""

from __future__ import annotations

import pickle
import sys
import types
from collections.abc import Sequence
from typing import Annotated

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.components.objectives import Traits, objective
from moseg_core.components.parameters import Interval
from moseg_core.components.part import Part
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import ExpressionError, PluginError, UsageError
from moseg_core.language import Argument, Expression, Table, Target, Term, parse
from moseg_core.problem.binding import bind

LABELS = ("head", "body", "leg1", "leg2", "leg10", "Leg3")


@objective(range=(0, 1))
def thin(
    part: Part,
    *,
    power: Annotated[float, Interval(1, 4)] = 2.0,
    count: Annotated[int, Interval(1)] = 1,
) -> float:
    return 0.0


@objective(range=(0, 1), vectorized=lambda parts: 0.0 * parts.areas)
def nothing(part: Part) -> float:
    return 0.0


@objective(range=(0, 1), cost="moderate")
def across(first: Part, second: Part) -> float:
    return 0.0


@objective(range=(0, 1), cost="expensive")
def alike(parts: Sequence[Part]) -> float:
    return 0.0


@objective(range=(0, 1))
def filled(segmentation: Segmentation) -> float:
    return 0.0


@objective(range=(0, 1))
def tube(part: Part, *, radius: float, wall: float) -> float:
    return 0.0


@objective(range=(0, 1))
def like(
    part: Part, *, kind: str = "tube", strict: bool = False, most: float | None = 1.0
) -> float:
    return 0.0


@objective(range=(0, float("inf")))
def sized(
    part: Part,
    *,
    area: Annotated[Target | None, Interval(0, 1)] = None,
    height: Target | None = None,
) -> float:
    return 0.0


@objective(range=(0, 1))
def likely(part: Part, *, kind: str, among: Table, count: int = 1) -> float:
    return 0.0


def share_of_sized(given):
    if given.get("length") == Target(1, 1):
        raise UsageError("length=1+-1 goes with nothing")
    return given["area"].value if "area" in given else None


@objective(range=(0, float("inf")), share=share_of_sized)
def grown(
    part: Part, *, area: Target | None = Target(0.5, 0.1), length: Target | None = None
) -> float:
    return 0.0


class Fifth:
    """An objective of a class of its own."""

    traits = Traits(arity="nary", most=3, share=lambda given: 0.2)
    parameters = ()

    def __call__(self, parts, /):
        return 0.0


OWN = {
    **{"thin": thin, "like": like, "across": across, "alike": alike, "filled": filled},
    **{"tube": tube, "sized": sized, "likely": likely, "grown": grown, "fifth": Fifth()},
}


def installed(*ids: str, target: str = "home_of_objectives:thin") -> Registry:
    """A registry of objectives with the given ids."""
    bundles = []
    for bundle in dict.fromkeys(name.partition(":")[0] for name in ids):
        components = tuple(
            Component(bundle, f"moseg-{bundle} 1.0", ObjectiveSpec(name=name, target=target))
            for name in (n.partition(":")[2] for n in ids if n.startswith(f"{bundle}:"))
        )
        bundles.append(Bundle(bundle, f"moseg-{bundle}", "1.0", bundle, components))
    return Registry(bundles)


@pytest.fixture
def home(monkeypatch) -> types.ModuleType:
    """The module that the targets of :func:`installed` are in."""
    module = types.ModuleType("home_of_objectives")
    module.thin = thin
    monkeypatch.setitem(sys.modules, module.__name__, module)
    return module


def bound(text: str, registry: Registry = Registry(()), labels: Sequence[str] = LABELS):  # noqa: B008
    return bind(parse(text), labels, OWN, registry)


def refusal(text: str, registry: Registry = Registry(()), labels: Sequence[str] = LABELS):  # noqa: B008
    """(message without carets, the text that the carets stand under)."""
    with pytest.raises(ExpressionError) as caught:
        bound(text, registry, labels)
    error = caught.value
    assert error.text == text
    return str(error).splitlines()[0], text[error.start : error.stop]


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("thin(head)", ((0,),)),
        ("thin(head, body)", ((0,), (1,))),
        ("thin(body, head)", ((1,), (0,))),
        ("thin(leg*)", ((2,), (3,), (4,))),
        ("thin(*)", ((0,), (1,), (2,), (3,), (4,), (5,))),
        ("thin(leg*, head)", ((2,), (3,), (4,), (0,))),
        ("thin(head, leg*)", ((0,), (2,), (3,), (4,))),
        ("thin(*eg*)", ((2,), (3,), (4,), (5,))),
        ("thin(*1*)", ((2,), (4,))),
        ("thin(leg1*)", ((2,), (4,))),
        ("thin(l*1)", ((2,),)),
        ("thin(head*)", ((0,),)),
        ("across(head, body)", ((0, 1),)),
        ("across(body, head)", ((1, 0),)),
        ("across(leg1*)", ((2, 4),)),
        ("alike(leg*)", ((2, 3, 4),)),
        ("alike(Leg3, leg*)", ((5, 2, 3, 4),)),
        ("filled", ((),)),
        ("filled()", ((),)),
    ],
)
def test_calls(text, calls):
    (term,) = bound(text)
    assert term.calls == calls


def test_labels_are_matched_with_their_case():
    assert bound("thin(L*)")[0].calls == ((5,),)
    message, place = refusal("thin(LEG*)")
    assert place == "LEG*"
    assert message.startswith("'LEG*' matches none of the labels head, body, leg1, leg2, leg10, Le")


def test_a_bound_term_knows_where_it_comes_from():
    first, second = bound("-3*thin(head, power=3) + alike(leg*)")
    assert (first.id, first.distribution, first.objective) == (
        "python:thin",
        "the calling program",
        thin,
    )
    assert (first.weight, first.parameters) == (-3.0, {"power": 3.0})
    assert (first.cost_rank, second.cost_rank) == (0, 2)
    assert second.parameters == {}


def test_what_values_are_remembered_under_tells_objectives_and_parameters_apart():
    terms = bound(
        "thin(head) + thin(head, power=3) + thin(head, power=3, count=2)"
        " + thin(body, count=2, power=3) + across(head, body)"
    )
    keys = [term.memo_key for term in terms]
    assert keys[2] == keys[3]
    assert len(set(keys)) == 4


def test_parameters_come_in_their_declared_types():
    (term,) = bound("thin(head, count=3, power=2)")
    assert term.parameters == {"count": 3, "power": 2.0}
    assert [type(term.parameters[key]) for key in ("count", "power")] == [int, float]


def test_a_parameter_may_be_a_target():
    first, second, third = bound(
        "sized(leg*, area=0.06+-0.02) + sized(head, height=-5±1, area=0.06±0.02)"
        " + sized(head, area=0.06+-0.03)"
    )
    assert first.parameters == {"area": Target(0.06, 0.02)}
    assert second.parameters == {"height": Target(-5, 1), "area": Target(0.06, 0.02)}
    assert str(second.term) == "sized(head, height=-5+-1, area=0.06+-0.02)"
    keys = {first.memo_key, second.memo_key, third.memo_key}
    assert len(keys) == 3
    assert bound("sized(body, area = 0.06 ± 0.02)")[0].memo_key in keys


@pytest.mark.parametrize(
    ("text", "message", "place"),
    [
        (
            "sized(head, area=0.06)",
            "'sized': parameter 'area' must be a target, not 0.06 in \"sized(head, area=0.06)\";"
            " write 0.06+-0.02: a typical value and how far from it is still usual",
            "area",
        ),
        (
            "sized(head, area=1.5+-1)",
            "'sized': parameter 'area' is 1.5 in \"sized(head, area=1.5+-1)\"; allowed is 0 to 1",
            "area",
        ),
        (
            "thin(head, power=2+-1)",
            "'thin': parameter 'power' must be a number, not the target 2+-1 in"
            ' "thin(head, power=2+-1)"',
            "power",
        ),
    ],
)
def test_targets_are_told_from_numbers(text, message, place):
    assert refusal(text) == (message, place)


TABLES = Table(
    {
        "leg": {"area": "0.06+-0.02", "height": "5+-1"},
        "looks": {"leg": {"bias": -1.5}, "among": "looks"},
        "learned": {"among": "looks", "kind": "leg", "count": 2},
        "wrong": {"aera": "0.06+-0.02"},
        "wide": {"area": "6+-2"},
    }
)


def bound_with_tables(text: str, tables: Table = TABLES):
    return bind(parse(text), LABELS, OWN, Registry(()), tables=tables)


def test_a_call_takes_parameters_from_a_table():
    plain, own, path = bound_with_tables(
        "sized(leg*, given=leg) + sized(leg*, height=7+-1, given=leg, area=none)"
        " + likely(head, given=learned)"
    )
    assert plain.parameters == {"area": Target(0.06, 0.02), "height": Target(5, 1)}
    assert own.parameters == {"area": None, "height": Target(7, 1)}
    assert path.parameters == {"kind": "leg", "among": TABLES["looks"], "count": 2}
    assert str(plain.term) == "sized(leg*, given=leg)"
    (said,) = bound_with_tables("sized(head, area=0.06+-0.02, height=5+-1)")
    assert said.memo_key == plain.memo_key
    assert said.memo_key != own.memo_key


def test_the_name_of_a_table_stands_for_it():
    one, inner = bound_with_tables(
        "likely(leg*, kind=leg, among=looks) + likely(leg*, kind=leg, among=looks.leg)"
    )
    assert one.parameters == {"kind": "leg", "among": TABLES["looks"]}
    assert inner.parameters["among"] == Table({"bias": -1.5})
    other = Table({"looks": {"leg": {"bias": -1.0}, "among": "looks"}})
    (changed,) = bound_with_tables(one.term.call, other)
    (same,) = bound_with_tables(one.term.call, Table(TABLES.document()))
    assert one.memo_key == same.memo_key
    assert one.memo_key != changed.memo_key


def test_a_share_follows_from_a_table():
    tables = Table({"leg": {"area": "0.06+-0.02"}})
    assert bound_with_tables("grown(leg*, given=leg)", tables)[0].expected_share == 0.06


@pytest.mark.parametrize(
    ("text", "reason", "advice", "place"),
    [
        ("sized(leg1, given=lge)", "unknown table 'lge'", "did you mean 'leg'?", "given"),
        ("likely(leg1, among=loks)", "unknown table 'loks'", "did you mean 'looks'?", "among"),
        (
            "sized(leg1, given=wrong)",
            "table 'wrong' for 'sized': unknown parameter 'aera'",
            "did you mean 'area'?",
            "given",
        ),
        (
            "sized(leg1, given=wide)",
            "table 'wide' for 'sized': parameter 'area' is 6",
            "allowed is 0 to 1",
            "given",
        ),
        (
            "sized(leg1, given=3)",
            "the name of a table is a word, not 3",
            "write given=leg",
            "given",
        ),
        (
            "likely(leg1, kind=leg, among=3)",
            "'likely': parameter 'among' must be a table, not 3",
            "name one of the recipe's tables: among=looks",
            "among",
        ),
    ],
)
def test_mistakes_about_tables(text, reason, advice, place):
    with pytest.raises(ExpressionError) as caught:
        bound_with_tables(text)
    error = caught.value
    assert str(error).splitlines()[0] == f'{reason} in "{text}"; {advice}'
    assert error.text[error.start : error.stop] == place


def test_without_tables_it_is_said_how_to_write_one():
    message, place = refusal("sized(leg1, given=leg)")
    assert place == "given"
    assert message.endswith("; write one into the recipe: [given.leg]")


@pytest.mark.parametrize(
    ("text", "share"),
    [
        ("grown(head, area=0.06+-0.02)", 0.06),
        ("3*grown(head, area=1+-0.02)", 1.0),
        ("grown(head)", None),  # the function is asked with what the call gives, no defaults
        ("grown(head, length=2+-1)", None),
        ("-grown(head, area=0.06+-0.02)", None),  # a low value is not wanted
        ("thin(head)", None),
        ("fifth(head, body)", 0.2),
    ],
)
def test_the_share_that_a_term_expects(text, share):
    (term,) = bound(text)
    assert term.expected_share == share


def test_an_objective_that_fails_to_say_which_share_it_expects_is_named():
    for area, found in (("0+-1", "0.0"), ("1.5+-1", "1.5")):
        (term,) = bound(f"grown(head, area={area})")
        with pytest.raises(PluginError) as caught:
            _ = term.expected_share
        assert str(caught.value) == (
            "objective 'python:grown' of the calling program failed to say which share of the area"
            f" it expects in 'grown(head, area={area})': ValueError: a share is a number above 0"
            f" and at most 1, or None, not {found}; report it to its authors, or do without it"
        )
    (term,) = bound("grown(head, area=none)")
    with pytest.raises(PluginError, match=r"'grown\(head, area=none\)': AttributeError"):
        _ = term.expected_share
    (term,) = bound("grown(head, length=1+-1)")
    with pytest.raises(UsageError, match=r"in 'grown\(head, length=1\+-1\)': length=1\+-1 goes"):
        _ = term.expected_share


def field_of_shown(given):
    if given.get("k") == 2:
        raise UsageError("k=2 goes with nothing")
    return "made:shown", {} if given["k"] == 3 else given


@objective(range=(0, 1), mean_of=field_of_shown)
def shown(part: Part, *, k: float = 0.0) -> float:
    return 0.0


def test_a_term_says_which_field_it_is_the_mean_of():
    def term(text):
        return bind(parse(text), LABELS, {"shown": shown, "thin": thin}, Registry(()))[0]

    assert term("-2*shown(leg*, k=1)").averaged_field == ("made:shown", {"k": 1})
    assert term("shown(head, k=3)").averaged_field == ("made:shown", {})
    assert term("thin(head)").averaged_field is None
    with pytest.raises(UsageError, match=r"in 'shown\(head, k=2\)': k=2 goes with nothing"):
        _ = term("shown(head, k=2)").averaged_field
    with pytest.raises(PluginError) as caught:
        _ = term("shown(head)").averaged_field
    assert str(caught.value).startswith(
        "objective 'python:shown' of the calling program failed to say of which field 'shown(head)'"
        " is the mean: KeyError"
    )


@pytest.mark.parametrize(
    ("text", "takes", "given_count"),
    [
        ("thin", "one label, or several to be summed", "none"),
        ("thin()", "one label, or several to be summed", "none"),
        ("thin(power=2)", "one label, or several to be summed", "none"),
        ("across", "exactly 2 labels", "none"),
        ("across(head)", "exactly 2 labels", "1"),
        ("across(leg*)", "exactly 2 labels", "3"),
        ("alike", "2 labels or more", "none"),
        ("alike(leg1)", "2 labels or more", "1"),
        ("filled(head)", "no labels", "1"),
        ("filled(*)", "no labels", "6"),
    ],
)
def test_a_wrong_number_of_labels(text, takes, given_count):
    name = text.partition("(")[0]
    message, place = refusal(text)
    assert message == f"'{name}' takes {takes}, not {given_count} in \"{text}\""
    assert place == name


@pytest.mark.parametrize(
    ("text", "reason", "advice", "place"),
    [
        ("thinn(head)", "unknown objective 'thinn'", "did you mean 'thin'?", "thinn"),
        ("filled + acros(a, b)", "unknown objective 'acros'", "did you mean 'across'?", "acros"),
        ("thin(heat)", "unknown label 'heat'", "did you mean 'head'?", "heat"),
        ("thin(Head)", "unknown label 'Head'", "did you mean 'head'?", "Head"),
        (
            "thin(x)",
            "unknown label 'x'",
            "known: Leg3, body, head, leg1, leg10, leg2",
            "x",
        ),
        (
            "head",
            "'head' is a label, not an objective",
            "write objective(head)",
            "head",
        ),
        (
            "thin(head, pover=3)",
            "'thin': unknown parameter 'pover'",
            "did you mean 'power'?",
            "pover",
        ),
        (
            "filled(size=3)",
            "'filled': unknown parameter 'size'",
            "known: none",
            "size",
        ),
        (
            "thin(head, count=2, power=5)",
            "'thin': parameter 'power' is 5",
            "allowed is 1 to 4",
            "power",
        ),
    ],
)
def test_unknown_names_and_values(text, reason, advice, place):
    assert refusal(text) == (f'{reason} in "{text}"; {advice}', place)


@pytest.mark.parametrize(
    ("text", "message", "place"),
    [
        ("thin(head, count=1.5)", "'thin': parameter 'count' must be whole, not 1.5", "count"),
        ("tube(head, wall=1)", "'tube': parameter 'radius' is missing", "tube"),
        ("tube(head)", "'tube': parameter 'radius' is missing", "tube"),
        ("thin(head, head)", "label 'head' is given twice to 'thin'", "head"),
        ("thin(leg1, leg*)", "label 'leg1' is given twice to 'thin'", "leg*"),
        ("thin(leg*, leg2)", "label 'leg2' is given twice to 'thin'", "leg2"),
        ("thin(*, *)", "label 'head' is given twice to 'thin'", "*"),
        ("alike(leg1, leg1)", "label 'leg1' is given twice to 'alike'", "leg1"),
        (
            "thin(arm*)",
            "'arm*' matches none of the labels head, body, leg1, leg2, leg10, Leg3",
            "arm*",
        ),
    ],
)
def test_other_mistakes(text, message, place):
    assert refusal(text) == (f'{message} in "{text}"', place)


def test_the_caret_is_under_the_repetition():
    with pytest.raises(ExpressionError) as caught:
        bound("thin(head, body, head)")
    assert caught.value.start == 17


def test_required_parameters_are_among_the_suggestions():
    message, place = refusal("tube(head, radus=1, wall=2)")
    assert place == "radus"
    assert message.endswith("did you mean 'radius'?")


def test_required_parameters_can_be_given_in_any_order():
    (term,) = bound("tube(head, wall=1, radius=2)")
    assert term.parameters == {"wall": 1.0, "radius": 2.0}


def test_an_expression_made_in_python_is_bound_like_its_text():
    made = Expression((Term("thin", (Argument("leg*"),), (("power", 3.0),), 2.0),))
    (term,) = bind(made, LABELS, OWN, Registry(()))
    assert (term.calls, term.parameters) == (((2,), (3,), (4,)), {"power": 3.0})


def test_a_mistake_in_an_expression_made_in_python_quotes_its_text():
    made = Expression((Term("thin", (Argument("x"),), weight=2.0),))
    with pytest.raises(ExpressionError, match=r'unknown label \'x\' in "2\*thin\(x\)"'):
        bind(made, LABELS, OWN, Registry(()))


def test_installed_objectives_are_found_by_name_and_by_id(home):
    registry = installed("basic:slim", "other:slim", "other:wide")
    (term,) = bound("wide(head)", registry)
    assert (term.id, term.distribution) == ("other:wide", "moseg-other 1.0")
    assert term.objective is thin
    assert bound("basic:slim(head)", registry)[0].id == "basic:slim"
    assert bound("other : slim(head)", registry)[0].id == "other:slim"


def test_objectives_of_the_program_come_first(home):
    registry = installed("basic:thin")
    assert bound("thin(head)", registry)[0].id == "python:thin"
    assert bound("basic:thin(head)", registry)[0].id == "basic:thin"


def test_an_ambiguous_name_is_answered_with_the_ids(home):
    registry = installed("basic:slim", "other:slim")
    message, place = refusal("3*slim(head)", registry)
    assert place == "slim"
    assert message == (
        "objective 'slim' is ambiguous in \"3*slim(head)\"; say which: basic:slim, other:slim"
    )


def test_an_ambiguous_name_is_ambiguous_also_where_the_program_has_a_similar_one(home):
    message, _ = refusal("thinn(head)", installed("basic:thinn", "other:thinn"))
    assert "is ambiguous" in message
    assert "basic:thinn, other:thinn" in message


def test_suggestions_come_from_the_program_and_from_what_is_installed(home):
    registry = installed("basic:slim")
    assert refusal("slime(head)", registry)[0].endswith("did you mean 'slim'?")
    assert refusal("thinn(head)", registry)[0].endswith("did you mean 'thin'?")
    message, _ = refusal("xyz(head)", registry, ())
    assert message.startswith("unknown objective 'xyz'")


def test_a_suggestion_for_an_id_is_an_id(home):
    registry = installed("basic:slim", "other:wide")
    message, place = refusal("basic:slime(head)", registry)
    assert message.endswith("did you mean 'basic:slim'?")
    assert place == "basic:slime"


def test_an_objective_of_a_bundle_that_is_set_aside_gives_the_reason():
    broken = Bundle("broken", "moseg-broken", "2.1", "broken", problem="moseg-broken 2.1: it fell")
    with pytest.raises(
        PluginError, match=r"'broken:f' is not available.*moseg-broken 2\.1: it fell"
    ):
        bound("broken:f(head)", Registry((broken,)))


def test_an_unknown_objective_mentions_what_is_set_aside():
    broken = Bundle("broken", "moseg-broken", "2.1", "broken", problem="moseg-broken 2.1: it fell")
    message, _ = refusal("f(head)", Registry((broken,)))
    assert message.endswith("(set aside, see 'moseg plugin list': broken)")


def test_something_else_than_an_objective_is_refused_with_its_distribution(home):
    home.thin = lambda part: 0.0
    with pytest.raises(PluginError) as caught:
        bound("basic:slim(head)", installed("basic:slim"))
    message = str(caught.value)
    assert "'basic:slim' of moseg-basic 1.0" in message
    assert "@moseg_core.objective" in message
    assert "\n" not in message


def test_a_target_that_cannot_be_loaded_is_refused_with_its_distribution(home):
    with pytest.raises(PluginError, match=r"'basic:slim' of moseg-basic 1\.0 cannot be loaded"):
        bound("slim(head)", installed("basic:slim", target="home_of_objectives:gone"))


def test_only_the_objectives_that_are_asked_for_are_loaded(home):
    both = (*installed("basic:slim").bundles, *installed("bad:x", target="nowhere:f").bundles)
    assert bound("slim(head)", Registry(both))[0].id == "basic:slim"


class Handmade:
    """An objective without the decorator."""

    traits = thin.traits
    parameters = ()

    def __call__(self, part: Part) -> float:
        return 0.5


def test_an_objective_is_whatever_answers_the_protocol(home):
    home.thin = Handmade()
    assert bound("slim(head)", installed("basic:slim"))[0].objective is home.thin


@pytest.mark.parametrize(
    ("given", "parameters"),
    [
        ("kind=cone", {"kind": "cone"}),
        ('kind="two words, \\"1.5\\""', {"kind": 'two words, "1.5"'}),
        ("strict=true, kind=tube", {"strict": True, "kind": "tube"}),
        ("strict=0", {"strict": False}),
        ("most=none", {"most": None}),
        ("most=2", {"most": 2.0}),
    ],
)
def test_parameters_are_numbers_or_words_as_the_objective_declares(given, parameters):
    (term,) = bound(f"like(head, {given})")
    assert term.parameters == parameters
    (again,) = bound(str(term.term))
    assert again.parameters == parameters


@pytest.mark.parametrize(
    ("text", "message", "place"),
    [
        ("thin(head, power=fast)", "parameter 'power' must be a number, not 'fast'", "power"),
        ("like(head, kind=3)", 'must be a word, not 3; in quotes it is one: kind="3"', "kind"),
        ("like(head, strict=maybe)", "must be true or false, not 'maybe'", "strict"),
    ],
)
def test_values_of_another_type_are_pointed_at(text, message, place):
    with pytest.raises(ExpressionError) as caught:
        bound(text)
    assert message in caught.value.reason
    assert text[caught.value.start : caught.value.stop] == place


NAMES = st.lists(
    st.from_regex(r"[a-c]{1,2}[0-9]?", fullmatch=True), min_size=1, max_size=6, unique=True
)


@given(NAMES, st.data())
def test_arguments_are_matched_as_a_reader_would(labels, data):
    patterns = data.draw(
        st.lists(st.from_regex(r"[a-c0-9*]{1,3}", fullmatch=True), min_size=1, max_size=3)
    )
    expected: list[int] = []
    for pattern in patterns:
        expected += [k for k, label in enumerate(labels) if matches(pattern, label)]
    complete = all(any(matches(pattern, label) for label in labels) for pattern in patterns)
    text = f"thin({', '.join(patterns)})"
    if complete and len(set(expected)) == len(expected):
        assert bound(text, labels=labels)[0].calls == tuple((k,) for k in expected)
    else:
        with pytest.raises(UsageError):
            bound(text, labels=labels)


def matches(pattern: str, label: str) -> bool:
    """Whether a pattern with stars fits a label, letter by letter."""
    if not pattern:
        return not label
    if pattern[0] == "*":
        return any(matches(pattern[1:], label[k:]) for k in range(len(label) + 1))
    return label[:1] == pattern[0] and matches(pattern[1:], label[1:])


def reading(fields):
    @objective(fields=fields)
    def read(part: Part, *, what: str = "height") -> float:
        return 0.0

    return read


def term_that_reads(fields, text="read(head)"):
    (term,) = bind(parse(text), LABELS, {"read": reading(fields)}, Registry(()))
    return term


def test_a_term_says_which_fields_it_reads():
    assert term_that_reads(()).fields == ()
    assert term_that_reads(["basic:height", "basic:thickness"]).fields == (
        "basic:height",
        "basic:thickness",
    )


def test_fields_may_depend_on_the_parameters_of_the_call():
    def named(parameters):
        return [f"basic:{parameters.get('what', 'height')}"]

    assert term_that_reads(named).fields == ("basic:height",)
    assert term_that_reads(named, "read(head, what=thickness)").fields == ("basic:thickness",)


@pytest.mark.parametrize(
    ("names", "says"),
    [
        (lambda parameters: parameters["where"], "failed to name its fields: KeyError"),
        (lambda parameters: "basic:height", "in a tuple, not 'basic:height'"),
        (lambda parameters: [1], r"in a tuple, not \[1\]"),
    ],
)
def test_an_objective_that_cannot_name_its_fields_is_blamed(names, says):
    with pytest.raises(PluginError, match=f"objective 'python:read' of .*{says}"):
        _ = term_that_reads(names).fields


def test_fields_may_refuse_the_parameters_of_the_call():
    def named(parameters):
        raise UsageError("there is no 'thicknes'")

    with pytest.raises(UsageError, match=r"in 'read\(head\)': there is no 'thicknes'"):
        _ = term_that_reads(named, "read(head)").fields


def test_a_term_can_be_pickled_after_its_vectorised_form_was_looked_at():
    (term,) = bind(parse("nothing(head)"), LABELS, {"nothing": nothing}, Registry(()))
    assert term.vectorized is nothing.traits.vectorized
    assert pickle.loads(pickle.dumps(term)).vectorized is nothing.traits.vectorized
    (term,) = bind(parse("thin(head)"), LABELS, {"thin": thin}, Registry(()))
    assert term.vectorized is None
