"""``moseg --install-completion``: a shell's script for all commands."""

from __future__ import annotations

from pathlib import Path


def test_a_script_of_all_commands_is_written_where_the_shell_looks(moseg, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    run = moseg("--install-completion", "--shell", "fish")
    assert run.code == 0, run.err
    (script,) = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert str(script) in run.err
    text = script.read_text(encoding="utf-8")
    for word in ("segment", "render", "recipe", "learn"):  # the last is a bundle's
        assert word in text


def test_a_shell_that_cannot_be_told(moseg, monkeypatch):
    def fail():
        raise RuntimeError("no shell")

    monkeypatch.setattr("cyclopts.completion.detect.detect_shell", fail)
    run = moseg("--install-completion")
    assert run.code == 2
    assert "moseg --install-completion --shell bash" in run.err
