"""``moseg plugin new``."""

from __future__ import annotations

import pytest


def test_new_writes_a_bundle_and_says_what_is_next(moseg, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = moseg("plugin", "new", "steel_parts", "--kind", "seeder")
    assert run.code == 0, run.err
    assert (tmp_path / "moseg-steel-parts" / "src" / "moseg_steel_parts" / "scattered.py").exists()
    for line in ("  cd moseg-steel-parts", "  pytest", "  moseg plugin check steel_parts"):
        assert line in run.out.splitlines()
    again = moseg("plugin", "new", "steel_parts")
    assert again.code == 2
    assert "'moseg-steel-parts' is there already" in again.err


def test_new_elsewhere(moseg, tmp_path):
    assert moseg("plugin", "new", "a", "-o", tmp_path / "here").code == 0
    assert (tmp_path / "here" / "src" / "moseg_a" / "slender.py").exists()


@pytest.mark.parametrize(
    ("name", "owner"),
    [
        ("basic", "moseg-objectives-basic 0.1.0, which is installed"),
        ("core", "moseg-core 0.1.0, which is installed"),
        ("objectives_basic", "an installed package 'moseg_objectives_basic'"),
    ],
)
def test_new_refuses_names_in_use(moseg, tmp_path, name, owner):
    run = moseg("plugin", "new", name, "-o", tmp_path / "here")
    assert run.code == 2
    assert f"'{name}' is taken by {owner}" in run.err
    assert not (tmp_path / "here").exists()


def test_new_says_what_names_and_kinds_there_are(moseg, tmp_path):
    run = moseg("plugin", "new", "Steel-Parts", "-o", tmp_path / "here")
    assert run.code == 2
    assert "lower-case letters, digits and _" in run.err
    assert "did you mean 'steel_parts'" in run.err
    run = moseg("plugin", "new", "steel", "--kind", "objectiv", "-o", tmp_path / "here")
    assert run.code == 2
    assert "objective" in run.err
