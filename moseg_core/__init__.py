"""moseg: people who know a shape tell the computer how to cut it into named parts.

::

    import moseg_core as moseg

    shape = moseg.load("hammer.ply")
    problem = moseg.Problem(["handle", "head"],
                            "3*narrow(handle) + perpendicular(handle, head) + convex_parts")
    result = moseg.segment(shape, problem, seed=0)
    moseg.save(result, "hammer.glb")

Names are imported when they are first used, so that ``moseg --help`` and the listing of plugins
load no numerical library.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOMES = {
    "CONTRACT": "contract",
    "ExpressionError": "errors",
    "MosegError": "errors",
    "PluginError": "errors",
    "ShapeError": "errors",
    "UsageError": "errors",
    "CommandSpec": "specs",
    "ConstraintSpec": "specs",
    "EmbeddingSpec": "specs",
    "LabelerSpec": "specs",
    "MeasureSpec": "specs",
    "ObjectiveSpec": "specs",
    "OptimizerSpec": "specs",
    "ParameterizationSpec": "specs",
    "ReaderSpec": "specs",
    "RecipeSpec": "specs",
    "SeederSpec": "specs",
    "WriterSpec": "specs",
    "hookimpl": "hookspecs",
    "registry": "plugins",
    "Shape": "shape",
    "capped_volume": "capped",
    "coarsen": "coarse",
    "Part": "part",
    "Segmentation": "segmentation",
    "Cost": "cost",
    "Interval": "parameters",
    "objective": "objectives",
    "constraint": "rules",
    "Batch": "protocols",
    "Centers": "protocols",
    "Constraint": "protocols",
    "Embedding": "protocols",
    "Progress": "protocols",
    "Seeding": "protocols",
    "Problem": "problem",
    "Hierarchy": "hierarchy",
    "Recipe": "recipe",
    "load_recipe": "recipe",
    "Evaluation": "aggregate",
    "Evaluator": "evaluation",
    "Result": "result",
    "Clipped": "clipping",
    "clip": "clipping",
    "clip_boundaries": "clipping",
    "segment": "pipeline",
    "segment_hierarchy": "nested",
    "refine": "nested",
    "load": "io",
    "save": "io",
    "sample_path": "samples",
    "sample_labels_path": "samples",
}

__all__ = ["__version__", *_HOMES]

if TYPE_CHECKING:
    from moseg_core.aggregate import Evaluation as Evaluation
    from moseg_core.capped import capped_volume as capped_volume
    from moseg_core.clipping import Clipped as Clipped
    from moseg_core.clipping import clip as clip
    from moseg_core.clipping import clip_boundaries as clip_boundaries
    from moseg_core.coarse import coarsen as coarsen
    from moseg_core.contract import CONTRACT as CONTRACT
    from moseg_core.cost import Cost as Cost
    from moseg_core.errors import ExpressionError as ExpressionError
    from moseg_core.errors import MosegError as MosegError
    from moseg_core.errors import PluginError as PluginError
    from moseg_core.errors import ShapeError as ShapeError
    from moseg_core.errors import UsageError as UsageError
    from moseg_core.evaluation import Evaluator as Evaluator
    from moseg_core.hierarchy import Hierarchy as Hierarchy
    from moseg_core.hookspecs import hookimpl as hookimpl
    from moseg_core.io import load as load
    from moseg_core.io import save as save
    from moseg_core.nested import refine as refine
    from moseg_core.nested import segment_hierarchy as segment_hierarchy
    from moseg_core.objectives import objective as objective
    from moseg_core.parameters import Interval as Interval
    from moseg_core.part import Part as Part
    from moseg_core.pipeline import segment as segment
    from moseg_core.plugins import registry as registry
    from moseg_core.problem import Problem as Problem
    from moseg_core.protocols import Batch as Batch
    from moseg_core.protocols import Centers as Centers
    from moseg_core.protocols import Constraint as Constraint
    from moseg_core.protocols import Embedding as Embedding
    from moseg_core.protocols import Progress as Progress
    from moseg_core.protocols import Seeding as Seeding
    from moseg_core.recipe import Recipe as Recipe
    from moseg_core.recipe import load_recipe as load_recipe
    from moseg_core.result import Result as Result
    from moseg_core.rules import constraint as constraint
    from moseg_core.samples import sample_labels_path as sample_labels_path
    from moseg_core.samples import sample_path as sample_path
    from moseg_core.segmentation import Segmentation as Segmentation
    from moseg_core.shape import Shape as Shape
    from moseg_core.specs import CommandSpec as CommandSpec
    from moseg_core.specs import ConstraintSpec as ConstraintSpec
    from moseg_core.specs import EmbeddingSpec as EmbeddingSpec
    from moseg_core.specs import LabelerSpec as LabelerSpec
    from moseg_core.specs import MeasureSpec as MeasureSpec
    from moseg_core.specs import ObjectiveSpec as ObjectiveSpec
    from moseg_core.specs import OptimizerSpec as OptimizerSpec
    from moseg_core.specs import ParameterizationSpec as ParameterizationSpec
    from moseg_core.specs import ReaderSpec as ReaderSpec
    from moseg_core.specs import RecipeSpec as RecipeSpec
    from moseg_core.specs import SeederSpec as SeederSpec
    from moseg_core.specs import WriterSpec as WriterSpec


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    value = getattr(importlib.import_module(f"{__name__}.{home}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
