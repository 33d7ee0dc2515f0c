"""``--checkpoint`` and ``--resume``: what is said, and what is refused."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from moseg_core.cli.flags import CheckpointFlags
from moseg_core.cli.long_run import checkpoint_path
from moseg_core.errors import UsageError
from tests.cli.test_interrupt import interrupted

WORDS = ("--labels", "handle,head", "--minimize", "narrow(handle)")
FEW = (*WORDS, "--optimizer", "pattern_search(max_evaluations=30)")


def test_a_run_is_gone_on_with(moseg, mallet, tmp_path):
    file, first, second = tmp_path / "c", tmp_path / "1.json", tmp_path / "2.json"
    words = ("segment", mallet, *FEW)
    assert moseg(*words, "--checkpoint", file, "-o", first).code == 0
    done = moseg(*words, "--resume", file, "-o", second)
    assert done.code == 0
    assert re.search(rf"^moseg: going on from [1-9]\d* answers in {file}$", done.err, re.MULTILINE)
    assert first.read_bytes() == second.read_bytes()
    quiet = moseg(*words, "--resume", file, "-o", second, "--quiet")
    assert quiet.err == ""
    again = moseg(*words, "--checkpoint", file, "-o", second)
    assert again.code == 2
    assert again.err == (
        f"moseg: '{file}' exists already; to go on from it --resume {file}, or else remove it\n"
    )
    other = moseg(*words, "--seed", "4", "--resume", file)
    assert other.code == 2
    assert other.err.endswith("checkpoint of another run: search seed was 0 and is 4\n")
    assert "going on" not in other.err


def test_one_line_begins_and_goes_on(moseg, mallet, tmp_path):
    file = tmp_path / "c"
    words = ("segment", mallet, *FEW, "--checkpoint", file, "--resume", file, "--json")
    first, second = moseg(*words), moseg(*words)
    assert first.code == second.code == 0
    assert json.loads(first.out) == json.loads(second.out)
    assert "going on from 0 answers" not in first.err
    assert "going on from" in second.err


def test_damage_is_told_and_mended(moseg, mallet, tmp_path):
    file, out = tmp_path / "c", tmp_path / "r.json"
    words = ("segment", mallet, *FEW, "-o", out)
    assert moseg(*words, "--checkpoint", file).code == 0
    sound, head = out.read_bytes(), file.read_bytes().splitlines(keepends=True)[0]
    file.write_bytes(head + b"rubbish\n")
    done = moseg(*words, "--resume", file)
    assert "lines of " in done.err
    assert "that are damaged: 1; what they knew is computed again" in done.err
    assert out.read_bytes() == sound
    file.write_bytes(b"{}")
    refused = moseg(*words, "--resume", file)
    assert refused.code == 2
    assert refused.err.count("\n") == 1
    assert "is no checkpoint of moseg" in refused.err


def test_stopped_without_outputs_the_checkpoint_is_kept(mallet, tmp_path):
    file = tmp_path / "c"
    words = ["segment", str(mallet), "--recipe", "paper_hammer", "--checkpoint", str(file)]
    code, _, err = interrupted(words, ".")
    assert code == 130
    assert f"to go on: the same command with --resume {file}" in err
    assert len(file.read_bytes().splitlines()) > 1


@pytest.mark.parametrize(
    ("flags", "told"),
    [
        ({"resume": "missing"}, "there is no 'missing'; begin with --checkpoint missing"),
        ({"resume": "missing", "checkpoint": "new"}, "--resume: there is no 'missing'"),
        ({"checkpoint": "shape.off"}, "cannot be both the checkpoint and something else"),
        ({"checkpoint": "new", "every": 0.0}, "--checkpoint-every must be .* not 0.0"),
        ({"checkpoint": "new", "every": float("nan")}, "must be a number of seconds above 0"),
        ({"every": 5.0}, "--checkpoint-every says how often, .* add --checkpoint FILE"),
    ],
)
def test_what_makes_no_sense_is_refused(flags, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    paths = {name: Path(flags[name]) for name in ("checkpoint", "resume") if name in flags}
    every = flags.get("every")
    with pytest.raises(UsageError, match=told):
        checkpoint_path(CheckpointFlags(checkpoint_every=every, **paths), [Path("shape.off")])


def test_which_file_is_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    old, new = Path("old"), Path("new")
    old.touch()
    assert checkpoint_path(CheckpointFlags()) is None
    assert checkpoint_path(CheckpointFlags(checkpoint=new)) == new
    assert checkpoint_path(CheckpointFlags(resume=old)) == old
    assert checkpoint_path(CheckpointFlags(resume=old, checkpoint=new)) == new
    assert checkpoint_path(CheckpointFlags(resume=new, checkpoint=new)) == new
