"""``moseg batch``: what is asked for, what is refused, and what is said of what came of it."""

from __future__ import annotations

import io
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from moseg_core.batching.outcome import BatchProgress, Outcome
from moseg_core.batching.running import run_job
from moseg_core.batching.solving import do_job
from moseg_core.cli import batch as command
from moseg_core.cli.batch import progress_of_batch, read_instructions
from moseg_core.cli.flags import BatchFlags, SearchedProblemFlags, SearchFlags, ShapeFlags
from moseg_core.io.part_files import PartForm

WORDS = ["--labels", "a,b", "--minimize", "narrow(a)", "--restarts", "1"]
WORDS += ["--optimizer", "pattern_search(max_evaluations=9)"]


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Three shapes, one of them cut off, where the command runs; jobs are done in this process."""
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b", "c"):
        lines = ["OFF", "4 4 0", "0 0 0", f"{1 + ord(name) % 3} 0 0", "0 1 0", "0 0 1"]
        lines += ["3 0 2 1", "3 0 1 3", "3 1 2 3", "3 0 3 2"]
        Path(f"{name}.off").write_text("\n".join(lines if name != "c" else lines[:5]))

    class Here(ThreadPoolExecutor):
        def submit(self, function, job):
            assert function is run_job
            return super().submit(do_here, job)

    def do_here(job):
        answer = do_job(job.shape, job.outputs, job.instructions)
        files = tuple(Path(file).name for file in answer.pop("files", ()))
        answer["parts"] = tuple(answer.get("parts", ()))
        answer["warnings"] = tuple(answer.get("warnings", ()))
        return Outcome(shape=job.shape, key=job.key, files=files, **answer)

    whole = command.run_batch

    def run(*given, **more):
        with Here(1) as pool:
            return whole(*given, **{**more, "executor": pool})

    monkeypatch.setattr(command, "run_batch", run)
    return tmp_path


def test_results_are_those_of_segment_and_failures_are_named(here, moseg):
    done = moseg("batch", "*.off", *WORDS, "-o", "out", "-o", "out/{shape}.ply")
    assert done.code == 1
    assert "moseg: c.off: bad shape: c.off announces" in done.err
    assert done.err.endswith("1 of 3 shapes failed; --retry-failed does these again\n")
    lines = [line.split() for line in done.out.splitlines()]
    assert ["ok", "2"] in lines
    assert ["bad", "shape", "1"] in lines
    for name in ("a", "b"):
        alone = moseg("segment", f"{name}.off", *WORDS, "-o", "x.json", "-o", "x.ply")
        assert alone.code == 0
        for suffix in ("json", "ply"):
            assert Path(f"out/{name}.{suffix}").read_bytes() == Path(f"x.{suffix}").read_bytes()
    again = moseg("batch", "*.off", *WORDS, "-o", "out")
    assert again.code == 2
    assert "go on with it by --resume" in again.err
    Path("c.off").unlink()
    more = moseg(
        *("batch", "*.off", *WORDS, "-o", "out", "-o", "out/{shape}.ply", "--resume", "--json")
    )
    assert more.code == 0
    said = json.loads(more.out)
    assert said["counts"] == {"ok": 2}
    assert [outcome["shape"] for outcome in said["outcomes"]] == ["a.off", "b.off"]
    table = moseg("measure", "out", "--json")
    assert table.code == 0
    assert [(row["shape"], row["part"]) for row in json.loads(table.out)] == [
        *(("a", "a"), ("a", "b"), ("b", "a"), ("b", "b"))
    ]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "say where: -o FOLDER"),
        (["-o", "x.json"], r"-o x.json' would be one file for all shapes"),
        (["-o", "out", "-o", "other"], "give one folder, not several"),
        (["-o", "out", "--timeout", "-1"], "timeout must be a positive number"),
        (["-o", "out", "--hulls"], "'hulls' is about files of single parts"),
        (["-o", "out", "--recipe", "fourlg"], "did you mean 'fourleg'"),
        (["-o", "out", "--seeder", "kmean"], "did you mean 'kmeans'"),
        (["-o", "out", "--pitch", "x"], "--pitch is one positive number or three"),
        (["-o", "out", "--center", "a=1,2,3"], "--center"),
    ],
)
def test_what_makes_no_sense_is_refused_before_the_first_shape(here, moseg, words, said):
    done = moseg("batch", "*.off", *WORDS, *words)
    assert done.code == 2
    assert said in done.err
    assert not Path("out").exists()


def read(**problem):
    return read_instructions(
        SearchedProblemFlags(**problem),
        ShapeFlags(pitch="2", up="z"),
        SearchFlags(seed=3, workers=5),
        BatchFlags(),
        clip=False,
        form=PartForm(),
    )


def test_options_become_instructions():
    plain = read(labels="a,b", minimize="narrow(a)")
    assert plain.statement.labels == ("a", "b")
    assert plain.reading.pitch == (2.0, 2.0, 2.0)
    assert plain.document()["options"] == {"seed": 3}
    assert plain.sets is None
    assert read(parts="auto").n_parts == "auto"
    counted = read(labels="top,leg{3..4}", minimize="flat(top) + narrow(leg*)")
    assert [len(names) for names in counted.sets] == [4, 5]
    assert [task.labels for task in counted.problems()] == list(counted.sets)


def test_a_terminal_has_a_bar(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    with progress_of_batch(quiet=False) as report:
        report(BatchProgress(total=20, kept=0, counts={"ok": 3}, at_work=(), seconds=3.0))
    assert "3 of 20" in terminal.getvalue()
    assert "3 ok, about 17 s left" in terminal.getvalue()


def test_progress_is_told_line_by_line_off_a_terminal(capsys):
    now = [0.0]
    failed = Outcome(shape="b.off", key="", kind="timeout", message="took longer")

    def progress(seconds, counts, news=()):
        return BatchProgress(
            total=20, kept=2, counts=counts, at_work=(), seconds=seconds, news=news
        )

    with progress_of_batch(quiet=False, clock=lambda: now[0]) as report:
        assert not report(progress(1.0, {}))
        now[0] = 31.0
        assert not report(progress(31.0, {"ok": 3, "timeout": 1}, (failed,)))
    err = capsys.readouterr().err
    assert err.splitlines() == [
        "moseg: b.off: timeout: took longer",
        "moseg: 6 of 20 shapes: 2 done before, 3 ok, 1 timeout, about 2 min left",
    ]
    with progress_of_batch(quiet=True) as report:
        assert not report(progress(31.0, {}, (failed,)))
    assert capsys.readouterr().err == ""
