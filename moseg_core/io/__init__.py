"""Files in and out: shapes by :func:`load`, results by :func:`save`, labellings by suffix."""

from moseg_core.io.files import load, save
from moseg_core.io.labels import (
    Labelling,
    encode_named_labels,
    encode_seg,
    read_labels,
    save_labels,
)
from moseg_core.io.result_json import SavedResult, read_result
from moseg_core.io.result_loading import load_result
from moseg_core.io.whole_file import write_file

__all__ = [
    "Labelling",
    "SavedResult",
    "encode_named_labels",
    "encode_seg",
    "load",
    "load_result",
    "read_labels",
    "read_result",
    "save",
    "save_labels",
    "write_file",
]
