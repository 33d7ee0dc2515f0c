"""The bundle ``learn``: names, targets and nothing heavy."""

from __future__ import annotations

from moseg_core import CommandSpec, LearnerSpec, hookimpl

_PACKAGE = "moseg_learn"

#: The contract with moseg that the bundle was written for.
moseg_contract = 1


@hookimpl
def moseg_learners() -> list[LearnerSpec]:
    """How recipes are learned."""
    return [
        LearnerSpec(
            name="profiles",
            target=f"{_PACKAGE}.learner:profiles",
            summary="what the parts of the examples measure, typically, and how they touch",
        )
    ]


@hookimpl
def moseg_commands() -> list[CommandSpec]:
    """``moseg learn``."""
    return [
        CommandSpec(
            name="learn",
            target=f"{_PACKAGE}.command:learn",
            summary="Make a recipe of labelled examples.",
        )
    ]
