"""Results as ``.json``: all but the geometry, written, and read back to be explained and used."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Centers
from moseg_core.errors import UsageError
from moseg_core.problem.aggregate import CallValue, Evaluation, TermValue
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.search.result import Result
from moseg_core.types import IntArray

FORMAT = "moseg-result/1"
"""What a result file says it is; the number rises when old readers would misread it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SavedResult:
    """A result as its ``.json`` tells it.

    Parameters
    ----------
    shape : mapping
        Name, number of elements, fingerprint and notes of the shape.
    labels : (F,) int
    names : tuple of str
        The problem's labels.
    minimize : str
        The problem's expression.
    constraints : tuple of str
    plane, embedding, space : str or None
        What else belongs to the problem; of several levels that of the first.
    levels : tuple of mapping
        Path, labels and expression of every level of a hierarchy; else empty.
    evaluation : Evaluation
    centers : Centers
    method : mapping of str to str
    seed : int
    reason : str
    warnings : tuple of str
    versions : mapping of str to str
    history : mapping of str to list of dict
    """

    shape: Mapping[str, Any]
    labels: IntArray
    names: tuple[str, ...]
    minimize: str
    constraints: tuple[str, ...]
    plane: str | None
    embedding: str | None
    space: str | None
    evaluation: Evaluation
    centers: Centers
    method: Mapping[str, str]
    seed: int
    reason: str
    warnings: tuple[str, ...]
    versions: Mapping[str, str]
    history: Mapping[str, list[dict[str, float]]]
    levels: tuple[Mapping[str, Any], ...] = ()


def read_result(path: Path) -> SavedResult:
    """Read a result file.

    Raises
    ------
    UsageError
        The file cannot be read, or is not a result that this version understands.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise UsageError(f"'{path}' cannot be read as a result: {error}") from error
    if not isinstance(document, dict) or "format" not in document:
        raise UsageError(f"'{path}' is not a moseg result; make one with 'moseg segment -o x.json'")
    if document["format"] != FORMAT:
        raise UsageError(
            f"'{path}' has the format {document['format']!r}; this version reads {FORMAT!r}"
        )
    try:
        return _from_document(document)
    except (KeyError, TypeError, ValueError) as error:
        raise UsageError(
            f"'{path}' is a damaged result ({type(error).__name__}: {error}); make it anew"
        ) from error


def _from_document(document: dict[str, Any]) -> SavedResult:
    terms = tuple(
        TermValue(
            text=term["term"],
            objective=term["objective"],
            weight=float(term["weight"]),
            calls=tuple(
                CallValue(
                    labels=tuple(call["labels"]),
                    value=None if call["value"] is None else float(call["value"]),
                )
                for call in term["calls"]
            ),
            worst=math.inf if term["worst"] is None else float(term["worst"]),
        )
        for term in document["terms"]
    )
    cost = document["cost"]
    parts = document["parts"]
    problem = document["problem"]
    return SavedResult(
        shape=document["shape"],
        labels=np.array(document["labels"], np.int64),
        names=tuple(problem["labels"]),
        minimize=problem["minimize"],
        constraints=tuple(problem.get("constraints", ())),
        plane=problem.get("plane"),
        embedding=problem.get("embedding"),
        space=problem.get("space"),
        evaluation=Evaluation(
            cost=Cost(len(cost["empty"]) + int(cost["broken_pins"]), float(cost["value"])),
            terms=terms,
            empty=tuple(cost["empty"]),
            broken_pins=cost["broken_pins"],
        ),
        centers=Centers(
            positions=np.array([part["center"] for part in parts]),
            weights=np.array([part["weight"] for part in parts]),
        ),
        method=document["method"],
        seed=document["seed"],
        reason=document["reason"],
        warnings=tuple(document["warnings"]),
        versions=document["versions"],
        history=document["history"],
        levels=tuple(problem.get("levels", ())),
    )


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


def _dump(value: Any) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False)
