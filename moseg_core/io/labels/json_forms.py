"""Labels in JSON: lists, maps, and what some programs build of them.

======================================================  ==========================================
form                                                    who
======================================================  ==========================================
``[0, 1, 1]``, ``["leg", "body"]``                      anyone
``{"0": 1, "1": 0}``: the label of each face            SAMesh
``{"body": [0, 2], "leg": [1]}``, ``[[0, 2], [1]]``     the faces of each label
``[{"name": "leg", "faces": [1]}, ...]``                the same, as records
``{"labels": ..., "names": [...]}``                     any of these as a member, under a usual name
``{"labels": [...], "problem": {"labels": [...]}}``     a result of moseg
``{"segIndices": [...]}``, maybe with ``"segGroups"``   ScanNet: of vertices; groups name objects
======================================================  ==========================================

``null`` and -1 say that there is no label; so does a map, or list of faces, that leaves a face out.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from moseg_core.io.json_document import MOST_BYTES, parse_json
from moseg_core.io.labels.listing import (
    Listing,
    Of,
    Wanted,
    labels_of_ids,
    numbered_names,
    whole_labels,
)
from moseg_core.io.labels.properties import chosen, familiar, names_labels, plain
from moseg_core.io.read.checked import file_error, read_file
from moseg_core.types import UNLABELLED, IntArray

_FORMS = (
    'allowed are a list with a label for each face, a map from face to label {"0": 1}, faces by'
    ' label {"body": [0, 2]}, any of these as a member "labels", a result of moseg, and ScanNet\'s'
    ' "segIndices"'
)
_NUMBER = re.compile(r"-?[0-9]{1,18}")
_RECORDS = (
    "part",
    "segment",
    "label",
    "group",
    "object",
    "region",
    "annotation",
    "face",
    "seggroup",
)
_CALLED = ("name", "label", "part", "class", "category", "tag", "segment", "object", "id")
# What a record says that its ids are of, the surest first.
_BEARERS = (
    *("face", "triangle", "element", "indice", "index", "polygon"),
    *("vertex", "vertice", "point", "vert"),
)


def read_json(path: Path, wanted: Wanted) -> Listing:
    """Read labels from JSON.

    Parameters
    ----------
    path : Path
    wanted : Wanted

    Raises
    ------
    ShapeError
        The file cannot be read, is not JSON, or has none of the forms.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "a.json"
    ...     _ = file.write_text('{"0": 1, "2": 0}')
    ...     read_json(file, Wanted(n_elements=3)).labels.tolist()
    [1, -1, 0]
    """
    try:
        document = parse_json(read_file(path, most=MOST_BYTES))
    except ValueError as error:
        raise file_error(path, f"is not JSON ({error}); {_FORMS}") from error
    if isinstance(document, dict):
        return _member(path, document, wanted)
    return _labels(path, document, wanted)


def _member(path: Path, document: dict[str, Any], wanted: Wanted) -> Listing:
    """Labels from the document's outermost object: itself, or a member of it."""
    if not wanted.properties:
        if "segIndices" in document:
            return _of_segments(path, document, wanted)
        if "segGroups" in document:
            other = document.get("segmentsFile", "the file that ends in .segs.json")
            raise file_error(
                path, f"groups segments and has none itself; give {other!s}, which has segIndices"
            )
        if _is_map(document):
            return _labels(path, document, wanted)
    held = [key for key, value in document.items() if isinstance(value, list | dict)]
    # The names of labels are no labels where something else is.
    candidates = [key for key in held if not _is_names(key, document[key], wanted)] or held
    if not wanted.properties:  # what has as many as there are elements is the better choice
        fitting = [key for key in candidates if len(document[key]) in _counts(wanted)]
        candidates = fitting if familiar(fitting) else candidates
    name, notes = chosen(path, "member", candidates, wanted.properties)
    if name is None:
        records = [key for key in held if plain(key) in _RECORDS]
        name = records[0] if records else None
    if name is None:
        return _labels(path, document, wanted)
    told = wanted.told(name)
    found = _labels(path, document[name], told)
    of: Of = "vertices" if name == "segIndices" else found.of
    names = found.names
    if names is None:
        names = _names(path, document, name, wanted)
    return Listing(
        labels=found.labels,
        names=names,
        of=told.bearer if of == "unsaid" else of,
        notes=(*notes, *found.notes),
    )


def _is_names(key: str, value: Any, wanted: Wanted) -> bool:
    """Whether a member says what labels are called: a list or numbered map of texts."""
    texts = list(value.values()) if isinstance(value, dict) else value
    return (
        isinstance(texts, list)
        and all(isinstance(text, str) for text in texts)
        and names_labels(key, len(texts), _counts(wanted))
    )


def _names(
    path: Path, document: Mapping[str, Any], labels: str, wanted: Wanted
) -> tuple[str, ...] | None:
    """What the document says that labels are called."""
    problem = document.get("problem", {})
    names, where = None, ""
    if isinstance(problem, dict) and problem.get("labels") is not None:
        names, where = problem["labels"], "problem.labels"
    else:
        for key, value in document.items():
            if key == "names" or (key != labels and _is_names(key, value, wanted)):
                names, where = value, key
                break
    if isinstance(names, dict) and all(map(_NUMBER.fullmatch, names)):
        numbered = {int(key): value for key, value in names.items()}
        last = max(numbered, default=-1)
        if min(numbered, default=0) >= 0 and last < 10 * len(numbered) + 100:
            names = [numbered.get(k, f"label {k}") for k in range(last + 1)]
    if names is None:
        return None
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise file_error(path, f"has a member {where} that is not a list of names")
    return tuple(names)


def _labels(path: Path, value: Any, wanted: Wanted) -> Listing:
    """Labels from a list or a map."""
    if isinstance(value, dict):
        return _of_map(path, value, wanted)
    if not isinstance(value, list):
        _refuse(path, f"has {type(value).__name__} where labels are looked for")
    if all(isinstance(item, dict) for item in value) and value:
        return _of_records(path, value, wanted)
    if all(isinstance(item, list) for item in value) and value:
        if all(len(item) == 1 for item in value) and len(value) in _counts(wanted):
            return _labels(path, [item[0] for item in value], wanted)
        return _of_groups(path, [(str(k), ids) for k, ids in enumerate(value)], wanted)
    return _of_list(path, value)


def _counts(wanted: Wanted) -> tuple[int | None, ...]:
    return wanted.n_elements, wanted.n_vertices


def _of_list(path: Path, values: Sequence[Any]) -> Listing:
    texts = [value for value in values if isinstance(value, str)]
    if texts and not all(map(_NUMBER.fullmatch, texts)):
        wrong = [v for v in values if v is not None and not isinstance(v, str)]
        if wrong:
            _refuse(path, f"mixes names, such as {texts[0]!r:.40}, and {wrong[0]!r:.40}")
        labels, names = numbered_names(values)
        return Listing(labels=labels, names=names or None)
    numbers = [int(v) if isinstance(v, str) else v for v in values]
    for value in numbers:
        if value is not None and not isinstance(value, int | float):
            _refuse(path, f"has {value!r:.40} in its list of labels")
        if isinstance(value, int) and not -(2**63) <= value < 2**63:
            raise file_error(path, "has labels that are too large; labels count from 0")
    if all(isinstance(value, int) for value in numbers):
        return Listing(labels=whole_labels(path, np.array(numbers, np.int64)))
    floats = np.array([np.nan if value is None else value for value in numbers], np.float64)
    return Listing(labels=whole_labels(path, floats))


def _is_map(value: Mapping[str, Any]) -> bool:
    """Whether all keys are numbers, or all members are lists of ids."""
    if not value:
        return False
    return all(map(_NUMBER.fullmatch, value)) or (
        all(map(_is_ids, value.values())) and not familiar(value)
    )


def _is_ids(value: Any) -> bool:
    return isinstance(value, list) and all(type(item) is int for item in value)


def _of_map(path: Path, value: Mapping[str, Any], wanted: Wanted) -> Listing:
    if value and all(map(_is_ids, value.values())):
        return _of_groups(path, list(value.items()), wanted)
    if value and all(map(_NUMBER.fullmatch, value)):
        keys = [int(key) for key in value]
        found = _of_list(path, list(value.values()))
        groups = [(k, str(key), np.array([key], np.int64)) for k, key in enumerate(keys)]
        n, noun = wanted.bearers(path, np.array(keys, np.int64))
        rows, notes = labels_of_ids(path, groups, n, noun=noun)
        labels = np.where(rows < 0, UNLABELLED, found.labels[rows])
        return Listing(labels=labels, names=found.names, of=wanted.bearer, notes=notes)
    _refuse(
        path,
        f"has no labels under its members {', '.join(f'{key!r:.40}' for key in list(value)[:6])}",
    )


def _of_groups(path: Path, groups: Sequence[tuple[str, Any]], wanted: Wanted) -> Listing:
    """Labels from what bears each."""
    for called, ids in groups:
        if not _is_ids(ids):
            _refuse(path, f"has something else than a list of face ids under {called!r:.40}")
        if not all(-(2**63) <= face < 2**63 for face in ids):
            raise file_error(path, f"has an id under {called!r:.40} that is too large")
    names: tuple[str, ...] | None = None
    numbers: IntArray
    if all(_NUMBER.fullmatch(called) for called, _ in groups):
        numbers = whole_labels(path, np.array([int(called) for called, _ in groups], np.int64))
    else:
        numbers, names = numbered_names(called for called, _ in groups)
    listed = [
        (number, called, np.array(ids, np.int64))
        for number, (called, ids) in zip(numbers.tolist(), groups, strict=True)
    ]
    n, noun = wanted.bearers(path, np.array([face for _, ids in groups for face in ids], np.int64))
    labels, notes = labels_of_ids(path, listed, n, noun=noun)
    return Listing(labels=labels, names=names, of=wanted.bearer, notes=notes)


def _of_records(path: Path, records: Sequence[Mapping[str, Any]], wanted: Wanted) -> Listing:
    """Labels from objects with a name, or a number, and ids."""
    groups = []
    for k, record in enumerate(records):
        members = {plain(key): value for key, value in reversed(list(record.items()))}
        key = next((key for key in _BEARERS if _is_ids(members.get(key))), None)
        if key is None:
            _refuse(path, f"has a record without a list of faces: {', '.join(record)}")
        called = next((members[key] for key in _CALLED if members.get(key) is not None), k)
        groups.append((str(called), members[key]))
        wanted = wanted.told(key)
    return _of_groups(path, groups, wanted)


def _of_segments(path: Path, document: Mapping[str, Any], wanted: Wanted) -> Listing:
    """ScanNet: the segment of each vertex, and maybe which segments make an object."""
    segments = _labels(path, document["segIndices"], wanted).labels
    groups = document.get("segGroups")
    if not isinstance(groups, list) or not groups:
        return Listing(labels=segments, of="vertices")
    object_of: dict[int, str] = {}
    for k, group in enumerate(groups):
        if not isinstance(group, dict) or not _is_ids(group.get("segments")):
            _refuse(path, "has segGroups without lists of 'segments'")
        called = group.get("label") or f"object {group.get('objectId', k)}"
        object_of |= dict.fromkeys(group["segments"], str(called))
    labels, names = numbered_names(object_of.get(segment) for segment in segments.tolist())
    return Listing(labels=labels, names=names, of="vertices")


def _refuse(path: Path, what: str) -> NoReturn:
    raise file_error(path, f"{what}; {_FORMS}")
