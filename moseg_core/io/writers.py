"""The formats that a result is saved in: functions of a result that return bytes.

They add nothing that depends on when or where they run: equal results give equal bytes.
"""

from __future__ import annotations

import json
import math
from typing import Any

from moseg_core.aggregate import Evaluation
from moseg_core.hierarchy import Hierarchy
from moseg_core.io.encode_arrays import check_grid, encode_npy, encode_npz
from moseg_core.io.encode_glb import encode_glb
from moseg_core.io.encode_ply import encode_ply, encode_points_ply
from moseg_core.io.labels import encode_seg
from moseg_core.io.saved import FORMAT
from moseg_core.mesh import PolygonMesh
from moseg_core.palette import part_colors
from moseg_core.problem import Problem
from moseg_core.result import Result
from moseg_core.shape import Shape
from moseg_core.splats import drawable


def write_json(result: Result) -> bytes:
    """Everything there is to know of a result but the geometry; read by ``moseg explain``."""
    shape, segmentation = result.shape, result.segmentation
    document: dict[str, Any] = {
        "format": FORMAT,
        "shape": {
            "name": shape.name,
            "elements": shape.n_elements,
            "fingerprint": shape.fingerprint,
            "notes": list(shape.notes),
        },
        "problem": _problem_document(result.problem),
        **evaluation_document(result.evaluation),
        "parts": [
            {
                "label": name,
                "elements": part.n_elements,
                "area": part.area,
                "center": center.tolist(),
                "weight": float(weight),
            }
            for name, part, center, weight in zip(
                result.problem.labels,
                segmentation.parts,
                result.centers.positions,
                result.centers.weights,
                strict=True,
            )
        ],
        "method": dict(result.method),
        "dimension": {"free": result.dimension[0], "all": result.dimension[1]},
        "seed": result.seed,
        "reason": result.reason,
        "warnings": list(result.warnings),
        "versions": dict(result.versions),
        "history": {
            stage: [
                {key: value if math.isfinite(value) else None for key, value in record.items()}
                for record in records
            ]
            for stage, records in result.history.items()
        },
        "labels": result.labels.tolist(),
    }
    # One line per entry: readable, and a change of one number is a change of one line.
    lines = [f"{json.dumps(key)}: {_dump(value)}" for key, value in document.items()]
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()


def _problem_document(problem: Problem | Hierarchy) -> dict[str, Any]:
    """Labels and expression; constraints, embedding and further levels where there are any."""
    if isinstance(problem, Hierarchy):
        levels = [
            {"path": path, **_problem_document(level.problem)} for path, level in problem.levels()
        ]
        return {**_problem_document(problem.problem), "labels": problem.labels, "levels": levels}
    document: dict[str, Any] = {
        "labels": list(problem.labels),
        "minimize": str(problem.expression),
    }
    if problem.rules:
        document["constraints"] = [rule.text for rule in problem.rules]
    if problem.plane is not None:
        document["plane"] = problem.plane
    if problem.embedding is not None:
        document |= {"embedding": str(problem.embedding), "space": problem.space}
    return document


def evaluation_document(evaluation: Evaluation) -> dict[str, Any]:
    """Cost and terms as plain data, for JSON."""
    return {
        "cost": {
            "value": evaluation.cost.value,
            "empty": list(evaluation.empty),
            "broken_pins": evaluation.broken_pins,
        },
        "terms": [
            {
                "term": term.text,
                "objective": term.objective,
                "weight": term.weight,
                "value": term.value,
                "weighted": term.weighted,
                "worst": term.worst if math.isfinite(term.worst) else None,
                "calls": [
                    {"labels": list(call.labels), "value": call.value} for call in term.calls
                ],
            }
            for term in evaluation.terms
        ],
    }


def write_seg(result: Result) -> bytes:
    """One label number a line, element by element."""
    return encode_seg(result.labels)


def write_ply(result: Result) -> bytes:
    """The input's polygons, or a clipped result's pieces; else a point for every element.

    Each with its colour and label.
    """
    names, (surface, labels) = result.problem.labels, result.surface
    colors = part_colors(len(names))
    if not isinstance(surface, PolygonMesh):
        return encode_points_ply(result.shape, labels, names, colors)
    source = None if result.clipped is None else result.clipped.source
    return encode_ply(surface, labels, names, colors, source=source)


def write_npz(result: Result) -> bytes:
    """Labels, names, places and areas as arrays."""
    return encode_npz(result.shape, result.labels, result.problem.labels)


def write_npy(result: Result) -> bytes:
    """The voxel grid with the label of each cell."""
    return encode_npy(result.shape, result.labels, result.problem.labels)


def check_writable(suffix: str, shape: Shape) -> None:
    """Refuse before the search what the writer of a suffix would refuse after it.

    Parameters
    ----------
    suffix : str
        Such as ".npy".
    shape : Shape

    Raises
    ------
    UsageError
        The format cannot hold such a shape.
    """
    if suffix.lower() == ".npy":
        check_grid(shape)


def write_glb(result: Result) -> bytes:
    """A scene with one coloured node per part, named by its label."""
    names, (mesh, labels) = result.problem.labels, result.surface
    return encode_glb(drawable(mesh), labels, names, part_colors(len(names)))


def _dump(value: Any) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False)
