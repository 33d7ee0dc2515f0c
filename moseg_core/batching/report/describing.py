"""A result as the page of a batch shows it: a small picture, and the measures of its parts.

Both are made in a guarded child, since shapes are read again and measures of bundles are taken; and
both are kept as files, so that a page that is made anew later takes what is there.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from moseg_core.batching.instructions import Instructions
from moseg_core.components.discovery.registry import registry
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import MosegError
from moseg_core.io.files import write_files
from moseg_core.io.result_json import read_result
from moseg_core.io.result_loading import check_shape
from moseg_core.search.part_measures import measure_parts
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
    key : str
        Of the job that has made the result; of another one the description is out of date.
    rows : tuple of dict
        Measures of the parts, as in :class:`moseg_core.PartTable`.
    """

    key: str
    rows: tuple[dict[str, Cell], ...]


def description_files(folder: Path, name: str) -> tuple[Path, Path]:
    """Where picture and measures of a shape are kept, in a batch's folder."""
    return folder / "report" / f"{name}.png", folder / "report" / f"{name}.json"


def read_description(path: Path, key: str) -> Description | None:
    """The description of a result; None where there is none of this key."""
    try:
        document = json.loads(path.read_bytes())
        found = Description(key=document["key"], rows=tuple(map(dict, document["rows"])))
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return None  # whatever it is, it is made anew
    return found if found.key == key else None


def describe_result(shape: str, outputs: Sequence[str], instructions: str) -> dict[str, Any]:
    """Draw and measure a result of a batch.

    Parameters
    ----------
    shape : str
        Path.
    outputs : sequence of str
        Paths of the result (.json), which is there, and of the picture and the measures, which are
        written; and the key of the job.
    instructions : str
        As JSON (:class:`moseg_core.batching.instructions.Instructions`).

    Returns
    -------
    dict
        Fields of an :class:`~moseg_core.batching.outcome.Outcome`, as plain data.
    """
    result, picture, measures, key = outputs
    try:
        read = Instructions.read(json.loads(instructions)).reading.read(shape)
        saved = read_result(Path(result))
        check_shape(saved, Path(result), read)
        segmentation = Segmentation.from_labels(read, saved.labels, len(saved.names))
        table = measure_parts(
            segmentation,
            saved.names,
            source=registry(),
            evaluation=saved.evaluation,
            centers=saved.centers,
        )
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
        Path(picture).parent.mkdir(exist_ok=True)
        text = json.dumps({"key": key, "rows": json.loads(table.to_json())}, allow_nan=False)
        write_files({Path(picture): drawn, Path(measures): text.encode()})
    except MosegError as error:
        return {"kind": "failed", "message": str(error)}
    return {"kind": "ok", "files": [picture, measures]}
