"""The hooks through which bundles, the core's own among them, offer components.

A bundle is a module named by an entry point of the group ``moseg``; the entry point's name is
the bundle's namespace. The module marks functions with :data:`hookimpl`; each returns a list of
specs (:mod:`moseg_core.components.discovery.specs`) and imports nothing heavy::

    from moseg_core import ObjectiveSpec, hookimpl

    @hookimpl
    def moseg_objectives():
        return [ObjectiveSpec(name="tubular", target="my_package.objectives:tubular")]
"""

from __future__ import annotations

from collections.abc import Sequence

import pluggy

from moseg_core.components.discovery.specs import (
    CommandSpec,
    ConstraintSpec,
    EmbeddingSpec,
    FieldSpec,
    Kind,
    LabelerSpec,
    LearnerSpec,
    MeasureSpec,
    ObjectiveSpec,
    OptimizerSpec,
    ParameterizationSpec,
    ReaderSpec,
    RecipeSpec,
    RefinerSpec,
    SeederSpec,
    Spec,
    WriterSpec,
)

hookspec = pluggy.HookspecMarker("moseg")
hookimpl = pluggy.HookimplMarker("moseg")

HOOKS: dict[str, tuple[Kind, type[Spec]]] = {
    "moseg_objectives": ("objective", ObjectiveSpec),
    "moseg_measures": ("measure", MeasureSpec),
    "moseg_fields": ("field", FieldSpec),
    "moseg_parameterizations": ("parameterization", ParameterizationSpec),
    "moseg_seeders": ("seeder", SeederSpec),
    "moseg_labelers": ("labeler", LabelerSpec),
    "moseg_optimizers": ("optimizer", OptimizerSpec),
    "moseg_refiners": ("refiner", RefinerSpec),
    "moseg_constraints": ("constraint", ConstraintSpec),
    "moseg_embeddings": ("embedding", EmbeddingSpec),
    "moseg_learners": ("learner", LearnerSpec),
    "moseg_recipes": ("recipe", RecipeSpec),
    "moseg_readers": ("reader", ReaderSpec),
    "moseg_writers": ("writer", WriterSpec),
    "moseg_commands": ("command", CommandSpec),
}
"""Each hook with the kind of component and the type of spec that it returns."""


@hookspec
def moseg_objectives() -> Sequence[ObjectiveSpec]:  # type: ignore[empty-body]  # a declaration
    """Objectives: costs of one part, several parts or the whole segmentation."""


@hookspec
def moseg_measures() -> Sequence[MeasureSpec]:  # type: ignore[empty-body]  # a declaration
    """Measures of a part that objectives, also those of other bundles, can share."""


@hookspec
def moseg_fields() -> Sequence[FieldSpec]:  # type: ignore[empty-body]  # a declaration
    """Fields: a number for each element, of which parts and boundaries have means."""


@hookspec
def moseg_parameterizations() -> Sequence[ParameterizationSpec]:  # type: ignore[empty-body]  # a declaration
    """Families of segmentations described by a vector of numbers."""


@hookspec
def moseg_seeders() -> Sequence[SeederSpec]:  # type: ignore[empty-body]  # a declaration
    """Initial placements of the centres."""


@hookspec
def moseg_labelers() -> Sequence[LabelerSpec]:  # type: ignore[empty-body]  # a declaration
    """Assignments of labels to centres."""


@hookspec
def moseg_optimizers() -> Sequence[OptimizerSpec]:  # type: ignore[empty-body]  # a declaration
    """Searches over the parameterization's vectors."""


@hookspec
def moseg_refiners() -> Sequence[RefinerSpec]:  # type: ignore[empty-body]  # a declaration
    """Ways to move the boundaries of what a search has found."""


@hookspec
def moseg_constraints() -> Sequence[ConstraintSpec]:  # type: ignore[empty-body]  # a declaration
    """Rules by which centres follow from others, or stay on something."""


@hookspec
def moseg_embeddings() -> Sequence[EmbeddingSpec]:  # type: ignore[empty-body]  # a declaration
    """Deformations of a shape in which the partition is found."""


@hookspec
def moseg_learners() -> Sequence[LearnerSpec]:  # type: ignore[empty-body]  # a declaration
    """Ways to learn a recipe from labelled examples."""


@hookspec
def moseg_recipes() -> Sequence[RecipeSpec]:  # type: ignore[empty-body]  # a declaration
    """Named problems: labels, expression and components, as TOML."""


@hookspec
def moseg_readers() -> Sequence[ReaderSpec]:  # type: ignore[empty-body]  # a declaration
    """File formats that shapes are read from."""


@hookspec
def moseg_writers() -> Sequence[WriterSpec]:  # type: ignore[empty-body]  # a declaration
    """File formats that results are written to."""


@hookspec
def moseg_commands() -> Sequence[CommandSpec]:  # type: ignore[empty-body]  # a declaration
    """Commands of the command line."""
