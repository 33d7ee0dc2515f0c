"""A result as the page of a batch shows it: a small picture, and the measures of its parts.

Both are made in a guarded child, since shapes are read again and measures of bundles are taken; and
both are kept as files, so that a page that is made anew later takes what is there.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from moseg_core.batching.instructions import Instructions
from moseg_core.errors import MosegError
from moseg_core.io.files import write_files
from moseg_core.io.json_document import read_json_file
from moseg_core.io.result_json import read_result
from moseg_core.io.result_loading import check_shape, measure_saved
from moseg_core.search.part_table import Cell
from moseg_core.view.picture import render_picture
from moseg_core.view.point_bodies import drawable

#: Pixels of a picture: of two in a row a telephone has room for one.
_SIZE = (360, 240)


@dataclass(frozen=True, kw_only=True)
class Description:
    """What the page says of a result.

    Parameters
    ----------
    digest : str
        Hexadecimal, of the result's file; of another one the description is out of date.
    rows : tuple of dict
        Measures of the parts, as in :class:`moseg_core.PartTable`.
    """

    digest: str
    rows: tuple[dict[str, Cell], ...]


def description_files(folder: Path, name: str) -> tuple[Path, Path]:
    """Where picture and measures of a shape are kept, in a batch's folder."""
    return folder / "report" / f"{name}.png", folder / "report" / f"{name}.json"


def read_description(path: Path, result: Path) -> Description | None:
    """The description of a result; None where there is none of the file as it is now."""
    try:
        document = read_json_file(path)
        found = Description(digest=document["digest"], rows=tuple(map(dict, document["rows"])))
        return found if found.digest == _digest(result) else None
    except (OSError, ValueError, TypeError, KeyError):
        return None  # whatever it is, it is made anew


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def describe_result(shape: str, outputs: Sequence[str], instructions: str) -> dict[str, Any]:
    """Draw and measure a result of a batch.

    Parameters
    ----------
    shape : str
        Path.
    outputs : sequence of str
        Paths of the result (.json), which is there, and of the picture and the measures, which are
        written.
    instructions : str
        As JSON (:class:`moseg_core.batching.instructions.Instructions`).

    Returns
    -------
    dict
        Fields of an :class:`~moseg_core.batching.outcome.Outcome`, as plain data.
    """
    result, picture, measures = map(Path, outputs)
    try:
        read = Instructions.read(json.loads(instructions)).reading.read(shape)
        digest, saved = _digest(result), read_result(result)
        check_shape(saved, result, read)
        table = measure_saved(saved, read)
        drawn = render_picture(
            drawable(read.geometry),
            saved.labels,
            saved.names,
            size=_SIZE,
            areas=None if read.has_surface else read.areas,
            up=read.up,
            views=["main"],
            legend=False,
        )
        picture.parent.mkdir(exist_ok=True)
        text = json.dumps({"digest": digest, "rows": json.loads(table.to_json())}, allow_nan=False)
        write_files({picture: drawn, measures: text.encode()})
    except (MosegError, OSError) as error:
        return {"kind": "failed", "message": str(error)}
    return {"kind": "ok", "files": outputs[1:]}
