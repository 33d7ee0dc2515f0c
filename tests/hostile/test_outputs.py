"""Nothing is lost at the last step: outputs that fail, signals, closed streams, strange names."""

from __future__ import annotations

import json
import os
import signal
import stat
import subprocess
import sys
import tempfile

import pytest

import moseg_core
from moseg_core.cli import main
from moseg_core.components.discovery.registry import registry
from tests import shapes

WORDS = ["--labels", "a,b", "--workers", "1"]
COST = "narrow(a) + narrow(b)"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The working folder, with a shape of 22 squares, box.off."""
    vertices, faces = shapes.box(3, 2, 1)
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(map(str, row)) for row in vertices]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    here = tmp_path / "here"
    here.mkdir()
    (here / "box.off").write_text("\n".join(lines))
    monkeypatch.chdir(here)
    return here


@pytest.fixture
def segment(folder, capsys):
    """Segment box.off into some files; exit code, stderr."""

    def run(*outputs, shape="box.off", cost=COST):
        given = [word for output in outputs for word in ("-o", str(output))]
        with pytest.raises(SystemExit) as ended:
            main(["segment", shape, *WORDS, "--minimize", cost, *given])
        return ended.value.code, capsys.readouterr().err

    return run


@pytest.fixture
def unsearched(monkeypatch):
    """No search may begin."""

    def search(*given, **more):
        pytest.fail("there was a search")

    monkeypatch.setattr("moseg_core.cli.segment.solve_variants", search)


BUNDLE = """
from moseg_core import ObjectiveSpec, WriterSpec, hookimpl
moseg_contract = 1
@hookimpl
def moseg_writers():
    names = ("fails", "escapes", "moves", "sound", "signals", "signals_twice")
    writers = [
        WriterSpec(name=name, target=f"bad_work:{name}", suffixes=(f".{name}",)) for name in names
    ]
    return [*writers, WriterSpec(name="gone", target="bad_gone:gone", suffixes=(".gone",))]
@hookimpl
def moseg_objectives():
    return [ObjectiveSpec(name="leaves", target="bad_work:leaves", summary="Goes elsewhere.")]
"""
WORK = """
import os, signal
from moseg_core import Part, objective
NUMBER = signal.SIGINT
class Unheard(BaseException): pass
def fails(result): raise OSError(28, "No space left on device")
def escapes(result): raise Unheard("of")
def moves(result): os.chdir(os.sep); return b"moved"
def sound(result): return b"sound"
def signals(result):
    os.kill(os.getpid(), NUMBER)
    return b"signalled"
def signals_twice(result):
    os.kill(os.getpid(), NUMBER)
    os.kill(os.getpid(), NUMBER)
@objective(range=(0, 1))
def leaves(part: Part) -> float:
    os.chdir(os.sep)
    return 0.5
"""


@pytest.fixture
def bad_bundle(site):
    """A bundle of writers that do what they should not."""
    site.add("Bad-Bundle", bundles={"bad": "bad_bundle"}, bad_bundle=BUNDLE, bad_work=WORK)
    registry.cache_clear()
    import bad_work

    yield bad_work
    registry.cache_clear()


# -- before the search ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("output", "code", "says"),
    [
        ("/proc/a.glb", 1, "'/proc/a.glb': No such file or directory"),
        ("n" * 251 + ".json", 2, "File name too long"),
        ("nul\0.json", 2, "embedded null byte"),
        ("taken.json", 2, "it is a folder"),
        ("nowhere/a.json", 2, "there is no folder 'nowhere'"),
        ("box.off/a.json", 2, "there is no folder 'box.off'"),
        ("circle.json", 1, "a link to"),
        ("dangling.json", 1, "a link to"),
        ("n" * 250 + "{part}.obj", 2, "File name too long"),
    ],
)
def test_a_place_that_takes_no_file_is_told_before_the_search(
    segment, folder, unsearched, output, code, says
):
    (folder / "taken.json").mkdir()
    (folder / "circle.json").symlink_to("circle.json")
    (folder / "dangling.json").symlink_to("nowhere/real.json")
    before = sorted(os.listdir(folder))
    found, err = segment("b.json", output)
    assert (found, err.count("\n")) == (code, 1)
    assert err.startswith("moseg: cannot write '")
    assert says in err
    assert sorted(os.listdir(folder)) == before


def test_a_full_disk_is_noticed_before_the_search(segment, folder, unsearched, monkeypatch):
    """An empty file fits onto a full disk."""
    real = tempfile.mkstemp

    def onto_full(**given):
        descriptor, name = real(**given)
        os.close(descriptor)
        return os.open("/dev/full", os.O_WRONLY), name

    monkeypatch.setattr("tempfile.mkstemp", onto_full)
    code, err = segment("b.json")
    assert (code, err) == (1, "moseg: cannot write 'b.json': No space left on device\n")
    assert os.listdir(folder) == ["box.off"]


def test_a_writer_whose_module_is_missing_is_told_before_the_search(
    segment, bad_bundle, unsearched
):
    code, err = segment("b.json", "r.gone")
    assert code == 1
    assert "writer 'bad:gone' of Bad-Bundle 1.0 cannot be loaded" in err


@pytest.mark.parametrize(
    "outputs",
    [
        ("a.json", "a.json"),
        ("a.json", "../here/a.json"),
        ("link.json", "a.json"),
        ("kept.json", "hard.json"),
        ("{part}.obj", "b.obj"),
    ],
    ids=["same word", "another spelling", "link to a new file", "hard link", "file of a part"],
)
def test_two_outputs_that_are_one_file_are_refused(segment, folder, unsearched, outputs):
    (folder / "link.json").symlink_to("a.json")
    (folder / "kept.json").write_text("")
    os.link(folder / "kept.json", folder / "hard.json")
    code, err = segment(*outputs)
    assert (code, "give every output a name of its own" in err) == (2, True)


# -- after the search -----------------------------------------------------------------------------


def test_all_outputs_are_tried_and_failures_named(segment, folder, bad_bundle):
    (folder / "full.json").symlink_to("/dev/full")
    code, err = segment("r.fails", "r.escapes", "full.json", "b.json", "c.seg")
    assert code == 1
    assert "wrote b.json, c.seg\n" in err
    for name in (
        "writer 'bad:fails'",
        "writer 'bad:escapes' of Bad-Bundle 1.0 failed: Unheard: of",
        "'full.json', a link to",
    ):
        assert name in err
    assert "Traceback" not in err
    assert json.loads((folder / "b.json").read_text())["reason"] == "converged"


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
def test_a_signal_while_files_are_written_lets_them_be_finished(
    segment, folder, bad_bundle, monkeypatch, number, code
):
    before = signal.signal(number, signal.default_int_handler)
    monkeypatch.setattr(bad_bundle, "NUMBER", number)
    try:
        found, err = segment("r.signals", "r.sound", "b.json")
        assert found == code
        assert "finishing the files (once more to end at once)" in err
        assert sorted(os.listdir(folder)) == ["b.json", "box.off", "r.signals", "r.sound"]
        for name in ("r.sound", "b.json"):
            (folder / name).unlink()
        # The second ends at once; what the core writes comes before what bundles write.
        found, err = segment("r.signals_twice", "r.sound", "b.json")
        assert found == code
        assert sorted(os.listdir(folder)) == ["b.json", "box.off", "r.signals"]
    finally:
        signal.signal(number, before)


def test_a_writer_that_goes_elsewhere_is_named_and_the_other_files_land_where_they_should(
    segment, folder, bad_bundle
):
    code, err = segment("r.moves", "r.sound", "b.json")
    assert (code, os.getcwd()) == (1, str(folder))
    assert "writer 'bad:moves' of Bad-Bundle 1.0 changed the working directory" in err
    assert sorted(os.listdir(folder)) == ["b.json", "box.off", "r.sound"]
    assert not os.path.exists("/r.sound")


def test_an_objective_that_goes_elsewhere_is_named(segment, folder, bad_bundle):
    code, err = segment("r.json", cost="bad:leaves(a) + narrow(b)")
    assert (code, os.getcwd()) == (1, str(folder))
    assert "objective 'bad:leaves' of Bad-Bundle 1.0 changed the working directory" in err
    assert not os.path.exists("/r.json")


def test_a_link_is_followed_and_a_file_keeps_its_mode(segment, folder):
    (folder / "link.json").symlink_to("real.json")
    (folder / "real.json").write_text("old")
    (folder / "real.json").chmod(0o600)
    assert segment("link.json")[0] == 0
    assert (folder / "link.json").is_symlink()
    assert stat.S_IMODE((folder / "real.json").stat().st_mode) == 0o600
    assert json.loads((folder / "real.json").read_text())["format"] == "moseg-result/1"


def test_a_pipe_is_written_into_after_all_files(segment, folder):
    os.mkfifo(folder / "pipe.seg")
    reader = os.open(folder / "pipe.seg", os.O_RDONLY | os.O_NONBLOCK)
    try:
        code, err = segment("pipe.seg", "b.seg")
        assert code == 0, err
        assert "wrote b.seg, pipe.seg" in err
        assert os.read(reader, 1000) == (folder / "b.seg").read_bytes()
    finally:
        os.close(reader)


def test_names_that_are_no_utf8_are_read_and_written(segment, folder):
    name = os.fsdecode(b"M\xf6bel")
    (folder / "box.off").rename(folder / f"{name}.off")
    suffixes = (".json", ".ply", ".obj", ".glb", ".svg", ".3mf", ".npz", ".html", ".vtu")
    sys.stderr.reconfigure(errors="backslashreplace")  # as outside of pytest
    code, err = segment(*(name + suffix for suffix in suffixes), shape=f"{name}.off")
    assert code == 0, err
    found = os.listdir(os.fsencode(folder))
    assert {b"M\xf6bel" + suffix.encode() for suffix in suffixes} <= set(found)
    content = (folder / f"{name}.json").read_bytes()
    assert json.loads(content)["shape"]["file_bytes"] == b"M\xf6bel.off".hex()
    result = moseg_core.load_result(folder / f"{name}.json")
    assert result.shape.file == f"{name}.off"
    moseg_core.save(result, "again.json")
    assert (folder / "again.json").read_bytes() == content


@pytest.mark.parametrize("closed", ["2>&-", "<&- >&- 2>&-"])
def test_closed_streams_are_no_failure(folder, closed):
    words = ["segment", "box.off", *WORDS, "--minimize", COST, "-o", "r.json"]
    command = [sys.executable, "-m", "moseg_core", *words]
    done = subprocess.run(
        ["sh", "-c", f'exec "$@" {closed}', "sh", *command], capture_output=True, text=True
    )
    assert done.returncode == 0
    assert "Traceback" not in done.stderr
    assert "moseg:" not in (folder / "r.json").read_text()
    assert ("narrow" in done.stdout) == (">&-" not in closed.split())
