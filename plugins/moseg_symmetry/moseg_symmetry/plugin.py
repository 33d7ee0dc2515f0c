"""The bundle ``symmetry``: names, targets and nothing heavy."""

from __future__ import annotations

from moseg_core import CommandSpec, ConstraintSpec, RecipeSpec, hookimpl

_PACKAGE = "moseg_symmetry"

#: The contract with moseg that the bundle was written for.
moseg_contract = 1


@hookimpl
def moseg_constraints() -> list[ConstraintSpec]:
    """The symmetry constraints of Sec. 8."""
    return [
        ConstraintSpec(
            name="mirror",
            target=f"{_PACKAGE}.constraints:Mirror",
            summary="mirror(leg2, leg1): the first centre is the mirror image of the second",
        ),
        ConstraintSpec(
            name="on_plane",
            target=f"{_PACKAGE}.constraints:OnPlane",
            summary="on_plane(body, head): the centres lie on the plane of symmetry",
        ),
    ]


@hookimpl
def moseg_commands() -> list[CommandSpec]:
    """What symmetries a shape has."""
    return [
        CommandSpec(
            name="symmetry",
            target=f"{_PACKAGE}.command:symmetry",
            summary="Show the planes and axes of symmetry of a shape.",
        )
    ]


@hookimpl
def moseg_recipes() -> list[RecipeSpec]:
    """The recipes of Fig. 9 with symmetry constraints."""
    return [
        RecipeSpec(
            name="paper_bulldog",
            target=f"{_PACKAGE}.recipes:PAPER_BULLDOG",
            summary="as the paper prints it: a symmetric animal with two pairs of legs",
        ),
        RecipeSpec(
            name="paper_dove",
            target=f"{_PACKAGE}.recipes:PAPER_DOVE",
            summary="as the paper prints it: a bird in flight, with body, two wings, tail",
        ),
    ]
