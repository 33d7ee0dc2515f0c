"""Results as ``.json``: all but the geometry, written, and read back to be explained and used."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.detail import Detail
from moseg_core.components.protocols import Centers
from moseg_core.errors import UsageError, unknown
from moseg_core.io.byte_names import path_entries, readable, with_path
from moseg_core.io.json_document import read_json_file
from moseg_core.io.result_schema import RESULT, check_schema
from moseg_core.language import parse_target
from moseg_core.problem.aggregate import CallValue, Evaluation, TermValue
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import DEEPEST
from moseg_core.problem.settings import NO_REFINER, RECIPE_OPTIONS, SearchOptions
from moseg_core.problem.statement import (
    KEYS,
    SEPARATOR,
    Statement,
    check_extent,
    check_label_names,
    joined,
)
from moseg_core.search.incumbents import Incumbent
from moseg_core.search.result import Result
from moseg_core.types import IntArray
from moseg_core.untrusted.terminal import escaped, printable

FORMAT = "moseg-result/1"
"""What a result file says it is; the number rises when old readers would misread it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SavedResult:
    """A result as its ``.json`` tells it.

    Parameters
    ----------
    shape : mapping
        Name, file, number of elements, fingerprint and notes of the shape.
    labels : (F,) int
    names : tuple of str
        What the labels are called: of several levels the leaves' paths.
    statement : Statement
        What was asked for; :meth:`search` has how it was searched.
    evaluation : Evaluation
    centers : Centers
    method : mapping of str to str
    seed : int
    reason : str
    warnings : tuple of str
    versions : mapping of str to str
    history : mapping of str to list of dict
    dimension : (int, int)
        How many numbers the search had to find, and how many describe the segmentation.
    incumbents : tuple of Incumbent
        Empty where the file, an older one perhaps, has none.
    """

    shape: Mapping[str, Any]
    labels: IntArray
    names: tuple[str, ...]
    statement: Statement
    evaluation: Evaluation
    centers: Centers
    method: Mapping[str, str]
    seed: int
    reason: str
    warnings: tuple[str, ...]
    versions: Mapping[str, str]
    history: Mapping[str, list[dict[str, float]]]
    dimension: tuple[int, int] = (0, 0)
    incumbents: tuple[Incumbent, ...] = ()

    def search(self, path: str = "") -> SearchOptions:
        """The search options that a level's run had settled on, the whole's by default.

        Raises
        ------
        UsageError
            There is no such level.
        """
        front = f"{path}: " if path else ""
        if front + "optimizer" not in self.method:
            raise UsageError(unknown("level", path, [p for p, _ in self.statement.levels()]))
        # What a result of an earlier version does not say was as the settings say.
        unsaid: dict[str, Any] = {front + "refiner": NO_REFINER, front + "polished": None}
        settled = unsaid | dict(self.method)
        options: Any = {key: settled[front + key] for key in RECIPE_OPTIONS}
        return SearchOptions(
            **options,
            settings=self.method[front + "settings"],
            seed=self.seed,
            ignore_pieces_below=self.method.get(front + "ignore_pieces_below", 0.0),
        )


def read_result(path: str | os.PathLike[str]) -> SavedResult:
    """Read a result file.

    Parameters
    ----------
    path : path-like

    Raises
    ------
    UsageError
        The file cannot be read, or is not a result that this version understands.
    """
    path = Path(path)
    try:
        document = read_json_file(path)
    except OSError as error:
        raise UsageError(
            f"'{path}' cannot be read as a result: {error.strerror or error}"
        ) from error
    except ValueError as error:
        raise UsageError(f"'{path}' cannot be read as a result: {error}") from error
    if not isinstance(document, dict) or "format" not in document:
        raise UsageError(f"'{path}' is not a moseg result; make one with 'moseg segment -o x.json'")
    if document["format"] != FORMAT:
        raise UsageError(
            f"'{path}' has the format {document['format']!r:.60}; this version reads {FORMAT!r}"
        )
    try:
        check_schema(document, RESULT)
        return _from_document(document)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        what = f"no {error}" if isinstance(error, KeyError) else printable(str(error), longest=300)
        raise UsageError(f"'{path}' is a damaged result ({what}); make it anew") from error


def is_result(path: Path) -> bool:
    """Whether a file is a result of moseg, not labels alone.

    Raises
    ------
    UsageError
        It cannot be read as JSON.
    """
    if path.suffix.lower() != ".json":
        return False
    try:
        document = read_json_file(path)
    except OSError as error:
        raise UsageError(f"'{path}' cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        raise UsageError(f"'{path}' is not JSON: {error}") from error
    return isinstance(document, dict) and "format" in document


def _from_document(document: dict[str, Any]) -> SavedResult:
    """The result that a document tells, which agrees with itself.

    Raises
    ------
    KeyError, TypeError, ValueError, OverflowError
        It does not.
    """
    terms = tuple(
        TermValue(
            text=term["term"],
            objective=term["objective"],
            weight=float(term["weight"]),
            calls=tuple(
                CallValue(
                    labels=tuple(call["labels"]),
                    value=None if call["value"] is None else float(call["value"]),
                    details=tuple(_read_detail(detail) for detail in call.get("details", [])),
                )
                for call in term["calls"]
            ),
            worst=math.inf if term["worst"] is None else float(term["worst"]),
        )
        for term in document["terms"]
    )
    cost = document["cost"]
    centers = Centers.joined([_read_centers(part) for part in document["parts"]])
    problem = document["problem"]
    statement, names = _read_statement(problem), tuple(problem["labels"])
    if names != _leaves(statement):
        raise ValueError(f"the labels {', '.join(names)} are not those of the problem")
    if len(document["parts"]) != len(names):
        raise ValueError(f"{len(names)} labels, but {len(document['parts'])} parts")
    if cost["broken_pins"] > document["shape"]["elements"]:
        raise ValueError(f"{cost['broken_pins']} broken pins")
    return SavedResult(
        shape=with_path(document["shape"]),
        labels=_read_labels(document["labels"], document["shape"]["elements"], len(names)),
        names=names,
        statement=statement,
        evaluation=Evaluation(
            cost=Cost(len(cost["empty"]) + int(cost["broken_pins"]), float(cost["value"])),
            terms=terms,
            empty=tuple(cost["empty"]),
            broken_pins=cost["broken_pins"],
        ),
        centers=centers,
        method=document["method"],
        seed=document["seed"],
        reason=document["reason"],
        warnings=tuple(document["warnings"]),
        versions=document["versions"],
        history=document["history"],
        dimension=_read_dimension(document.get("dimension", {})),
        incumbents=tuple(_read_incumbent(step, centers) for step in document.get("incumbents", [])),
    )


def _read_labels(given: Any, n_elements: int, n_labels: int) -> IntArray:
    labels = np.array(given) if isinstance(given, list) else np.empty(0)
    if labels.dtype.kind not in "iu" or labels.shape != (n_elements,) or not n_elements:
        raise ValueError(f"the labels are not a whole number for each of {n_elements} elements")
    if labels.min() < 0 or labels.max() >= n_labels:
        raise ValueError(f"the label {labels.max()}, but only {n_labels} labels, counted from 0")
    return labels.astype(np.int64)


def _read_dimension(document: Mapping[str, Any]) -> tuple[int, int]:
    return int(document.get("free", 0)), int(document.get("all", 0))


def write_json(result: Result) -> bytes:
    """Everything there is to know of a result but the geometry; read by ``moseg explain``."""
    shape, segmentation = result.shape, result.segmentation
    document: dict[str, Any] = {
        "format": FORMAT,
        "shape": {
            "name": readable(shape.name),
            **(path_entries(shape.file) if shape.file else {}),
            "elements": shape.n_elements,
            "fingerprint": shape.fingerprint,
            "notes": [readable(note) for note in shape.notes],
        },
        "problem": _problem_document(result.problem),
        **evaluation_document(result.evaluation),
        "parts": [
            {
                "label": name,
                "elements": part.n_elements,
                "area": part.area,
                **_centers_document(result.centers.of(k)),
            }
            for k, (name, part) in enumerate(
                zip(result.problem.labels, segmentation.parts, strict=True)
            )
        ],
        "method": dict(result.method),
        "dimension": {"free": result.dimension[0], "all": result.dimension[1]},
        "seed": result.seed,
        "reason": result.reason,
        "warnings": [escaped(readable(warning)) for warning in result.warnings],
        "versions": dict(result.versions),
        "history": {
            stage: [
                {key: value if math.isfinite(value) else None for key, value in record.items()}
                for record in records
            ]
            for stage, records in result.history.items()
        },
        **(
            {"incumbents": [_incumbent_document(step) for step in result.incumbents]}
            if result.incumbents
            else {}
        ),
        "labels": result.labels.tolist(),
    }
    # One line per entry: readable, and a change of one number is a change of one line.
    lines = [f"{json.dumps(key)}: {_dump(value)}" for key, value in document.items()]
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()


def _centers_document(centers: Centers) -> dict[str, Any]:
    """A part's centre and weight, and under "more" those of its others, where it has any."""
    first, *more = [
        {"center": position.tolist(), "weight": float(weight)}
        for position, weight in zip(centers.positions, centers.weights, strict=True)
    ]
    return {**first, **({"more": more} if more else {})}


def _read_centers(part: Mapping[str, Any]) -> Centers:
    """The centres that :func:`_centers_document` wrote."""
    rows = [part, *part.get("more", [])]
    return Centers(
        positions=np.array([row["center"] for row in rows], np.float64),
        weights=np.array([row["weight"] for row in rows], np.float64),
        parts=np.zeros(len(rows), np.int64) if len(rows) > 1 else None,
    )


def _incumbent_document(step: Incumbent) -> dict[str, Any]:
    """An incumbent; of each centre position and weight, in the order of the parts."""
    rows = np.column_stack([step.centers.positions, step.centers.weights])
    return {
        "stage": step.stage,
        "evaluations": step.evaluations,
        "value": step.cost.value,
        "empty": step.cost.empty,
        "centers": rows.tolist(),
    }


def _read_incumbent(document: Mapping[str, Any], like: Centers) -> Incumbent:
    """The incumbent that :func:`_incumbent_document` wrote; its parts have centres as the result's.

    Raises
    ------
    KeyError, TypeError, ValueError
        It is none.
    """
    rows = np.array(document["centers"], np.float64)
    if rows.shape != (len(like.weights), 4):
        raise ValueError("an incumbent has another number of centres than the result")
    value = float(document["value"])
    if not (np.isfinite(rows).all() and (rows[:, 3] > 0.0).all() and math.isfinite(value)):
        raise ValueError("an incumbent has a centre, a weight or a cost that is none")
    return Incumbent(
        stage=str(document["stage"]),
        evaluations=int(document["evaluations"]),
        cost=Cost(int(document["empty"]), value),
        centers=replace(like, positions=rows[:, :3].copy(), weights=rows[:, 3].copy()),
    )


def _problem_document(problem: Problem | Hierarchy) -> dict[str, Any]:
    """The statement of a problem; of several levels one after the other, with their paths.

    How each was searched stands under "method", settled, and is not repeated here.
    """
    if isinstance(problem, Hierarchy):
        levels = [
            {"path": path, **_problem_document(level.problem)} for path, level in problem.levels()
        ]
        return {**_problem_document(problem.problem), "labels": problem.labels, "levels": levels}
    return problem.statement.document()


def _read_statement(problem: Mapping[str, Any]) -> Statement:
    """The statement that :func:`_problem_document` wrote."""
    tables = {level["path"]: level for level in problem.get("levels", [{**problem, "path": ""}])}

    def read(path: str) -> Statement:
        if path.count(SEPARATOR) > DEEPEST:
            raise ValueError(f"parts of parts that are more than {DEEPEST} levels deep")
        # What a later version adds is passed over: the format's number says what can be read.
        table = {key: value for key, value in tables[path].items() if key in KEYS}
        check_label_names(table["labels"])  # one without letters would be its own part
        below = {label: joined(path, label) for label in table["labels"]}
        parts = tuple((label, read(inner)) for label, inner in below.items() if inner in tables)
        stated = Statement.read(table)
        return replace(stated, parts=parts)

    stated = read("")
    check_extent(stated, "the problem")
    return stated


def _leaves(statement: Statement) -> tuple[str, ...]:
    """The labels of a result of a problem: those of parts with their paths, in their places."""
    divided = dict(statement.parts)
    leaves: list[str] = []
    for label in statement.labels:
        below = _leaves(divided[label]) if label in divided else ()
        leaves += [joined(label, leaf) for leaf in below] or [label]
    return tuple(leaves)


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
                "calls": [_call_document(call) for call in term.calls],
            }
            for term in evaluation.terms
        ],
    }


def _call_document(call: CallValue) -> dict[str, Any]:
    """A call as plain data; without details where the objective tells none."""
    details = [
        {
            "name": detail.name,
            "value": detail.value,
            "cost": detail.cost,
            "expected": None if detail.expected is None else str(detail.expected),
            "percent": detail.percent,
        }
        for detail in call.details
    ]
    said = {"labels": list(call.labels), "value": call.value}
    return {**said, "details": details} if details else said


def _read_detail(document: Mapping[str, Any]) -> Detail:
    """The detail that :func:`_call_document` wrote."""
    expected = document["expected"]
    return Detail(**{**document, "expected": None if expected is None else parse_target(expected)})


def _dump(value: Any) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False)
