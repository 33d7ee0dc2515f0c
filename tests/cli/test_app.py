"""The commands of ``moseg`` and their help."""

from __future__ import annotations


def test_version_and_help(moseg):
    assert moseg("--version").out.startswith("moseg 0.")
    assert "segment" in moseg("--help").out
    assert "--minimize" in moseg("segment", "--help").out
