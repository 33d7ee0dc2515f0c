"""What every component promises of its parameters: what it declares is what may be said.

A declaration is one line in a signature (:mod:`moseg_core.components.parameters`). From it come the
check of ``key=value`` in expressions and recipes, the defaults and the documentation; so it has to
be true.
"""

from __future__ import annotations

import math
from typing import Any

from moseg_core.components.constraint_function import FunctionConstraint
from moseg_core.components.parameters import Parameter, check_parameters
from moseg_core.errors import UsageError
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.checks.repeats import baseline, compare, complain_of_errors
from moseg_core.testing.fixtures.drivers import drive, prepared
from moseg_core.testing.fixtures.trial import DRIVEN, declared, required_values


@check(
    "parameters-round-trip",
    kinds=DRIVEN,
    why="recipes and results write parameters down; read back, they must mean the same",
)
def parameters_round_trip(subject: Subject) -> None:
    """Every default is a value that the declaration allows, and giving it changes nothing."""
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
    said = {parameter.name: parameter.default for parameter in optional}
    compare(
        baseline(subject),
        drive(subject, parameters=said),
        did=f"it was run with nothing said, and with its defaults {said} given",
        expected="the same",
        fix="use the same default in the signature as within",
    )


@check(
    "parameters-in-range",
    kinds=DRIVEN,
    why="what the declaration allows a user to say must not end in a crash",
)
def parameters_in_range(subject: Subject) -> None:
    """It runs with the ends of every range; a refusal must be moseg's own UsageError."""
    tried = [(p, value) for p in declared(subject) for value in _within(p)]
    if not tried:
        raise Skip("it has no parameters with bounds")
    for parameter, value in tried:
        found = drive(subject, parameters={parameter.name: value})
        complain_of_errors(
            found,
            did=f"it was run with {parameter.name}={value!r}, which its declaration allows",
            excused=True,
            fix="narrow the Interval, handle the value, or raise moseg_core.UsageError where it"
            " depends on something else",
        )


def _within(parameter: Parameter) -> list[Any]:
    """The finite ends of a range, but for values much larger than the default."""
    if parameter.type is bool:
        return [False, True]
    if parameter.type not in (int, float):
        return []
    most = 10.0 * max(1.0, abs(parameter.default or 1.0))
    low, high = parameter.interval.low, parameter.interval.high
    return [parameter.type(end) for end in (low, high) if math.isfinite(end) and abs(end) <= most]


@check(
    "parameter-out-of-range",
    kinds=DRIVEN,
    why="a wrong number must be refused before the search, by a message that names it",
)
def parameter_out_of_range(subject: Subject) -> None:
    """Values beyond a range are refused by name."""
    tried = [(p, value) for p in declared(subject) for value in _beyond(p)]
    if not tried:
        raise Skip("it has no parameters with bounds")
    required = required_values(declared(subject))
    for parameter, value in tried:
        did = f"{parameter.name}={value:g} was asked for, where {parameter.interval} is allowed"
        fix = "declare parameters as keyword-only arguments with moseg_core.Interval"
        try:
            _asked(subject, {**required, parameter.name: value})
        except UsageError as error:
            if parameter.name not in str(error):
                raise ContractFailure(
                    did=did, got=str(error), expected=f"'{parameter.name}' in the message", fix=fix
                ) from error
            continue
        raise ContractFailure(did=did, got="no complaint", expected="a UsageError", fix=fix)


def _beyond(parameter: Parameter) -> list[Any]:
    if parameter.type not in (int, float):
        return []
    low, high = parameter.interval.low, parameter.interval.high
    found = [low - 1.0] if math.isfinite(low) else []
    found += [high + 1.0] if math.isfinite(high) else []
    return [parameter.type(value) for value in found]


def _asked(subject: Subject, parameters: dict[str, Any]) -> None:
    """Have the core check parameters as it does when somebody asks for the component."""
    kind, target = subject.component.kind, subject.load()
    if kind == "objective" or isinstance(target, FunctionConstraint):
        check_parameters(tuple(target.parameters), parameters, subject.component.who)
    else:
        prepared(subject, parameters)
