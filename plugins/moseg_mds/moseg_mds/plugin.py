"""The bundle ``mds``: names, targets and nothing heavy."""

from __future__ import annotations

from moseg_core import CommandSpec, EmbeddingSpec, RecipeSpec, hookimpl

_PACKAGE = "moseg_mds"

#: The contract with moseg that the bundle was written for.
moseg_contract = 1


@hookimpl
def moseg_embeddings() -> list[EmbeddingSpec]:
    """Multidimensional scaling of distances along the surface (Sec. 9)."""
    return [
        EmbeddingSpec(
            name="mds",
            target=f"{_PACKAGE}.embedding:MDS",
            summary="limbs stretched out: distances in space about those along the surface",
        )
    ]


@hookimpl
def moseg_commands() -> list[CommandSpec]:
    """To look at an embedding."""
    return [
        CommandSpec(
            name="embed",
            target=f"{_PACKAGE}.command:embed",
            summary="Write a shape with its limbs stretched out, to look at.",
        )
    ]


@hookimpl
def moseg_recipes() -> list[RecipeSpec]:
    """The recipe of Fig. 9 that unfolds the shape."""
    return [
        RecipeSpec(
            name="paper_octopus",
            target=f"{_PACKAGE}.recipes:PAPER_OCTOPUS",
            summary="as the paper prints it: a head and eight arms, however they bend",
        )
    ]
