"""Checkpoints: what is read back is what was written, whatever has happened to the file."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from moseg_core.errors import MosegError, UsageError
from moseg_core.io.checkpoint import FORMAT, Checkpoint, checkpointing
from moseg_core.search.answer_record import current_record, one_run, packed, unpacked

RUN = {"shape": "horse", "search": {"seed": 1}}


def answer(k):
    return packed(bytes([k]) * 16, np.arange(float(k)))


@pytest.fixture
def path(tmp_path):
    return tmp_path / "horse.checkpoint"


def written(path, count=3):
    """A checkpoint with some lines, an answer in each."""
    checkpoint = Checkpoint(path)
    assert checkpoint.begin(RUN) == {}
    for k in range(1, count + 1):
        checkpoint.write([answer(k)])
    checkpoint.close()
    return path


def read(path, run=RUN):
    checkpoint = Checkpoint(path, path)
    found = dict(checkpoint.begin(run))
    checkpoint.close()
    return found, checkpoint


def test_what_was_written_is_read(path):
    found, checkpoint = read(written(path))
    assert found == unpacked(answer(1) + answer(2) + answer(3))
    assert (checkpoint.known, checkpoint.damaged) == (3, 0)
    head, *lines = path.read_text(encoding="ascii").splitlines()
    assert json.loads(head) == {"format": FORMAT, "run": RUN}
    assert len(lines) == 3


def test_cut_anywhere_what_is_whole_is_known_and_gone_on_from(path):
    whole = written(path).read_bytes()
    starts = [at + 1 for at, byte in enumerate(whole) if byte == 10]
    for size in range(starts[0], len(whole) + 1):
        path.write_bytes(whole[:size])
        found, checkpoint = read(path)
        lines = sum(start <= size for start in starts[1:])
        assert len(found) == lines
        assert checkpoint.damaged == (size not in starts)
        checkpoint = Checkpoint(path, path)
        checkpoint.begin(RUN)
        checkpoint.write([answer(9)])
        checkpoint.close()
        found, checkpoint = read(path)
        assert (len(found), checkpoint.damaged) == (lines + 1, 0)


@pytest.mark.parametrize("at", [0, 5, 8, 9, 20])
def test_a_damaged_line_is_passed_over(path, at):
    head, first, second, third = written(path).read_bytes().splitlines(keepends=True)
    other = b"!" if second[at : at + 1] != b"!" else b"?"
    second = second[:at] + other + second[at + 1 :]
    path.write_bytes(head + first + second + third)
    found, checkpoint = read(path)
    assert found == unpacked(answer(1) + answer(3))
    assert checkpoint.damaged == 1


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x00" * 100,
        b"{",
        b"[" * 100_000,
        b"[]\n",
        b"{}\n",
        b'{"format": 1}\n',
        b'{"format": "moseg-checkpoint/1", "run": 3}\n',
        b'{"format": "moseg-result/1", "run": ' + b"9" * 5000 + b"}\n",
    ],
)
def test_what_is_no_checkpoint_is_refused(path, data):
    path.write_bytes(data)
    with pytest.raises(UsageError, match="is no checkpoint of moseg"):
        Checkpoint(path, path)
    assert path.read_bytes() == data


def test_a_later_format_is_refused(path):
    path.write_text('{"format": "moseg-checkpoint/2", "run": {}}\n')
    with pytest.raises(UsageError, match="has the format 'moseg-checkpoint/2'; this version reads"):
        Checkpoint(path, path)


def test_what_is_no_file_is_refused(path, tmp_path):
    os.mkfifo(path)
    for given in (path, tmp_path, "/dev/zero"):
        with pytest.raises(UsageError, match="is no file to go on from"):
            Checkpoint(tmp_path / "new", tmp_path / given)
    with pytest.raises(UsageError, match="cannot be read as a checkpoint: No such file"):
        Checkpoint(tmp_path / "new", tmp_path / "missing")


def test_a_checkpoint_of_another_run_is_refused_and_says_what_differs(path):
    before = written(path).read_bytes()
    with pytest.raises(UsageError, match="checkpoint of another run: search seed was 1 and is 2"):
        read(path, {"shape": "horse", "search": {"seed": 2}})
    many = {str(k): k for k in range(9)}
    with pytest.raises(UsageError, match="and 8 more"):
        read(path, many)
    assert path.read_bytes() == before


def test_nothing_that_exists_is_overwritten(path, tmp_path):
    written(path)
    with pytest.raises(UsageError, match=r"exists already; to go on from it --resume"):
        Checkpoint(path)
    with pytest.raises(UsageError, match="exists already"):
        Checkpoint(path, written(tmp_path / "other"))


def test_another_file_is_gone_on_in(path, tmp_path):
    before = written(path).read_bytes()
    new = tmp_path / "new"
    checkpoint = Checkpoint(new, path)
    checkpoint.begin(RUN)
    checkpoint.write([answer(4)])
    checkpoint.close()
    assert read(new)[0] == unpacked(b"".join(map(answer, (1, 2, 3, 4))))
    assert path.read_bytes() == before


def test_where_nothing_was_begun_there_is_no_file(path):
    with checkpointing(path, resume=path):
        pass
    assert not path.exists()


def test_folders_that_cannot_be_written_are_told_at_once(path, tmp_path, monkeypatch):
    with pytest.raises(UsageError, match="there is no folder"):
        Checkpoint(tmp_path / "nowhere" / "c")
    monkeypatch.setattr(os, "access", lambda *given: False)
    with pytest.raises(MosegError, match=r"cannot write .*Permission denied"):
        Checkpoint(path)


def test_two_runs_do_not_write_one_checkpoint(path):
    checkpoint = Checkpoint(path)
    checkpoint.begin(RUN)
    script = (
        "import sys; from pathlib import Path; from moseg_core.io.checkpoint import Checkpoint;"
        " path = Path(sys.argv[1]); Checkpoint(path, path).begin(eval(sys.argv[2]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, path, repr(RUN)], capture_output=True, text=True
    )
    assert "is being written by another run" in done.stderr
    checkpoint.close()


def test_a_full_disk_does_not_end_the_search(path, monkeypatch):
    checkpoint = Checkpoint(path)
    checkpoint.begin(RUN)
    checkpoint.write([answer(1)])

    def full(number):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        with pytest.warns(RuntimeWarning, match=r"cannot be written for now \(No space left"):
            checkpoint.write([answer(2)])
        checkpoint.write([answer(3)])  # told once
    checkpoint.write([answer(4)])
    checkpoint.close()
    assert read(path)[0] == unpacked(b"".join(map(answer, (1, 2, 3, 4))))


def test_many_answers_make_lines_of_a_handy_length(path):
    checkpoint = Checkpoint(path)
    checkpoint.begin(RUN)
    many = [packed(k.to_bytes(16, "big"), np.zeros(10_000)) for k in range(30)]
    checkpoint.write(many)
    checkpoint.close()
    assert len(path.read_bytes().splitlines()) == 4
    assert len(read(path)[0]) == 30


def test_the_record_in_use_is_written_to_the_file_however_it_ends(path):
    def broken():
        with checkpointing(path), one_run(lambda: RUN):
            current_record().add(b"k" * 16, np.zeros(2))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        broken()
    assert list(read(path)[0]) == [b"k" * 16]
