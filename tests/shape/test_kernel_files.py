"""Compiled kernels on disk."""

from __future__ import annotations

import pytest

from moseg_core.shape.kernel_files import KernelFiles


def of(folder, stamp="1"):
    return KernelFiles(str(folder), of, stamp)


def test_what_is_kept_is_found_under_its_own_key(tmp_path):
    of(tmp_path).save(("float64", "cpu"), [1, 2])
    of(tmp_path).save(("float32", "cpu"), [3])
    assert of(tmp_path).load(("float64", "cpu")) == [1, 2]
    assert of(tmp_path).load(("float32", "cpu")) == [3]
    assert of(tmp_path).load(("int64", "cpu")) is None


def test_another_source_finds_nothing_and_clears_up(tmp_path):
    of(tmp_path).save("key", "old")
    assert of(tmp_path, "2").load("key") is None
    of(tmp_path, "2").save("key", "new")
    assert of(tmp_path, "2").load("key") == "new"
    assert of(tmp_path).load("key") is None
    assert len(list(tmp_path.iterdir())) == 1


def test_what_is_damaged_is_not_there_and_said(tmp_path):
    kept = of(tmp_path)
    kept.save("key", "value")
    (file,) = tmp_path.iterdir()
    assert (kept.load("other"), kept.damaged) == (None, None)
    for damaged in (b"", file.read_bytes()[:40], b"x" + file.read_bytes()[1:]):
        file.write_bytes(damaged)
        found = of(tmp_path)
        assert (found.load("key"), found.damaged) == (None, file)


def test_flushed_it_is_empty(tmp_path):
    of(tmp_path).save("key", "value")
    of(tmp_path).flush()
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_gone_holds_nothing_and_takes_nothing(tmp_path):
    gone = of(tmp_path / "gone")
    assert gone.load("key") is None
    with pytest.raises(FileNotFoundError):
        gone.save("key", "value")


def test_files_beside_the_source_are_read_where_others_are_written(tmp_path):
    source = tmp_path / "halving.py"
    source.write_text("def halve(number):\n    return number / 2\n")
    names: dict[str, object] = {}
    exec(compile(source.read_text(), str(source), "exec"), names)
    (tmp_path / "__pycache__").mkdir()
    KernelFiles(str(tmp_path / "__pycache__"), names["halve"], 1).save("key", "shipped")
    elsewhere = KernelFiles(str(tmp_path / "user"), names["halve"], 1)
    assert elsewhere.load("key") == "shipped"
