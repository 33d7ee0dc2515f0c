"""Parameters: how signatures declare them, and which values are accepted."""

from __future__ import annotations

import functools
import math
from typing import Annotated, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.components.parameters import (
    Interval,
    Parameter,
    check_parameters,
    declared_parameters,
)
from moseg_core.errors import UsageError
from moseg_core.language import Table, Target

TARGET_ADVICE = "write 0.06+-0.02: a typical value and how far from it is still usual"
REALS = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize(
    ("interval", "text"),
    [
        (Interval(), "any number"),
        (Interval(0), "0 or more"),
        (Interval(high=2.5), "2.5 or less"),
        (Interval(0, 1), "0 to 1"),
        (Interval(-1e-12, 1e9), "-1e-12 to 1e+09"),
    ],
)
def test_an_interval_in_words(interval, text):
    assert str(interval) == text


@given(REALS, REALS, REALS)
def test_an_interval_is_closed(low, high, value):
    interval = Interval(low, high)
    assert (value in interval) == (low <= value <= high)
    assert low in Interval(low)
    assert high in Interval(high=high)
    assert math.nan not in Interval()


def everything(
    part,
    first: str,
    /,
    other: float = 1.0,
    *,
    ratio: float,
    bounded: Annotated[float, Interval(0, 1)] = 0.5,
    count: Annotated[int, "how many", Interval(1)] = 3,
    limit: Annotated[int | None, Interval(1)] = None,
    closed: bool = True,
    mode: str = "fast",
    bare=2.5,
    whole=2,
    size: Annotated[Target | None, Interval(0, 1)] = None,
    height: Target = Target(2, 0.5),
    slope=Target(0, 1),
    free,
    **rest: float,
) -> float:
    return 0.0


def test_declarations_are_read_from_keyword_only_arguments():
    assert declared_parameters(everything) == (
        Parameter(name="ratio", type=float, required=True),
        Parameter(name="bounded", type=float, default=0.5, interval=Interval(0, 1)),
        Parameter(name="count", type=int, default=3, interval=Interval(1)),
        Parameter(name="limit", type=int, interval=Interval(1), optional=True),
        Parameter(name="closed", type=bool, default=True),
        Parameter(name="mode", type=str, default="fast"),
        Parameter(name="bare", type=float, default=2.5),
        Parameter(name="whole", type=int, default=2),
        Parameter(name="size", type=Target, interval=Interval(0, 1), optional=True),
        Parameter(name="height", type=Target, default=Target(2, 0.5)),
        Parameter(name="slope", type=Target, default=Target(0, 1)),
        Parameter(name="free", type=float, required=True),
    )


class Search:
    def __init__(self, start, /, *, rng: np.random.Generator, step: float = 1.0) -> None: ...


class Wider(Search):
    pass


class Nothing:
    pass


@pytest.mark.parametrize("target", [Search, Wider])
def test_a_class_declares_in_its_constructor(target):
    (step,) = declared_parameters(target, reserved=("rng",))
    assert step == Parameter(name="step", type=float, default=1.0)


def test_a_class_without_a_constructor_has_no_parameters():
    assert declared_parameters(Nothing) == ()


def test_an_object_declares_where_it_is_called():
    class Sized:
        def __call__(self, part, *, most: Annotated[int, Interval(1)] = 3): ...

    (found,) = declared_parameters(Sized())
    assert (found.name, found.type, found.default) == ("most", int, 3)


def test_a_wrapped_function_declares_what_it_wraps():
    @functools.wraps(everything)
    def wrapper(*arguments, **parameters):
        return everything(*arguments, **parameters)

    assert declared_parameters(wrapper) == declared_parameters(everything)


def takes_generator(*, rng: np.random.Generator) -> None: ...
def takes_list(*, k: list[int]) -> None: ...
def takes_literal(*, k: Literal["a", "b"] = "a") -> None: ...
def takes_two(*, k: int | float = 1) -> None: ...
def takes_unclear(*, k=None) -> None: ...
def takes_complex(*, k=1j) -> None: ...


@pytest.mark.parametrize(
    "target",
    [takes_generator, takes_list, takes_literal, takes_two, takes_unclear, takes_complex],
)
def test_other_types_are_refused_by_name(target):
    name = "rng" if target is takes_generator else "k"
    with pytest.raises(TypeError, match=f"parameter '{name}' of '{target.__name__}' must be"):
        declared_parameters(target)


def test_the_key_for_tables_is_nobodys_parameter():
    def taking(part, *, given: float = 1.0) -> float: ...

    with pytest.raises(TypeError, match="no parameter can be called 'given'"):
        declared_parameters(taking)


@pytest.mark.parametrize(
    ("kind", "value", "result"),
    [
        (float, 3, 3.0),
        (float, 3.5, 3.5),
        (float, np.float64(0.5), 0.5),
        (int, 3, 3),
        (int, 3.0, 3),
        (int, -2.0, -2),
        (bool, True, True),
        (bool, False, False),
        (str, "fast", "fast"),
        (Target, Target(0.06, 0.02), Target(0.06, 0.02)),
        (Target, "0.06+-0.02", Target(0.06, 0.02)),  # as the table of a recipe has it
        (Target, " -6 ± 2 ", Target(-6, 2)),
        (Table, Table({"area": 1}), Table({"area": 1})),
        (Table, {"leg": {"area": "1+-2"}}, Table({"leg": {"area": Target(1, 2)}})),
    ],
)
def test_values_come_back_in_the_declared_type(kind, value, result):
    checked = Parameter(name="k", type=kind).check(value, "'f'")
    assert checked == result
    assert type(checked) is kind


@pytest.mark.parametrize(
    ("kind", "value", "complaint"),
    [
        (float, True, "must be a number, not True"),
        (float, "3", "must be a number, not '3'"),
        (float, None, "must be a number, not None"),
        (float, [3], "must be a number, not [3]"),
        (float, 1j, "must be a number, not 1j"),
        (int, False, "must be a number, not False"),
        (int, 2.5, "must be whole, not 2.5"),
        (bool, "yes", "must be true or false, not 'yes'"),
        (bool, None, "must be true or false, not None"),
        (bool, 0.5, "must be true or false, not 0.5"),
        (str, 3, 'must be a word, not 3; in quotes it is one: k="3"'),
        (str, True, 'must be a word, not True; in quotes it is one: k="true"'),
        (str, None, 'must be a word, not None; in quotes it is one: k="none"'),
        (str, ["a"], "must be a word, not ['a']"),
        (float, Target(0.06, 0.02), "must be a number, not the target 0.06+-0.02"),
        (int, Target(6, 2), "must be a number, not the target 6+-2"),
        (bool, Target(0, 1), "must be true or false, not the target 0+-1"),
        (str, Target(0, 1), "must be a word, not the target 0+-1"),
        (Target, 0.06, f"must be a target, not 0.06; {TARGET_ADVICE}"),
        (Target, True, f"must be a target, not True; {TARGET_ADVICE}"),
        (Target, None, f"must be a target, not None; {TARGET_ADVICE}"),
        (Target, "small", f"must be a target, not 'small'; {TARGET_ADVICE}"),
        (Target, "1+-0", f"must be a target, not '1+-0'; {TARGET_ADVICE}"),
        (Table, "looks", "must be a table, not 'looks'; name one of the recipe's tables: k=looks"),
        (Table, None, "must be a table, not None; name one of the recipe's tables: k=looks"),
        (float, Table({"a": 1}), "must be a number, not a table"),
        (str, {"a": 1}, "must be a word, not a table"),
        (Target, [1, 2], f"must be a target, not [1, 2]; {TARGET_ADVICE}"),
    ],
)
def test_values_of_another_type_are_refused(kind, value, complaint):
    with pytest.raises(UsageError) as caught:
        Parameter(name="k", type=kind).check(value, "seeder 'f'")
    assert str(caught.value) == f"seeder 'f': parameter 'k' {complaint}"


@pytest.mark.parametrize("kind", [int, float])
@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan])
def test_numbers_are_finite(kind, value):
    # A TOML file can say `inf` and `nan`; a search with an infinite step never ends.
    with pytest.raises(UsageError, match="parameter 'k'"):
        Parameter(name="k", type=kind).check(value, "'f'")


@pytest.mark.parametrize(("value", "shown"), [(-0.1, "-0.1"), (1.5, "1.5"), (1e30, "1e+30")])
def test_values_out_of_bounds_are_refused_with_the_bounds(value, shown):
    parameter = Parameter(name="k", type=float, interval=Interval(0, 1))
    with pytest.raises(UsageError) as caught:
        parameter.check(value, "'f'")
    assert str(caught.value) == f"'f': parameter 'k' is {shown}; allowed is 0 to 1"


@pytest.mark.parametrize("value", [0, 1, 0.5])
def test_the_bounds_themselves_are_allowed(value):
    assert Parameter(name="k", type=float, interval=Interval(0, 1)).check(value, "'f'") == value


def test_bounds_of_a_target_are_those_of_its_value():
    parameter = Parameter(name="k", type=Target, interval=Interval(0, 1), optional=True)
    for target in (Target(0, 5), Target(1, 0.5)):
        assert parameter.check(target, "'f'") == target
    assert parameter.check(None, "'f'") is None
    with pytest.raises(UsageError) as caught:
        parameter.check(Target(1.5, 2), "'f'")
    assert str(caught.value) == "'f': parameter 'k' is 1.5; allowed is 0 to 1"


def test_none_is_a_value_where_it_is_declared():
    parameter = Parameter(name="k", type=int, interval=Interval(1), optional=True)
    assert parameter.check(None, "'f'") is None
    with pytest.raises(UsageError, match="1 or more"):
        parameter.check(0, "'f'")


A = Parameter(name="alpha", type=float, default=1.0)
B = Parameter(name="beta", type=float, required=True)


def test_only_given_parameters_come_back():
    assert check_parameters((A, B), {"beta": 2}, "'f'") == {"beta": 2.0}
    assert check_parameters((A, B), {"beta": 2, "alpha": 3}, "'f'") == {"beta": 2.0, "alpha": 3.0}
    assert check_parameters((), {}, "'f'") == {}


@pytest.mark.parametrize(
    ("declared", "given_values", "message"),
    [
        ((A,), {"alpa": 1}, "'f': unknown parameter 'alpa'; did you mean 'alpha'?"),
        ((A, B), {"x": 1, "beta": 1}, "'f': unknown parameter 'x'; known: alpha, beta"),
        ((), {"x": 1}, "'f': unknown parameter 'x'; known: none"),
        ((A, B), {"alpha": 1}, "'f': parameter 'beta' is missing"),
        ((A, B), {"bta": 1}, "'f': unknown parameter 'bta'; did you mean 'beta'?"),
    ],
)
def test_unknown_and_missing_parameters(declared, given_values, message):
    with pytest.raises(UsageError) as caught:
        check_parameters(declared, given_values, "'f'")
    assert str(caught.value) == message


@given(st.integers(-100, 100), st.integers(-100, 100), REALS)
def test_a_checked_number_is_in_its_interval_and_equal(low, high, value):
    parameter = Parameter(name="k", type=float, interval=Interval(low, high))
    try:
        assert parameter.check(value, "'f'") == value
    except UsageError:
        assert not low <= value <= high
    else:
        assert low <= value <= high
