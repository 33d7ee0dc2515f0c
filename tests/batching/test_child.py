"""A child undoes what the next shape would notice; the rest is tested with its guard."""

from __future__ import annotations

import os
import random

import numpy as np
import pytest

from moseg_core.batching.child import _answer


@pytest.fixture
def keep_state(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plain, numpy = random.getstate(), np.random.get_state()  # noqa: NPY002  # what is restored
    yield
    random.setstate(plain)
    np.random.set_state(numpy)  # noqa: NPY002  # likewise


def request(folder):
    return {
        "task": "solve",
        "here": str(folder),
        "seed": 3,
        "shape": "a",
        "outputs": [],
        "instructions": "{}",
    }


def test_each_job_begins_in_the_same_state(keep_state, tmp_path):
    seen = []

    def job(shape, outputs, instructions):
        own = float(np.random.random())  # noqa: NPY002  # as a component may
        seen.append((os.getcwd(), random.random(), own))
        os.chdir("/")
        return {"kind": "ok"}

    for _ in range(2):
        assert _answer(job, request(tmp_path))["kind"] == "ok"
    assert seen[0] == seen[1]


@pytest.mark.parametrize("error", [KeyboardInterrupt(), GeneratorExit(), RecursionError("deep")])
def test_whatever_is_raised_is_an_answer(keep_state, tmp_path, error):
    def job(shape, outputs, instructions):
        raise error

    answer = _answer(job, request(tmp_path))
    assert answer["kind"] == "plugin error"
    assert type(error).__name__ in answer["message"]
    assert answer["seconds"] >= 0


def test_a_folder_that_is_not_there_is_told(keep_state, tmp_path):
    answer = _answer(lambda *given: {"kind": "ok"}, request(tmp_path / "none"))
    assert answer["kind"] == "failed"
    assert "none" in answer["message"]
