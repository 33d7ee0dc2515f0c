"""Objectives: what signatures and declarations mean, and contracts that are broken."""

from __future__ import annotations

import math
import pickle
import signal
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import numpy as np
import pytest

from moseg_core.components.discovery.registry import Registry
from moseg_core.components.objectives import COST_ORDER, FunctionObjective, Traits, objective
from moseg_core.components.parameters import Interval, Parameter
from moseg_core.components.part import Part
from moseg_core.components.protocols import Objective
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import ExpressionError, PluginError, ShapeError, UsageError
from moseg_core.problem.problem import Problem

if TYPE_CHECKING:
    from nowhere import Unknown


@objective(range=(0, 1), invariant_to=("rigid", "scale"))
def one(part: Part, *, power: Annotated[float, Interval(1, 4)] = 2.0) -> float:
    """How one part is."""
    return power / 8


@objective()
def two(first: Part, second: Part) -> float:
    return float(first.n_elements - second.n_elements)


@objective()
def three(a: Part, b: Part, c: Part, *, k: float = 0.0) -> float:
    return a.n_elements * 100 + b.n_elements * 10 + c.n_elements + k


@objective(range=(0, math.inf), cost="expensive")
def many(parts: Sequence[Part]) -> float:
    return float(len(parts))


@objective(least=1)
def some(parts: list[Part]) -> float:
    return float(len(parts))


@objective(requires=("volume", "adjacency"), cost="moderate")
def whole(segmentation: Segmentation) -> float:
    return float(segmentation.n_parts)


@pytest.mark.parametrize(
    ("made", "arity", "least", "most", "takes"),
    [
        (one, "unary", 1, 1, "one label, or several to be summed"),
        (two, "nary", 2, 2, "exactly 2 labels"),
        (three, "nary", 3, 3, "exactly 3 labels"),
        (many, "nary", 2, None, "2 labels or more"),
        (whole, "global", 2, None, "no labels"),
    ],
)
def test_the_annotations_say_what_an_objective_is_about(made, arity, least, most, takes):
    assert made.traits.arity == arity
    assert made.traits.takes == takes
    if arity != "global":
        assert (made.traits.least, made.traits.most) == (least, most)


def test_the_least_number_of_parts_can_be_declared():
    assert (some.traits.least, some.traits.most) == (1, None)
    assert Traits(arity="nary", least=2, most=4).takes == "2 labels or more, at most 4"


def test_a_single_label_is_not_called_labels():
    assert some.traits.takes == "one label or more"


def test_traits_are_what_was_declared():
    assert one.traits == Traits(
        arity="unary",
        range=(0.0, 1.0),
        invariant_to=frozenset({"rigid", "scale"}),
        most=1,
    )
    assert many.traits.range == (0.0, math.inf)
    assert many.traits.cost == "expensive"
    assert whole.traits.requires == {"volume", "adjacency"}
    assert two.traits.range == (-math.inf, math.inf)


def share_of(given):
    return given.get("share")


def test_an_objective_may_say_which_share_it_expects():
    made = objective(range=(0, 1), share=share_of)(size)
    assert made.traits.share is share_of
    assert made.traits.expected_share({"share": np.float64(0.25)}) == 0.25
    assert type(made.traits.expected_share({"share": 1})) is float
    assert made.traits.expected_share({}) is None
    assert one.traits.share is None
    assert one.traits.expected_share({"share": 0.25}) is None
    with pytest.raises(ValueError, match=r"share is a function of its parameters, not 0\.3"):
        objective(share=0.3)


@pytest.mark.parametrize("share", [0, -0.1, 1.0000001, math.nan, math.inf, "0.5", True, [0.5], 1j])
def test_a_share_is_a_number_above_0_and_at_most_1(share):
    with pytest.raises(ValueError, match="a share is a number above 0 and at most 1"):
        Traits(arity="unary", share=share_of).expected_share({"share": share})


def size_of(given):
    return given.get("field")


def test_an_objective_may_say_which_field_it_is_the_mean_of():
    made = objective(range=(0, 1), mean_of=size_of)(size)
    assert made.traits.mean_of is size_of
    assert made.traits.averaged_field({"field": ("a:b", {"k": 1})}) == ("a:b", {"k": 1})
    assert made.traits.averaged_field({}) is None
    assert one.traits.averaged_field({"field": ("a:b", {})}) is None
    with pytest.raises(ValueError, match=r"told by a function, not 'a:b'"):
        objective(mean_of="a:b")
    with pytest.raises(ValueError, match="of several parts is no mean over one"):
        objective(mean_of=size_of)(two._function)


def test_an_objective_may_have_a_vectorised_form():
    def sizes(parts):
        return parts.areas

    assert one.traits.vectorized is None
    assert objective(range=(0, 9), vectorized=sizes)(size).traits.vectorized is sizes
    with pytest.raises(ValueError, match="vectorized form is a function, not 'sizes'"):
        objective(vectorized="sizes")


def test_an_objective_may_bound_its_values():
    def sizes(parts):
        return parts.areas

    assert one.traits.at_least is None
    assert objective(range=(0, 9), at_least=sizes)(size).traits.at_least is sizes
    with pytest.raises(ValueError, match="lower bound is a function, not 3"):
        objective(at_least=3)


@pytest.mark.parametrize(
    "field", ["a:b", ("a:b",), ("a:b", {}, {}), ["a:b", {}], ("a:b", None), (1, {}), True]
)
def test_of_which_field_is_a_name_with_parameters(field):
    with pytest.raises(ValueError, match="is a tuple of a field's id and a mapping of its param"):
        Traits(arity="unary", mean_of=size_of).averaged_field({"field": field})


def test_fields_are_a_tuple_or_a_function_of_the_parameters():
    def named(parameters):
        return (f"basic:{parameters['what']}",)

    @objective(fields=["basic:thickness", "basic:height"])
    def listed(part: Part) -> float:
        return 0.0

    @objective(fields=named)
    def by_parameter(part: Part, *, what: str = "height") -> float:
        return 0.0

    assert one.traits.fields == ()
    assert listed.traits.fields == ("basic:thickness", "basic:height")
    assert by_parameter.traits.fields is named
    assert Traits(arity="unary").fields == ()


def test_cost_classes_are_in_order():
    assert COST_ORDER["cheap"] < COST_ORDER["moderate"] < COST_ORDER["expensive"]


def test_an_objective_keeps_name_documentation_and_parameters():
    assert isinstance(one, FunctionObjective)
    assert isinstance(one, Objective)
    assert one.__name__ == "one"
    assert one.__doc__ == "How one part is."
    assert one.__module__ == __name__
    assert one.parameters == (
        Parameter(name="power", type=float, default=2.0, interval=Interval(1, 4)),
    )
    assert two.parameters == ()


def test_each_arity_is_called_with_its_own_subject(row):
    segmentation = Segmentation.from_labels(row, [0, 1, 1, 2, 2, 2], 3)
    a, b, c = segmentation.parts
    assert one(a) == 0.25
    assert one(a, power=4.0) == 0.5
    assert two((b, c)) == -1
    assert three((a, b, c), k=0.5) == 123.5
    assert many((a, b)) == 2
    assert whole(segmentation) == 3


def test_an_objective_pickles_by_reference(monkeypatch):
    # Whether this module can be imported by name depends on how the tests are run.
    import sys
    import types

    home = types.ModuleType("home_of_objectives")
    source = (
        "from moseg_core import Part, objective\n"
        "@objective()\n"
        "def f(part: Part) -> float:\n"
        "    return 0.0\n"
    )
    monkeypatch.setitem(sys.modules, home.__name__, home)
    exec(source, home.__dict__)
    assert pickle.loads(pickle.dumps(home.f)) is home.f


def no_arguments() -> float: ...
def bare(part) -> float: ...
def wrong(part: int) -> float: ...
def mixed(part: Part, number: float = 1.0) -> float: ...
def half(first: Part, second) -> float: ...
def sequence_of_other(parts: Sequence[int]) -> float: ...
def bare_sequence(parts: Sequence) -> float: ...
def two_sequences(first: Sequence[Part], second: Sequence[Part]) -> float: ...
def part_and_whole(part: Part, segmentation: Segmentation) -> float: ...
def maybe(part: Part | None) -> float: ...
def a_set(parts: set[Part]) -> float: ...


@pytest.mark.parametrize(
    "function",
    [
        no_arguments,
        bare,
        wrong,
        mixed,
        half,
        sequence_of_other,
        bare_sequence,
        two_sequences,
        part_and_whole,
        maybe,
        a_set,
    ],
)
def test_other_signatures_are_refused_with_what_is_allowed(function):
    with pytest.raises(TypeError) as caught:
        objective()(function)
    message = str(caught.value)
    assert f"objective '{function.__name__}' must take a Part" in message
    assert "parameters come after '*'" in message


def any_number(*parts: Part) -> float: ...


def test_an_unlimited_number_of_arguments_is_not_taken_for_one():
    with pytest.raises(TypeError, match="objective 'any_number' must take"):
        objective()(any_number)


def listed(part: Part, *, k: list[int]) -> float: ...


def test_a_parameter_of_another_type_is_refused_when_the_objective_is_made():
    with pytest.raises(TypeError, match="parameter 'k' of 'listed'"):
        objective()(listed)


@pytest.mark.parametrize("ends", [(1, 0), (0, 0), (math.nan, 1), (0, math.nan), (math.inf, 0)])
def test_a_range_goes_from_low_to_high(ends):
    with pytest.raises(ValueError, match="range goes from low to high"):
        objective(range=ends)


@pytest.mark.parametrize(
    "declared",
    [
        {"requires": ("volme",)},
        {"requires": "volume"},
        {"invariant_to": ("rotation",)},
        {"invariant_to": "rigid"},
        {"cost": "cheep"},
        {"measures": "vessels:bore"},
        {"measures": (3,)},
    ],
    ids=str,
)
def test_a_misspelled_declaration_is_refused(declared):
    with pytest.raises((ValueError, TypeError)):
        objective(**declared)(bare_part)


def bare_part(part: Part) -> float:
    return 0.0


# --- functions given to a problem

NONE = Registry(())


def size(part: Part) -> float:
    return float(part.n_elements)


def gap(first: Part, second: Part) -> float:
    return float(first.n_elements - second.n_elements)


def first_to_last(parts: Sequence[Part]) -> float:
    return float(parts[0].n_elements - parts[-1].n_elements)


def total(segmentation: Segmentation) -> float:
    return float(sum(part.n_elements for part in segmentation.parts))


def scaled(
    part: Part,
    *,
    by: Annotated[float, Interval(0, 10)] = 2.0,
    plus: Annotated[int, Interval(0)] = 0,
) -> float:
    return part.n_elements * by + plus


OWN = {"size": size, "gap": gap, "first_to_last": first_to_last, "total": total, "scaled": scaled}


def problem(labels: str, minimize: str, **more) -> Problem:
    return Problem(labels.split(), minimize, objectives={**OWN, **more}, registry=NONE)


def test_a_decorated_function_is_taken_as_it_is():
    decorated = objective(range=(0, 9), cost="expensive")(size)
    assert problem("a", "mine(a)", mine=decorated).terms[0].objective is decorated


def test_a_plain_function_is_taken_by_its_annotations():
    arities = {term.id: term.objective.traits.arity for term in problem(
        "a b", "size(a) + gap(a, b) + first_to_last(a, b) + total"
    ).terms}  # fmt: skip
    assert arities == {
        "python:size": "unary",
        "python:gap": "nary",
        "python:first_to_last": "nary",
        "python:total": "global",
    }


def unannotated(part): ...
def unresolved(part: Unknown) -> float: ...


class Answering:
    factor: float = 1.0

    def __call__(self, part: Part) -> float:
        return self.factor


@pytest.mark.parametrize(
    "given_objective",
    [unannotated, lambda part: 0.0, listed, unresolved, Answering(), 3, None, "size", len],
    ids=["unannotated", "lambda", "listed", "unresolved", "object", "int", "None", "str", "len"],
)
def test_what_cannot_be_an_objective_is_refused_by_name(given_objective):
    with pytest.raises(UsageError, match="objective 'mine' cannot be used: "):
        Problem(["a"], "mine(a)", objectives={"mine": given_objective}, registry=NONE)


def test_parameters_reach_the_function(row):
    made = problem("a b", "scaled(a) + scaled(a, by=10, plus=3) + scaled(b, plus=1)")
    found = made.evaluate(row, [0, 0, 0, 0, 1, 1])
    assert [term.value for term in found.terms] == [8.0, 43.0, 5.0]


@pytest.mark.parametrize("text", ["scaled(a, by=11)", "scaled(a, plus=-1)", "scaled(a, plus=.5)"])
def test_parameters_are_checked(text):
    with pytest.raises(ExpressionError, match="'scaled': parameter"):
        problem("a", text)


# --- objectives that break their contract


class Unprintable:
    def __float__(self) -> float:
        raise TypeError("no number")

    def __repr__(self) -> str:
        raise TypeError("no text")


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (math.nan, "returned nan"),
        (math.inf, "returned inf"),
        (-math.inf, "returned -inf"),
        (1.5, "returned 1.5"),
        (-0.1, "returned -0.1"),
        (1 + 1e-6, "returned 1.000001"),
        (None, "returned None in"),
        ("0.5", "returned '0.5' (a str)"),
        (1j, "returned 1j (a complex)"),
        ([0.5], "returned [0.5] (a list)"),
        (True, "returned True (a bool)"),
        (Unprintable(), "returned something (an Unprintable)"),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, Unprintable) else str(value),
)
def test_a_value_that_is_no_number_in_the_range_is_a_plugin_error(row, value, shown):
    def odd(part: Part, *, k: float = 1.0) -> float:
        return value if part.elements[0] > 0 else 0.5  # b, not a

    made = problem("a b", "size(a) + 2*odd(a, b, k=3)", odd=objective(range=(0, 1))(odd))
    with pytest.raises(PluginError) as caught:
        made.evaluate(row, [0, 0, 0, 1, 1, 1])
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith("objective 'python:odd' of the calling program ")
    assert "'odd(a, b, k=3)' for b" in message
    assert shown in message
    if isinstance(value, float) and math.isfinite(value):
        assert "it declares values from 0 to 1; " in message


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_values_are_finite_whatever_the_range(row, value):
    def odd(segmentation: Segmentation) -> float:
        return value

    with pytest.raises(PluginError, match=f"returned {value} in 'odd'"):
        problem("a", "odd", odd=odd).evaluate(row, [0] * 6)


@pytest.mark.parametrize("value", [math.inf, -math.inf])
def test_an_infinite_value_is_not_said_to_be_outside_of_an_infinite_range(row, value):
    def odd(segmentation: Segmentation) -> float:
        return value

    with pytest.raises(PluginError, match="finite"):
        problem("a", "odd", odd=odd).evaluate(row, [0] * 6)


@pytest.mark.parametrize(
    ("value", "clipped"), [(-1e-12, 0.0), (1 + 1e-12, 1.0), (0.0, 0.0), (1.0, 1.0), (0.25, 0.25)]
)
def test_rounding_beyond_the_range_is_clipped(row, value, clipped):
    def odd(part: Part) -> float:
        return value

    found = problem("a", "odd(a)", odd=objective(range=(0, 1))(odd)).evaluate(row, [0] * 6)
    assert found.cost.value == clipped


@pytest.mark.parametrize(
    "error", [ZeroDivisionError("by zero"), KeyError("k"), ShapeError("bad"), RuntimeError()]
)
def test_an_objective_that_raises_is_a_plugin_error(row, error):
    def odd(first: Part, second: Part) -> float:
        raise error

    with pytest.raises(PluginError) as caught:
        problem("a b", "odd(b, a)", odd=odd).evaluate(row, [0, 0, 0, 1, 1, 1])
    message = str(caught.value)
    assert message.startswith("objective 'python:odd' of the calling program failed in ")
    assert f"'odd(b, a)' for b, a: {type(error).__name__}" in message
    assert str(error) in message
    assert caught.value.__cause__ is error
    assert caught.value.exit_code == 1


def test_an_error_of_several_lines_is_told_in_one(row):
    def odd(part: Part) -> float:
        raise ValueError("first\nsecond")

    with pytest.raises(PluginError) as caught:
        problem("a", "odd(a)", odd=odd).evaluate(row, [0] * 6)
    assert "\n" not in str(caught.value)


def test_an_interruption_is_not_taken_for_a_failure(row):
    def odd(part: Part) -> float:
        signal.raise_signal(signal.SIGINT)
        return 0.0

    with pytest.raises(KeyboardInterrupt):
        problem("a", "odd(a)", odd=odd).evaluate(row, [0] * 6)


def test_an_installed_objective_is_named_with_its_distribution(row, site):
    site.add(
        "acme-parts",
        "1.2",
        bundles={"acme": "acme_bundle"},
        acme_bundle="""
            from moseg_core import ObjectiveSpec, hookimpl

            @hookimpl
            def moseg_objectives():
                return [ObjectiveSpec(name="odd", target="acme_odd:odd")]
        """,
        acme_odd="""
            from moseg_core import Part, objective

            @objective(range=(0, 1))
            def odd(part: Part) -> float:
                return 7.0
        """,
    )
    made = Problem(["a"], "odd(a)", registry=site.discover())
    with pytest.raises(
        PluginError, match=r"^objective 'acme:odd' of acme-parts 1\.2 returned 7\.0"
    ):
        made.evaluate(row, [0] * 6)
