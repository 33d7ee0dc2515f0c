"""A command works where it was started."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from moseg_core.cli.working_folder import working_folder_kept


def test_whatever_happens_the_folder_is_that_of_before(tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")

    @working_folder_kept()
    def wander():
        os.chdir("/")
        (tmp_path / "here").rename(tmp_path / "there")
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        wander()
    assert Path.cwd() == tmp_path / "there"


def test_a_folder_that_is_gone_is_no_failure(tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    (tmp_path / "here").rmdir()
    with working_folder_kept():
        pass
    os.chdir(tmp_path)
