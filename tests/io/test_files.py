"""Reading and writing by suffix: which component is asked, and what is left on the disk."""

from __future__ import annotations

import os
import sys
import types
from pathlib import Path

import pytest

import moseg_core
from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import ReaderSpec, WriterSpec
from moseg_core.errors import MosegError, PluginError, ShapeError, UsageError
from moseg_core.io.files import check_destination, check_output, files_of, load, save
from moseg_core.io.result_json import read_result
from tests.results import result_on


@pytest.fixture
def acme(monkeypatch):
    """A registry of readers and writers that are functions of a module made for the test."""
    home = types.ModuleType("acme_formats")
    monkeypatch.setitem(sys.modules, "acme_formats", home)

    def make(**functions):
        home.__dict__.update(functions)
        specs = [
            kind(name=name, target=f"acme_formats:{name}", suffixes=(f".{name}",))
            for name in functions
            for kind in (ReaderSpec, WriterSpec)
        ]
        parts = tuple(Component("acme", "moseg-acme 1.4", spec) for spec in specs)
        return Registry((Bundle("acme", "moseg-acme", "1.4", "acme", parts),))

    return make


def test_the_suffix_says_which_reader_is_asked(acme, tmp_path, box):
    asked = []
    source = acme(tee=lambda path: asked.append(path) or box, other=lambda path: None)
    path = tmp_path / "x.TEE"
    path.touch()
    found = load(path, source=source)
    assert (found.geometry, found.file) == (box.geometry, str(path))
    assert load(str(path), source=source).geometry is box.geometry
    assert asked == [path, path]


def test_of_a_file_that_is_not_there_the_nearest_is_named(acme, tmp_path):
    source = acme(tee=lambda path: pytest.fail("asked"))
    (tmp_path / "camel.tee").touch()
    with pytest.raises(ShapeError, match=r"did you mean '.*camel\.tee'\?"):
        load(tmp_path / "cammel.tee", source=source)
    with pytest.raises(ShapeError, match=r"zzz\.tee' does not exist$"):
        load(tmp_path / "zzz.tee", source=source)
    with pytest.raises(ShapeError, match=r"; there is no folder '.*elsewhere'"):
        load(tmp_path / "elsewhere" / "camel.tee", source=source)


def test_what_is_not_there_is_said_before_a_reader_is_asked(acme, tmp_path):
    source = acme(tee=lambda path: pytest.fail("asked"))
    with pytest.raises(ShapeError, match=r"x\.tee' does not exist"):
        load(tmp_path / "x.tee", source=source)
    (tmp_path / "folder.tee").mkdir()
    with pytest.raises(ShapeError, match="is a folder; name a file in it"):
        load(tmp_path / "folder.tee", source=source)
    with pytest.raises(UsageError, match=r"cannot read files '\.tea'; formats: \.tee"):
        load(tmp_path / "x.tea", source=source)


def failing(error):
    def read(path):
        raise error

    return read


@pytest.mark.parametrize(
    ("reader", "kind", "says"),
    [
        (lambda path: 3, PluginError, "reader 'acme:tee' of moseg-acme 1.4 returned a int, not a"),
        (failing(KeyError("x")), PluginError, r"of moseg-acme 1\.4 failed on '.*x\.tee'"),
        (failing(ShapeError("torn")), ShapeError, "^torn$"),
        (failing(PermissionError(13, "Permission denied")), ShapeError, "read: Permission"),
    ],
)  # fmt: skip
def test_a_reader_that_fails_is_named_unless_it_is_the_files_fault(
    acme, tmp_path, reader, kind, says
):
    path = tmp_path / "x.tee"
    path.touch()
    with pytest.raises(kind, match=says):
        load(path, source=acme(tee=reader))


def test_a_writer_gets_the_result_and_gives_the_bytes(acme, tmp_path, box):
    result = result_on(box)
    source = acme(tee=lambda given: f"{given.shape.name}".encode())
    save(result, tmp_path / "x.tee", source=source)
    assert (tmp_path / "x.tee").read_bytes() == b"box"
    with pytest.raises(PluginError, match=r"writer 'acme:tee' .* returned a str, not bytes"):
        save(result, tmp_path / "y.tee", source=acme(tee=lambda given: "text"))
    assert os.listdir(tmp_path) == ["x.tee"]


def test_a_writer_that_takes_a_name_may_return_several_files(acme, tmp_path, box):
    def write(result, *, name):
        stem = name.removesuffix(".tee")
        return {name: b"mesh", f"{stem}.mtl": b"materials", "maps/skin.png": b"skin"}

    result, source = result_on(box), acme(tee=write)
    assert files_of(result, tmp_path / "x.tee", source=source) == {
        tmp_path / "x.mtl": b"materials",
        tmp_path / "maps" / "skin.png": b"skin",
        tmp_path / "x.tee": b"mesh",
    }
    assert os.listdir(tmp_path) == []
    save(result, tmp_path / "x.tee", source=source)
    assert sorted(os.listdir(tmp_path)) == ["maps", "x.mtl", "x.tee"]
    assert (tmp_path / "maps" / "skin.png").read_bytes() == b"skin"


def test_a_name_that_the_user_chose_is_not_held_against_the_writer(acme, tmp_path, box):
    source = acme(tee=lambda result, *, name: {name: b"mesh", "x.mtl": b"materials"})
    save(result_on(box), tmp_path / "a:b.tee", source=source)
    assert sorted(os.listdir(tmp_path)) == ["a:b.tee", "x.mtl"]


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("/etc/x", "a name that is not relative or not safe"),
        ("../x", "a name that is not relative or not safe"),
        ("maps/../../x", "a name that is not relative or not safe"),
        ("./x", "a name that is not relative or not safe"),
        ("", "a name that is not relative or not safe"),
        ("maps/", "a name that is not relative or not safe"),
        ("C:x", "a name that is not relative or not safe"),
        ("..\\x", "a name that is not relative or not safe"),
        ("x\n", "a name that is not relative or not safe"),
        (3, "no name"),
        ("elsewhere/x", "a place outside of the folder"),
        ("folder", "the name of a folder"),
    ],
)
def test_files_stay_in_the_folder_that_was_named(acme, tmp_path, box, name, says):
    out = tmp_path / "out"
    (out / "folder").mkdir(parents=True)
    (tmp_path / "other").mkdir()
    (out / "elsewhere").symlink_to(tmp_path / "other")
    source = acme(tee=lambda given: {"x.tee": b"", name: b""})
    with pytest.raises(PluginError, match=f"writer 'acme:tee' of moseg-acme 1.4 returned {says}"):
        save(result_on(box), out / "x.tee", source=source)
    assert sorted(os.listdir(out)) == ["elsewhere", "folder"]


@pytest.mark.parametrize(
    ("made", "says"),
    [
        ({"x.tee": "text"}, "returned no bytes for the file 'x.tee'"),
        ({}, "returned the files none, but not 'x.tee'"),
        ({"y.tee": b""}, "returned the files y.tee, but not 'x.tee'.*takes 'name' by keyword"),
        ([b""], "returned a list, not bytes;"),
        (None, "returned a NoneType, not bytes;"),
    ],
)
def test_what_is_not_files_is_not_written(acme, tmp_path, box, made, says):
    with pytest.raises(PluginError, match=says):
        save(result_on(box), tmp_path / "x.tee", source=acme(tee=lambda given: made))
    assert os.listdir(tmp_path) == []


def test_a_destination_is_checked_before_the_search(tmp_path):
    assert check_output(tmp_path / "x.json").id == "core:json"
    with pytest.raises(UsageError, match=r"cannot write files '\.docx'"):
        check_output(tmp_path / "x.docx")
    (tmp_path / "x.ply").mkdir()
    with pytest.raises(UsageError, match="it is a folder"):
        check_output(tmp_path / "x.ply")
    with pytest.raises(UsageError, match=r"there is no folder '.*nowhere'"):
        check_destination(tmp_path / "nowhere" / "x.json")


def test_every_suffix_that_is_installed_has_one_writer_and_reader_at_most():
    for kind in ("reader", "writer"):
        suffixes = [s for c in registry().components(kind) for s in c.spec.suffixes]
        assert len(suffixes) == len(set(suffixes))


@pytest.mark.parametrize("kind", [str, Path])
def test_a_path_may_be_a_text(tmp_path, box, kind):
    """Every public function that reads or writes a file takes both."""

    def at(name):
        return kind(tmp_path / name)

    result = result_on(box)
    moseg_core.save(result, at("x.json"))
    moseg_core.save_labels(result.labels, at("x.seg"))
    moseg_core.write_file(at("x.off"), b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    for name in ("x.json", "x.seg"):
        found = moseg_core.read_labels(at(name), box.n_elements)
        assert found.labels.tolist() == result.labels.tolist()
    assert read_result(at("x.json")).names == result.problem.labels
    assert moseg_core.load(at("x.off")).n_elements == 1
    for read in (lambda path: moseg_core.read_labels(path, 3), read_result, moseg_core.load):
        with pytest.raises(MosegError, match="none"):
            read(at("none.json" if read is not moseg_core.load else "none.off"))
