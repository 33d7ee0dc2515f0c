"""Which shapes are meant, what their results are called, and what makes two jobs the same."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from moseg_core.batching.jobs import (
    check_outputs,
    expand_shapes,
    job_key,
    shape_names,
    shape_stem,
)
from moseg_core.errors import UsageError


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def write(*names):
        for name in names:
            Path(name).parent.mkdir(parents=True, exist_ok=True)
            Path(name).write_text(name)

    return write


def test_patterns_stand_for_their_files_in_order_each_once(files):
    files("m/b.off", "m/a.off", "m/deep/c.off", "m/x.txt")
    assert expand_shapes(["m/*.off"]) == ("m/a.off", "m/b.off")
    assert expand_shapes(["m/b.off", "m/*.off"]) == ("m/b.off", "m/a.off")
    assert expand_shapes(["m/**/*.off"]) == ("m/a.off", "m/b.off", "m/deep/c.off")
    assert expand_shapes("m/a.off") == ("m/a.off",)


def test_a_file_may_be_called_like_a_pattern(files):
    files("a[1].off", "a1.off")
    assert expand_shapes(["a[1].off"]) == ("a[1].off",)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["m/c.of"], "did you mean 'm/c.off'"),
        (["m"], "is a folder; say which files in it, such as 'm/"),
        (["m/*.ply"], r"no file is called like 'm/\*.ply'"),
        (["n/*.off"], "there is no folder 'n'"),
        ([], "there are no shapes"),
    ],
)
def test_what_stands_for_nothing_is_refused(files, words, said):
    files("m/c.off")
    with pytest.raises(UsageError, match=said):
        expand_shapes(words)


def test_a_suffix_is_what_a_reader_goes_by():
    assert shape_stem(Path("a.v2.off")) == "a.v2"
    assert shape_stem(Path("a.PLY")) == "a"
    assert shape_stem(Path("a.b")) == "a"


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        (["m/a.off", "m/b.ply"], ["a", "b"]),
        (["m/x/a.off", "m/y/a.off", "m/b.off"], ["x-a", "y-a", "b"]),
        (["m/a.off", "m/y/a.off"], ["a", "y-a"]),
        (["m/x/A.off", "m/y/a.off"], ["x-A", "y-a"]),
        (["m/../a b.off"], ["a_b"]),
        (["m/con.off"], ["_con"]),
    ],
)
def test_names_are_safe_and_told_apart(paths, names):
    assert list(shape_names(paths)) == names


@pytest.mark.parametrize(
    "paths",
    [["m/a.off", "m/a.ply"], ["m/a b.off", "m/a_b.off"], ["m/x/a.off", "m/y/a.off", "m/x-a.off"]],
)
def test_names_that_cannot_be_told_apart_are_refused_by_name(paths):
    with pytest.raises(UsageError, match=f"the results of '{paths[0]}' and") as caught:
        shape_names(paths)
    assert sum(path in str(caught.value) for path in paths) == 2


@pytest.mark.parametrize(
    ("templates", "said"),
    [
        (["out/x.glb"], r"one file for all shapes; put \{shape\}"),
        (["out/{shape}.xyz"], r"cannot write files '\.xyz'"),
        (["no/{shape}.glb"], "there is no folder 'no'"),
        (["out/{shape}.json"], "the result that is written in any case"),
        (["out/{shape}.glb", "out/{shape}.glb"], "is given twice"),
        (["m/{shape}.obj"], "is one of the shapes"),
        (["out/{shape}/{part}.txt"], "one file per part"),
    ],
)
def test_outputs_that_cannot_be_are_refused(files, templates, said):
    files("m/a.obj", "out/x")
    with pytest.raises(UsageError, match=said):
        check_outputs(Path("out"), templates, ["m/a.obj"], ["a"])


def test_outputs_that_can_be_pass(files):
    files("m/a.obj", "out/x")
    templates = ["out/{shape}.glb", "out/{shape}/{part}.stl", "m/{shape}.png"]
    check_outputs(Path("out"), templates, ["m/a.obj"], ["a"])


def test_a_key_depends_on_all_that_a_result_depends_on(files):
    files("a.off", "b.off")
    Path("b.off").write_text("a.off")

    def key(shape="a.off", outputs=("a.json",), given="{}", components=(("x", "x 1.0"),)):
        return job_key(shape, outputs, given, dict(components))

    first = key()
    assert key() == first
    others = {
        key("b.off"),
        key(outputs=("a.json", "a.glb")),
        key(given='{"seed": 1}'),
        key(components=(("x", "x 1.1"),)),
    }
    Path("a.off").write_text("other")
    assert len({first, key(), *others}) == 6


def test_buffers_and_materials_count_too(files):
    files("a.obj", "b.bin", "secret.bin")
    before = job_key("a.obj", (), "", {})
    Path("a.mtl").write_text("newmtl x")
    assert job_key("a.obj", (), "", {}) != before
    Path("s.gltf").write_text(json.dumps({"buffers": [{"uri": "b.bin"}, {"uri": "data:x"}]}))
    before = job_key("s.gltf", (), "", {})
    Path("secret.bin").write_text("no part of it")
    assert job_key("s.gltf", (), "", {}) == before
    Path("b.bin").write_text("changed")
    assert job_key("s.gltf", (), "", {}) != before


@pytest.mark.parametrize("text", ["", "[]", '{"buffers": 3}', '{"buffers": [3]}', "[" * 100_000])
def test_a_file_that_is_none_has_a_key(files, text):
    files("s.gltf")
    Path("s.gltf").write_text(text)
    assert len(job_key("s.gltf", (), "", {})) == 32
    assert len(job_key("missing.gltf", (), "", {})) == 32
