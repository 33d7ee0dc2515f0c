"""The bundle ``learn``: names, targets and nothing heavy."""

from __future__ import annotations

from moseg_core import CommandSpec, FieldSpec, LearnerSpec, ObjectiveSpec, hookimpl

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
def moseg_objectives() -> list[ObjectiveSpec]:
    """What learned recipes ask for beside the objectives of ``basic``."""
    return [
        ObjectiveSpec(
            name="likely",
            target=f"{_PACKAGE}.likely:likely",
            summary="one part: looks, place by place, as parts of its kind do",
        )
    ]


@hookimpl
def moseg_fields() -> list[FieldSpec]:
    """What every element is like, and how likely it is to bear a label."""
    return [
        FieldSpec(
            name="surroundings",
            target=f"{_PACKAGE}.surroundings:surroundings",
            summary="what lies around: how much, how long, wide, deep, thick and remote",
            requires=("surface", "adjacency"),
            invariant_to=("rigid", "scale", "reflection", "order"),
        ),
        FieldSpec(
            name="unlikeliness",
            target=f"{_PACKAGE}.looks:unlikeliness",
            summary="how unlikely it is to be of a kind: 0 where certain, 6.9 at most",
            requires=("surface", "adjacency"),
            invariant_to=("rigid", "scale", "reflection", "order"),
        ),
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
