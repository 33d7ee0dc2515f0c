"""Results read back from ``.json``: enough to explain them and to use their labels."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from moseg_core.aggregate import CallValue, Evaluation, TermValue
from moseg_core.cost import Cost
from moseg_core.errors import UsageError
from moseg_core.protocols import Centers
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
        What else belongs to the problem.
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
    )
