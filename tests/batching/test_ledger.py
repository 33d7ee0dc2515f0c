"""The ledger: added to and never changed, readable whatever happened last, one driver at a time."""

from __future__ import annotations

import json
import resource

import pytest

from moseg_core.batching.ledger import NAME, Ledger, is_batch, latest, read_ledger, results_in
from moseg_core.batching.outcome import Outcome
from moseg_core.errors import MosegError, UsageError


def row(name, kind="ok", key=None, **more):
    files = (f"{name}.json",) if kind == "ok" else ()
    return Outcome(shape=f"{name}.off", key=key or name, kind=kind, files=files, **more)


def write(folder, *outcomes, resume=False):
    with Ledger(folder, resume=resume) as ledger:
        for outcome in outcomes:
            ledger.add(outcome)


def test_what_is_added_is_read(tmp_path):
    assert not is_batch(tmp_path)
    write(tmp_path, row("b"), row("a", "timeout"), row("\udcff"))
    assert is_batch(tmp_path)
    assert read_ledger(tmp_path) == [row("b"), row("a", "timeout"), row("\udcff")]
    assert results_in(tmp_path) == (tmp_path / "b.json", tmp_path / "\udcff.json")


def test_a_line_is_on_the_disk_when_it_is_added(tmp_path):
    with Ledger(tmp_path, resume=False) as ledger:
        ledger.add(row("a"))
        assert read_ledger(tmp_path) == [row("a")]


def test_a_ledger_is_gone_on_with_only_when_that_is_asked_for(tmp_path):
    write(tmp_path, row("a"))
    with pytest.raises(UsageError, match="go on with it by --resume"):
        Ledger(tmp_path, resume=False)
    write(tmp_path, row("b"), resume=True)
    assert read_ledger(tmp_path) == [row("a"), row("b")]


@pytest.mark.parametrize("cut", [1, 5, 40])
def test_a_torn_last_line_is_passed_over_and_then_cut_off(tmp_path, cut):
    write(tmp_path, row("a"), row("b"))
    data = (tmp_path / NAME).read_bytes()
    (tmp_path / NAME).write_bytes(data[:-cut])
    assert read_ledger(tmp_path) == [row("a")]
    write(tmp_path, row("c"), resume=True)
    assert read_ledger(tmp_path) == [row("a"), row("c")]


def test_a_first_line_that_is_torn_is_written_again(tmp_path):
    (tmp_path / NAME).write_bytes(b'{"ledg')
    write(tmp_path, row("a"), resume=True)
    assert read_ledger(tmp_path) == [row("a")]


def test_a_result_has_no_second_line(tmp_path):
    write(tmp_path, row("a", "timeout"), row("a"), row("a", seconds=3.0))
    assert [outcome.kind for outcome in read_ledger(tmp_path)] == ["timeout", "ok"]
    write(tmp_path, row("a", "crashed"), resume=True)
    assert latest(read_ledger(tmp_path))["a.off"].kind == "crashed"
    with pytest.raises(UsageError, match="no shape of the batch"):
        results_in(tmp_path)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (b"{", "damaged in line 3"),
        (b"[1]", "damaged in line 3 .it is no object"),
        (b'{"shape": "a"}', "damaged in line 3"),
        (b"[" * 100_000, "damaged in line 3"),
        (b"\xff\xfe", "damaged in line 3"),
    ],
)
def test_damage_is_told_with_its_line(tmp_path, line, said):
    write(tmp_path, row("a"), row("b"))
    lines = (tmp_path / NAME).read_bytes().split(b"\n")
    lines[2] = line
    (tmp_path / NAME).write_bytes(b"\n".join(lines))
    with pytest.raises(UsageError, match=said):
        read_ledger(tmp_path)
    with pytest.raises(UsageError, match=said):
        Ledger(tmp_path, resume=True)


@pytest.mark.parametrize("first", [b'{"ledger": "moseg-batch/9"}\n', b"[]\n", b'"x"\n'])
def test_what_is_no_ledger_is_refused(tmp_path, first):
    (tmp_path / NAME).write_bytes(first)
    with pytest.raises(UsageError, match="no ledger that this version reads"):
        read_ledger(tmp_path)


def test_a_full_disk_is_told_with_the_name_of_the_ledger(tmp_path):
    ledger, before = Ledger(tmp_path, resume=False), resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (40, before[1]))
    try:
        with pytest.raises(MosegError, match=r"cannot write '.*batch\.jsonl'"), ledger:
            ledger.add(row("a"))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    with Ledger(tmp_path, resume=True) as ledger:
        assert ledger.by_key == {}


def test_there_is_one_driver_at_a_time(tmp_path):
    busy = pytest.raises(MosegError, match="another process is at work on the batch")
    with Ledger(tmp_path, resume=False), busy:
        Ledger(tmp_path, resume=True)
    write(tmp_path, resume=True)


def test_a_folder_without_a_ledger_is_told(tmp_path):
    with pytest.raises(UsageError, match="cannot be read"):
        read_ledger(tmp_path)


def test_lines_are_json(tmp_path):
    write(tmp_path, row("a", cost=0.5))
    lines = (tmp_path / NAME).read_text().splitlines()
    assert json.loads(lines[0]) == {"ledger": "moseg-batch/1"}
    assert json.loads(lines[1]) == {
        "shape": "a.off",
        "key": "a",
        "kind": "ok",
        "files": ["a.json"],
        "cost": 0.5,
    }
