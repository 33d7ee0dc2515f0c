"""Kernels are compiled also where nothing can be kept on disk."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.shape import compiled


def doubled(values: np.ndarray) -> None:
    for k in range(len(values)):
        values[k] *= 2.0


def run(kernel):
    values = np.arange(3.0)
    kernel(values)
    return values.tolist()


def test_a_kernel_does_what_the_function_does():
    kernel = compiled.kernel(doubled)
    assert run(kernel) == run(doubled) == [0.0, 2.0, 4.0]
    assert len(kernel.nopython_signatures) == 1
    assert kernel.targetoptions["nogil"]


def test_where_no_folder_can_be_written_to_kernels_are_compiled_anew(monkeypatch):
    plain, asked = compiled.njit, []

    def no_folder(*, cache: bool = False, nogil: bool):
        asked.append(cache)
        if cache:
            raise RuntimeError("cannot cache function 'doubled': no locator available")
        return plain(nogil=nogil)

    monkeypatch.setattr(compiled, "njit", no_folder)
    kernel = compiled.kernel(doubled)
    assert asked == [True, False]
    assert run(kernel) == [0.0, 2.0, 4.0]
    assert kernel.targetoptions["nogil"]


def test_other_errors_are_not_taken_for_a_missing_folder():
    with pytest.raises(TypeError):
        compiled.kernel(3)
