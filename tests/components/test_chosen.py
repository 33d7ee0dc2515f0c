"""Choices of components: how they are written, found, checked and made."""

from __future__ import annotations

import functools
import math
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.discovery.registry import registry
from moseg_core.errors import ExpressionError, PluginError, ShapeError, UsageError
from moseg_core.language import Target


@pytest.mark.parametrize(
    ("given_choice", "name", "parameters"),
    [
        ("kmeans", "kmeans", {}),
        (" core:kmeans ( rounds = 5 ) ", "core:kmeans", {"rounds": 5.0}),
        ("search(a=1e-3, b=-2)", "search", {"a": 0.001, "b": -2.0}),
        ({"name": "kmeans"}, "kmeans", {}),
        ({"name": "kmeans", "rounds": 5, "mode": "fast"}, "kmeans", {"rounds": 5, "mode": "fast"}),
        (Choice("kmeans", {"rounds": 5}), "kmeans", {"rounds": 5}),
    ],
)
def test_a_choice_is_a_text_a_table_or_a_choice(given_choice, name, parameters):
    choice = Choice.read(given_choice, "seeder")
    assert (choice.name, dict(choice.parameters)) == (name, parameters)


@pytest.mark.parametrize("given_choice", [None, 3, [], ["kmeans"], {}, {"nam": "x"}, {"name": 3}])
def test_other_things_are_not_choices(given_choice):
    with pytest.raises(UsageError) as caught:
        Choice.read(given_choice, "seeder")
    assert str(caught.value) == (
        f"seeder must be a name or a table with a name, not {given_choice!r}"
    )


class Walk:
    """An optimizer that nobody has installed, as far as choices go."""

    presets: ClassVar = {"polish": {"step": 0.5}}

    def __init__(self, start, lower, upper, scale, /, *, rng, step: float = 1.0):
        self.step = step


def walk_about(start, lower, upper, scale, /, *, rng, step: float = 1.0):
    return Walk(start, lower, upper, scale, rng=rng, step=step)


@pytest.mark.parametrize(
    ("given_choice", "name", "parameters"),
    [
        (Walk, "Walk", {}),
        (walk_about, "walk_about", {}),
        (functools.partial(Walk, step=2.0), "Walk", {"step": 2.0}),
        ({"name": Walk, "step": 2.0}, "Walk", {"step": 2.0}),
    ],
)
def test_a_class_or_factory_is_taken_as_it_is(given_choice, name, parameters):
    choice = Choice.read(given_choice, "optimizer")
    assert choice.name == f"{__name__}:{name}"
    ready = prepare(choice, "optimizer", registry())
    assert ready.parameters == parameters
    assert ready.component.id == choice.name
    assert ready.who == f"optimizer '{choice.name}', which is not installed,"
    made = ready.make(*([np.zeros(1)] * 4), rng=None)
    assert (type(made), made.step) == (Walk, parameters.get("step", 1.0))


def test_the_presets_and_parameters_of_a_class_count():
    ready = prepare(Choice.read(Walk, "optimizer"), "optimizer", registry())
    assert ready.preset("polish").parameters == {"step": 0.5}
    with pytest.raises(UsageError, match="did you mean 'step'"):
        prepare(Choice.read({"name": Walk, "stap": 1}, "optimizer"), "optimizer", registry())


def test_an_embedding_has_to_be_installed():
    with pytest.raises(UsageError, match="embedding must be a name"):
        Choice.read(Walk, "embedding")


@pytest.mark.parametrize("text", ["", "kmeans(", "kmeans(a)", "2*kmeans", "kmeans + kmeans"])
def test_malformed_texts(text):
    with pytest.raises(ExpressionError):
        Choice.read(text, "seeder")


@given(
    name=st.from_regex(r"([a-z_]\w{0,5}:)?[A-Za-z_]\w{0,5}", fullmatch=True).filter(str.isascii),
    parameters=st.dictionaries(
        st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,5}", fullmatch=True),
        st.one_of(
            st.floats(allow_nan=False, allow_infinity=False),
            st.integers(),
            st.booleans(),
            st.none(),
            st.text(),
            st.builds(Target, st.integers(-9, 9), st.floats(1e-9, 1e9)),
            st.sampled_from(["a b", "1.5", "x,y", "", "tête", 'say "it"', "C:\\x", "true", "none"]),
        ),
        max_size=3,
    ),
)
def test_a_choice_reads_back_as_itself(name, parameters):
    choice = Choice(name, parameters)
    assert Choice.read(str(choice), "seeder") == choice


@pytest.mark.parametrize(
    ("choice", "text"),
    [
        (Choice("mds", {"geodesics": "exact"}), "mds(geodesics=exact)"),
        (Choice("greedy", {"order": "head,body"}), 'greedy(order="head,body")'),
        (Choice("greedy", {"order": None}), "greedy(order=none)"),
        (Choice("greedy", {"order": "none"}), 'greedy(order="none")'),
        (
            Choice("search", {"rounds": np.int64(3), "step": np.float64(0.5)}),
            "search(rounds=3, step=0.5)",
        ),
    ],
)
def test_words_are_in_quotes_only_where_they_need_them(choice, text):
    assert str(choice) == text
    assert Choice.read(text, "seeder") == choice


@pytest.mark.parametrize("word", ["true", "1", "false", "0"])
def test_truth_values_are_written_as_words_or_numbers(word):
    choice = Choice.read(f"voronoi(connected={word})", "parameterization")
    ready = prepare(choice, "parameterization", registry())
    assert ready.parameters == {"connected": word in ("true", "1")}


def test_none_is_what_an_optional_parameter_may_be():
    choice = Choice.read("pattern_search(max_evaluations=none)", "optimizer")
    assert prepare(choice, "optimizer", registry()).parameters == {"max_evaluations": None}


def test_a_truth_value_reads_back_as_itself():
    choice = Choice("voronoi", {"connected": False})
    again = Choice.read(str(choice), "parameterization")
    assert prepare(again, "parameterization", registry()).parameters == {"connected": False}


def test_parameters_are_checked_against_the_constructor():
    ready = prepare(
        Choice.read("pattern_search(expansion=3)", "optimizer"), "optimizer", registry()
    )
    assert ready.factory is PatternSearch
    assert ready.component.id == "core:pattern_search"
    assert ready.parameters == {"expansion": 3.0}


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ("pattern_serch", "unknown optimizer 'pattern_serch'; did you mean 'pattern_search'?"),
        ("core:pattern", "unknown optimizer 'core:pattern'; did you mean 'core:pattern_search'?"),
        ("kmeans", "unknown optimizer 'kmeans'"),
        (
            "pattern_search(expanson=2)",
            "optimizer 'pattern_search': unknown parameter 'expanson'; did you mean 'expansion'?",
        ),
        (
            "pattern_search(expansion=0.5)",
            "optimizer 'pattern_search': parameter 'expansion' is 0.5; allowed is 1 or more",
        ),
        (
            "pattern_search(max_evaluations=2.5)",
            "optimizer 'pattern_search': parameter 'max_evaluations' must be whole, not 2.5",
        ),
        (
            "pattern_search(expansion=fast)",
            "optimizer 'pattern_search': parameter 'expansion' must be a number, not 'fast'",
        ),
        ("pattern_search(rng=1)", "optimizer 'pattern_search': unknown parameter 'rng'"),
        ("pattern_search(start=1)", "optimizer 'pattern_search': unknown parameter 'start'"),
    ],
)
def test_unknown_components_and_parameters(choice, message):
    with pytest.raises(UsageError) as caught:
        prepare(Choice.read(choice, "optimizer"), "optimizer", registry())
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    "parameters",
    [
        {"max_evaluations": math.inf},
        {"max_evaluations": math.nan},
        {"max_evaluations": "many"},
        {"expansion": True},
        {"threshold": None},
        {"pattern_size": math.inf},
        {"pattern_size": [0.1]},
    ],
    ids=str,
)
def test_values_that_a_table_can_hold_are_checked_too(parameters):
    choice = Choice.read({"name": "pattern_search", **parameters}, "optimizer")
    with pytest.raises(UsageError, match="optimizer 'pattern_search': parameter"):
        prepare(choice, "optimizer", registry())


# --- components of others

BUNDLE = """
    from moseg_core import SeederSpec, hookimpl

    @hookimpl
    def moseg_seeders():
        return [SeederSpec(name="other", target="acme_seeder:Other")]
"""


def prepared(site, source: str, target: str = "acme_seeder:Other", **parameters):
    site.add(
        "acme-seeders",
        "1.2",
        bundles={"acme": "acme_bundle"},
        acme_bundle=BUNDLE.replace("acme_seeder:Other", target),
        acme_seeder=source,
    )
    return prepare(Choice("other", parameters), "seeder", site.discover())


def test_a_component_is_made_with_what_is_given_and_chosen(site):
    ready = prepared(
        site,
        """
            class Other:
                def __init__(self, *given, rounds: int = 3, **more):
                    self.all = (given, rounds, more)
        """,
        rounds=5.0,
    )
    assert ready.make(1, 2, extra=3).all == ((1, 2), 5, {"extra": 3})


@pytest.mark.parametrize(
    "source",
    [
        "Other = 3",
        "Other = None",
        "class Other:\n    def __init__(self, *, k: list[int]): ...",
        "class Other:\n    def __init__(self, *, k: 'Unknown' = 1.0): ...",
        "class Other:\n    def __init__(self, evaluator: 'Unknown' = None): ...",
        "Other = dict",
        "import functools\nOther = functools.partial(print)",
    ],
    ids=["number", "None", "list", "unresolved", "unresolved elsewhere", "builtin", "partial"],
)
def test_what_cannot_be_a_component_is_a_plugin_error(site, source):
    with pytest.raises(PluginError) as caught:
        prepared(site, source)
    assert str(caught.value).startswith("seeder 'acme:other' of acme-seeders 1.2 cannot be ")
    assert "\n" not in str(caught.value)


def test_a_component_that_cannot_be_imported_is_a_plugin_error(site):
    with pytest.raises(PluginError, match=r"'acme:other' of acme-seeders 1\.2 cannot be loaded"):
        prepared(site, "import no_such_module")


@pytest.mark.parametrize(
    ("body", "shown"),
    [
        ("raise RuntimeError('out of ideas')", "RuntimeError: out of ideas"),
        ("1 / 0", "ZeroDivisionError"),
        ("pass", "TypeError"),
    ],
)
def test_a_constructor_that_fails_is_a_plugin_error(site, body, shown):
    source = f"""
        class Other:
            def __init__(self):
                {body}
    """
    ready = prepared(site, source)
    with pytest.raises(PluginError) as caught:
        ready.make(*([1] if body == "pass" else []))
    message = str(caught.value)
    assert message.startswith("seeder 'acme:other' of acme-seeders 1.2 cannot be made: ")
    assert shown in message


@pytest.mark.parametrize("kind", [UsageError, ShapeError])
def test_a_constructor_may_refuse_what_the_user_gave(site, kind):
    ready = prepared(
        site,
        f"""
            from moseg_core import {kind.__name__}

            class Other:
                def __init__(self):
                    raise {kind.__name__}("not with this")
        """,
    )
    with pytest.raises(kind, match=r"^not with this$"):
        ready.make()


def test_a_parameter_that_names_labels_must_be_there(site):
    site.add(
        *("acme-thirds", "1.0"),
        bundles={"acme": "acme_thirds"},
        acme_thirds="""
            from moseg_core import ParameterizationSpec, hookimpl

            moseg_contract = 1

            @hookimpl
            def moseg_parameterizations():
                target, names = "acme_thirds:Thirds", ("cuts",)
                return [ParameterizationSpec(name="t", target=target, label_parameters=names)]

            class Thirds:
                def __init__(self, shape, n_parts, *, cut="", labels=()):
                    pass
        """,
    )
    with pytest.raises(
        PluginError, match=r"'acme:t' .* name labels in 'cuts', and has no such par"
    ):
        prepare(Choice("acme:t"), "parameterization", site.discover())
