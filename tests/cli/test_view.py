"""``moseg view``: a page from a shape and whatever bears its labels."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import moseg_core as moseg_api
from moseg_core.view.page.writer import write_html
from tests import shapes
from tests.results import result_on


@pytest.fixture
def files(tmp_path):
    """A box, and a result of it, in files."""
    write_polygons(tmp_path / "box.off", *shapes.box(3, 2, 1))
    result = result_on(moseg_api.load(tmp_path / "box.off"), warnings=("mind the gap",))
    for suffix in ("json", "seg", "ply", "glb"):
        moseg_api.save(result, tmp_path / f"found.{suffix}")
    return tmp_path, result


def write_polygons(path, vertices, faces):
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(map(repr, row)) for row in np.asarray(vertices).tolist()]
    lines += [f"{len(face)} " + " ".join(map(str, face)) for face in faces]
    path.write_text("\n".join(lines) + "\n")


def data_of(page):
    text = page.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.S).group(1))


def test_a_result_is_shown_with_its_costs_as_the_writer_shows_it(moseg, files):
    folder, result = files
    run = moseg("view", folder / "box.off", folder / "found.json", "-o", folder / "x.html")
    assert (run.code, run.out) == (0, "")
    assert run.err == f"moseg: wrote {folder / 'x.html'}\n"
    assert (folder / "x.html").read_bytes() == write_html(result)


@pytest.mark.parametrize("name", ["found.seg", "found.ply", "found.glb"])
def test_labels_alone_have_no_costs(moseg, files, name):
    folder, _ = files
    assert moseg("view", folder / "box.off", folder / name, "-o", folder / "x.html").code == 0
    data = data_of(folder / "x.html")
    assert data["cost"] is None
    areas = {part["name"]: part["area"] for part in data["parts"]}
    if name.endswith("seg"):
        assert areas == {"label 0": 11.0, "label 1": 11.0}
    else:
        assert areas == {"first": 11.0, "second": 11.0}


def test_a_result_alone_finds_its_shape_beside_it(moseg, files):
    folder, _ = files
    run = moseg("view", folder / "found.json", "-o", folder / "x.html")
    assert run.code == 0
    assert f"'found.json' is a result of '{folder / 'box.off'}'" in run.err
    assert data_of(folder / "x.html")["cost"] == 22.0


def test_a_result_alone_knows_from_where_its_shape_was_read(moseg, files):
    folder, _ = files
    (folder / "elsewhere").mkdir()
    moved = (folder / "found.json").rename(folder / "elsewhere" / "found.json")
    assert moseg("view", moved, "-o", folder / "x.html").code == 0


def test_a_result_alone_takes_no_other_shape_of_the_name(moseg, files):
    folder, _ = files
    (folder / "box.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    run = moseg("view", folder / "found.json", "-o", folder / "x.html")
    assert run.code == 3
    assert f"name it first: moseg view SHAPE {folder / 'found.json'}" in run.err


def test_numbers_that_are_left_out_are_no_parts(moseg, files):
    folder, result = files
    numbers = np.where(np.asarray(result.labels) == 0, 1, 7)
    (folder / "x.seg").write_text("\n".join(map(str, numbers)))
    assert moseg("view", folder / "box.off", folder / "x.seg", "-o", folder / "x.html").code == 0
    areas = {part["name"]: part["area"] for part in data_of(folder / "x.html")["parts"]}
    assert areas == {"label 1": 11.0, "label 7": 11.0}


def test_a_shape_that_bears_its_labels_needs_no_other_file(moseg, files):
    folder, _ = files
    assert moseg("view", folder / "found.ply", "-o", folder / "x.html").code == 0
    assert [part["name"] for part in data_of(folder / "x.html")["parts"]] == ["first", "second"]


def test_without_a_file_the_browser_opens_a_temporary_one(moseg, files, monkeypatch, tmp_path):
    folder, result = files
    place = tmp_path / "temporary"
    place.mkdir()
    opened = []
    monkeypatch.setattr("tempfile.tempdir", str(place))
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    run = moseg("view", folder / "box.off", folder / "found.json")
    (written,) = place.iterdir()
    assert run.err == f"moseg: wrote {written}\n"
    assert opened == [written.as_uri()]
    assert written.read_bytes() == write_html(result)
    run = moseg("view", folder / "box.off", folder / "found.json", "--no-open")
    assert len(opened) == 1
    monkeypatch.setattr("webbrowser.open", lambda address: False)
    run = moseg("view", folder / "box.off", folder / "found.json")
    assert "; open it in a browser" in run.err


def test_says_what_it_cannot_do(moseg, files):
    folder, _ = files
    box, labels = folder / "box.off", folder / "found.seg"
    for words, says in [
        ((box, labels, "-o", folder / "x.pdf"), "a page is written as .html, not '.pdf'"),
        ((box, labels, "-o", folder / "no" / "x.html"), "there is no folder"),
        ((box, "-o", folder / "x.html"), "bears no labels"),
        ((box, folder / "fond.json", "-o", folder / "x.html"), "did you mean"),
    ]:
        run = moseg("view", *words)
        assert run.code in (2, 3)
        assert says in run.err


def test_a_result_of_another_shape_is_said(moseg, files):
    folder, _ = files
    text = (folder / "found.json").read_text()
    damaged = re.sub(r'"fingerprint": "\w+"', '"fingerprint": "0"', text)
    (folder / "found.json").write_text(damaged)
    run = moseg("view", folder / "box.off", folder / "found.json", "-o", folder / "x.html")
    assert run.code == 0
    assert "is a result of another shape, 'box'" in run.err
