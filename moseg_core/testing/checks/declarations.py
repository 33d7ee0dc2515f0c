"""What every component promises of its parameters: what it declares is what may be said.

A declaration is one line in a signature (:mod:`moseg_core.components.parameters`). From it come the
check of ``key=value`` in expressions and recipes, the defaults and the documentation; so it has to
be true.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.constraint_function import FunctionConstraint
from moseg_core.components.parameters import Parameter, check_parameters
from moseg_core.errors import UsageError
from moseg_core.language import Table, Target
from moseg_core.language.terms import format_value
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.checks.repeats import baseline
from moseg_core.testing.fixtures.comparison import expect_no_error, expect_same
from moseg_core.testing.fixtures.drivers import drive
from moseg_core.testing.fixtures.trial import (
    DRIVEN,
    declared,
    has_example,
    in_its_type,
    required,
    tame,
)


@check("parameters-round-trip", kinds=DRIVEN)
def _parameters_round_trip(subject: Subject) -> None:
    """Recipes and results write parameters down; read back, they must mean the same."""
    parameters = declared(subject)
    optional = [p for p in parameters if not p.required and p.default is not None]
    if not optional:
        raise Skip("it has no parameters with defaults")
    for parameter in optional:
        try:
            value = parameter.check(parameter.default, subject.component.who)
        except UsageError as error:
            raise ContractFailure(
                did=f"the default {parameter.default!r} of '{parameter.name}' was given to it",
                got=str(error),
                expected="a value that the parameter's own declaration allows",
                fix="change the default or the Interval",
            ) from error
        if type(value) is not type(parameter.default) or value != parameter.default:
            raise ContractFailure(
                did=f"the default of '{parameter.name}' was written down and read",
                got=repr(value),
                expected=repr(parameter.default),
                fix=f"write the default as a {parameter.type.__name__}",
            )
    defaults = {parameter.name: parameter.default for parameter in optional}
    # An example may stand in for defaults; here it is the defaults that are looked at.
    plain = drive(subject, in_full=True) if has_example(subject) else baseline(subject)
    expect_same(
        plain,
        drive(subject, parameters=defaults, in_full=True),
        did=f"it was run without parameters, and with its defaults {defaults} given",
        fix="use the same default in the signature as within",
    )


@check("parameters-in-range", kinds=DRIVEN)
def _parameters_in_range(subject: Subject) -> None:
    """What the declaration allows a user to say must not end in a crash."""
    for parameter, value in _tried(subject, within):
        said = f"{parameter.name}={format_value(value)}"
        expect_no_error(
            drive(subject, parameters={parameter.name: value}),
            did=f"it was run with {said}, which its declaration allows",
            excused=True,
            fix="narrow the Interval, handle the value, or raise moseg_core.UsageError where it"
            " depends on something else",
        )


def _tried(
    subject: Subject, values: Callable[[Parameter], list[Any]]
) -> list[tuple[Parameter, Any]]:
    tried = [(parameter, value) for parameter in declared(subject) for value in values(parameter)]
    if not tried:
        raise Skip("it has no parameters with bounds")
    return tried


def within(parameter: Parameter) -> list[Any]:
    """The finite ends of a range, but for values much larger than the default; of targets also 1.

    Nothing of a word or a table: nobody can guess which ones there are.
    """
    if parameter.type is bool:
        return [False, True]
    if parameter.type in (str, Table):
        return []
    usual = tame(parameter).value if parameter.type is Target else parameter.default
    most = 10.0 * max(1.0, abs(usual or 1.0))
    ends = (parameter.interval.low, parameter.interval.high)
    numbers = [end for end in ends if math.isfinite(end) and abs(end) <= most]
    if parameter.type is Target:
        numbers = list(dict.fromkeys([usual, *numbers]))
    return [in_its_type(parameter, number) for number in numbers]


@check("parameter-out-of-range", kinds=DRIVEN)
def _parameter_out_of_range(subject: Subject) -> None:
    """A wrong number must be refused before the search, by a message that names it."""
    others = required(subject)
    for parameter, value in _tried(subject, _beyond):
        said = f"{parameter.name}={format_value(value)}"
        did = f"{said} was asked for, where {parameter.interval} is allowed"
        fix = "declare parameters as keyword-only arguments with moseg_core.Interval"
        try:
            _asked(subject, {**others, parameter.name: value})
        except UsageError as error:
            if parameter.name not in str(error):
                raise ContractFailure(
                    did=did, got=str(error), expected=f"'{parameter.name}' in the message", fix=fix
                ) from error
            continue
        raise ContractFailure(did=did, got="no complaint", expected="a UsageError", fix=fix)


def _beyond(parameter: Parameter) -> list[Any]:
    if parameter.type not in (int, float, Target):
        return []
    beyond = (parameter.interval.low - 1.0, parameter.interval.high + 1.0)
    return [in_its_type(parameter, value) for value in beyond if math.isfinite(value)]


def _asked(subject: Subject, parameters: dict[str, Any]) -> None:
    """Have the core check parameters as it does when somebody asks for the component."""
    component, target = subject.component, subject.load()
    if component.kind == "objective" or isinstance(target, FunctionConstraint):
        check_parameters(tuple(target.parameters), parameters, component.who)
    else:
        prepare(Choice(component.id, parameters), component.kind, subject.registry)
