"""All files that were asked for: what fails takes no other along."""

from __future__ import annotations

import pytest

import moseg_core as moseg
from moseg_core.cli.saving import raise_last, save_outputs
from moseg_core.errors import MosegError, UsageError
from moseg_core.io.part_files import PartForm
from tests import shapes
from tests.results import result_on


def test_what_fails_is_told_and_the_rest_written(tmp_path):
    shape = tmp_path / "shape.ply"
    shape.write_bytes(b"")
    outputs = [shape, tmp_path / "a.seg", tmp_path / "x.nothing", tmp_path / "{part}.obj"]
    written, failures, notes = save_outputs(
        result_on(moseg.Shape.from_mesh(*shapes.box(3, 2, 1))), outputs, shape, PartForm()
    )
    assert [str(tmp_path / "a.seg"), f"{tmp_path / '{part}.obj'} (2 files)"] == written
    assert [type(failure) for failure in failures] == [UsageError, UsageError]
    assert "the shape itself" in str(failures[0])
    assert notes == []
    assert shape.read_bytes() == b""


def test_the_last_failure_ends_the_command_and_the_others_are_said(capsys):
    raise_last([])
    with pytest.raises(MosegError, match="second"):
        raise_last([MosegError("first"), MosegError("second")])
    assert "first" in capsys.readouterr().err
