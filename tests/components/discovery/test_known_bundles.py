"""The record of bundles that were imported before."""

from __future__ import annotations

import json
import os

import pytest

from moseg_core.components.discovery import known_bundles
from moseg_core.components.discovery.distributions import read_claims
from moseg_core.components.discovery.known_bundles import (
    Verdict,
    files_of_package,
    identity,
    read_known,
    record_folders,
    remember,
    stamp,
    stamps,
)


@pytest.fixture
def folders(tmp_path, monkeypatch):
    found = [str(tmp_path / "first"), str(tmp_path / "second")]
    monkeypatch.setattr(known_bundles, "record_folders", lambda: found)
    return found


def test_what_is_kept_is_read_again(folders, tmp_path):
    file = tmp_path / "a.py"
    file.write_text("1")
    kept = Verdict(problem="it ends", printed="hello", files=stamps([str(file)]))
    remember({"a": kept, "b": Verdict()})
    assert read_known(["a", "c"]) == {"a": kept}
    file.write_text("12")
    assert read_known(["a", "b"]) == {"b": Verdict()}
    remember({"c": Verdict()})
    assert read_known(["a", "b", "c"]) == {"b": Verdict(), "c": Verdict()}


def test_the_next_folder_is_taken_where_one_cannot_be_written_to(folders, tmp_path):
    (tmp_path / "first").write_text("a file in the way")
    remember({"a": Verdict()})
    assert os.listdir(folders[1]) == ["moseg-bundles.json"]
    assert read_known(["a"]) == {"a": Verdict()}


def test_where_nothing_can_be_written_nothing_is_kept(folders, tmp_path):
    (tmp_path / "first").write_text("")
    (tmp_path / "second").write_text("")
    remember({"a": Verdict()})
    assert read_known(["a"]) == {}


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        "[" * 100_000,
        '{"form": 2, "bundles": {"a": {}}}',
        '{"form": 1, "bundles": {"a": null}}',
        '{"form": 1, "bundles": {"a": {"problem": "", "printed": "", "files": {"b": [1]}}}}',
        b"\xff",
    ],
)
def test_a_record_that_is_none_remembers_nothing(folders, text):
    os.makedirs(folders[0])
    path = os.path.join(folders[0], "moseg-bundles.json")
    with open(path, "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode())
    assert read_known(["a"]) == {}
    remember({"a": Verdict()})
    assert read_known(["a"]) == {"a": Verdict()}


def test_only_so_much_is_kept(folders, monkeypatch):
    monkeypatch.setattr(known_bundles, "_MOST", 3)
    for k in range(6):
        remember({str(k): Verdict()})
    with open(os.path.join(folders[0], "moseg-bundles.json"), encoding="utf-8") as file:
        assert len(json.load(file)["bundles"]) <= 4


def test_the_place_that_is_named_comes_first(monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/some/where")
    assert next(iter(record_folders())) == "/some/where"


def test_a_file_in_an_archive_has_the_stamp_of_the_archive(tmp_path):
    archive = tmp_path / "a.zip"
    archive.write_bytes(b"zip")
    assert stamp(str(archive / "a" / "b.py")) == stamp(str(archive)) != (0, 0)
    assert stamp(str(tmp_path / "gone")) == (0, 0)


def test_a_bundle_is_known_by_its_distribution_and_its_files(site):
    site.add("Acme", "1.5", bundles={"acme": "acme_bundle"}, acme_bundle="")
    (claim,) = read_claims(site.entry_points())
    assert "acme = acme_bundle of Acme 1.5 in " in identity(claim)
    assert list(files_of_package(claim)) == [str(site.folder / "acme_bundle.py")]
