"""``moseg explain``: the cost of a result, or of any labelling, by term and part."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from moseg_core.cli.console import message, print_json, print_terms
from moseg_core.cli.flags import ProblemFlags, ShapeFlags
from moseg_core.cli.reading import limits_of, matched_labels, read_label_property, read_shape
from moseg_core.cli.request import read_statement, read_variants
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import UsageError
from moseg_core.io import Labelling, read_labels, read_result
from moseg_core.io.result_json import evaluation_document
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.label_sets import set_text
from moseg_core.problem.statement import SEPARATOR, Statement
from moseg_core.problem.variants import Variants
from moseg_core.search.result import find_warnings


def run_explain(
    source: Path,
    *,
    problem_flags: ProblemFlags,
    parts: Path | None,
    label_property: str | None,
    reading: ShapeFlags,
    as_json: bool,
) -> None:
    """Explain a saved result, or evaluate a labelling of a shape."""
    if source.suffix.lower() == ".json" and parts is None:
        if problem_flags.anything:
            raise UsageError(
                f"'{source}' is a result and brings its own problem; to evaluate its labels under"
                f" another one, give the mesh and --parts {source}"
            )
        saved = read_result(source)
        evaluation, warnings = saved.evaluation, saved.warnings
    else:
        if parts is None:
            raise UsageError(f"'{source}' is a shape: give the labelling to explain with --parts")
        stated = read_statement(problem_flags)
        variants = None if stated.is_open else read_variants(problem_flags)
        shape = read_shape(source, reading)
        # A cost is that of all elements.
        asked = read_label_property(label_property)
        labelling = read_labels(
            parts, shape, label_property=asked, fill=True, limits=limits_of(reading)
        )
        for note in labelling.notes:
            message(note)
        if variants is None:
            stated, labelling = _numbered(stated, labelling)
            variants = Variants.of(stated)
        problem = _fitting(variants, labelling)
        if labelling.names is not None:
            problem = problem.fitted(labelling.names)
        matched = matched_labels(labelling, problem.labels, parts)
        evaluation = problem.evaluate(shape, matched)
        segmentation = Segmentation.from_labels(shape, matched, len(problem.labels))
        warnings = find_warnings(evaluation, segmentation, problem.labels, "converged")
    for warning in warnings:
        message(f"warning: {warning}")
    if as_json:
        print_json(evaluation_document(evaluation))
    else:
        print_terms(evaluation)


def _numbered(stated: Statement, labelling: Labelling) -> tuple[Statement, Labelling]:
    """An open statement with as many parts as a labelling has, and the labelling in its names.

    Names that are not the statement's are numbered in the order of the file, which is said.
    """
    if labelling.names is None:
        return stated.with_parts(int(labelling.labels.max()) + 1), labelling
    wholes = [name.partition(SEPARATOR)[0] for name in labelling.names]
    fixed = [label for label in stated.labels if not label.endswith("*")]
    others = [name for name in dict.fromkeys(wholes) if name not in fixed]
    stated = stated.with_parts(len(fixed) + len(others))
    numbered = [label for label in stated.labels if label not in fixed]
    if set(others) == set(numbered):
        return stated, labelling
    called = dict(zip(others, numbered, strict=True))
    message(", ".join(f"{label} is '{name}'" for name, label in called.items()))
    names = tuple(
        called.get(whole, whole) + name[len(whole) :]
        for name, whole in zip(labelling.names, wholes, strict=True)
    )
    return stated, replace(labelling, names=names)


def _fitting(variants: Variants, labelling: Labelling) -> Hierarchy:
    """The problem for the label set that a labelling has, which is said where there are several."""
    if len(variants.tasks) == 1:
        return variants.tasks[0]
    if labelling.names is None:
        count = int(labelling.labels.max()) + 1
        able = [task for task in variants.tasks if len(task.problem.labels) == count]
        if len(able) != 1:
            raise UsageError(
                f"the labelling has {count} labels without names, and {len(able) or 'no'} label"
                f' sets have as many; name the labels: --labels "{variants.texts[-1]}"'
            )
        found = able[0]
    else:
        used = [labelling.names[k] for k in np.unique(labelling.labels)]
        found = variants.fitting(name.partition(SEPARATOR)[0] for name in used)
    message(f"label set: {set_text(found.problem.labels, variants.statement.labels)}")
    return found
