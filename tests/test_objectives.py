from __future__ import annotations

import math
import pickle
from collections.abc import Sequence
from typing import Annotated

import pytest

from moseg_core.objectives import COST_ORDER, FunctionObjective, Traits, objective
from moseg_core.parameters import Interval, Parameter
from moseg_core.part import Part
from moseg_core.protocols import Objective
from moseg_core.segmentation import Segmentation


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
        (one, "unary", 1, 1, "one label or more"),
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
    ],
    ids=str,
)
def test_a_misspelled_declaration_is_refused(declared):
    with pytest.raises((ValueError, TypeError)):
        objective(**declared)(bare_part)


def bare_part(part: Part) -> float:
    return 0.0
