"""``moseg export``: other files of a saved result, without another search.

A file of labels, corrected by hand, may stand in for those of the result: its cost is then that of
the corrected labels, and a warning in the files says where they come from.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from moseg_core.cli.console import message
from moseg_core.cli.flags import PartFlags, ShapeFlags
from moseg_core.cli.interrupt import stop_on_interrupt
from moseg_core.cli.reading import limits_of, matched_labels, read_label_property, read_shape
from moseg_core.cli.saving import check_outputs, check_saving, raise_last, save_outputs
from moseg_core.cli.working_folder import working_folder_kept
from moseg_core.errors import UsageError
from moseg_core.io import load_result, read_labels, read_result
from moseg_core.io.part_files import PartForm
from moseg_core.io.read.limits import ReadLimits
from moseg_core.io.result_loading import find_shape
from moseg_core.search.result import Result, find_warnings


def run_export(
    source: Path,
    labels: Path | None,
    *,
    shapes: Path | None,
    label_property: str | None,
    reading: ShapeFlags,
    part_flags: PartFlags,
    outputs: Sequence[Path],
) -> None:
    """Read the result, and write what was asked for."""
    if not outputs:
        raise UsageError("say what to write: -o hammer.obj, or -o 'parts/{part}.stl'")
    form = PartForm(
        close=part_flags.close, hulls=part_flags.hulls, hull_vertices=part_flags.hull_vertices
    )
    check_outputs(outputs, form, read=[source, *([labels] if labels else [])])
    folders = [] if shapes is None else [shapes]
    saved = read_result(source)
    shape = find_shape(saved, source, folders=folders, read=lambda file: read_shape(file, reading))
    result = load_result(source, shape)
    if labels is not None:
        with working_folder_kept():
            result = _relabelled(result, labels, label_property, limits_of(reading))
    check_saving(shape, outputs, form)
    with stop_on_interrupt(wanted=True) as stop:
        stop.writing()
        written, failures, notes = save_outputs(result, outputs, Path(shape.file), form)
    for note in notes:
        message(note)
    if written:
        message(f"wrote {', '.join(written)}")
    raise_last(failures)
    stop.raise_if_asked()


def _relabelled(
    result: Result, path: Path, label_property: str | None, limits: ReadLimits
) -> Result:
    """The result with other labels, and their cost."""
    asked = read_label_property(label_property)
    labelling = read_labels(path, result.shape, label_property=asked, fill=True, limits=limits)
    for note in labelling.notes:
        message(note)
    labels = matched_labels(labelling, result.problem.labels, path).astype(np.int32)
    if labels.min() < 0 or labels.max() >= len(result.problem.labels):
        raise UsageError(
            f"'{path}' has labels up to {labels.max()}, and the result has"
            f" {len(result.problem.labels)} parts, counted from 0"
        )
    changed = int((labels != result.labels).sum())
    evaluation = result.problem.evaluate(result.shape, labels)
    message(
        f"{changed} of {len(labels)} {result.shape.noun}s have another label;"
        f" cost {evaluation.cost.value:.6g}, before {result.cost:.6g}"
    )
    found = replace(result, labels=labels, evaluation=evaluation, warnings=())
    warnings = find_warnings(evaluation, found.segmentation, found.problem.labels, "converged")
    return replace(found, warnings=(f"labels are those of '{path.name}'", *warnings))
