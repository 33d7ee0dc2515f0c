"""Compiling is told of once when it begins and once when it ends, however deep it goes."""

from __future__ import annotations

from numba import njit

from moseg_core.batching.compilation import telling_of_compiling


def test_the_outermost_compilation_is_told_of():
    @njit
    def inner(x):
        return x + 1

    @njit
    def outer(x):
        return inner(x) * 2

    told = []
    with telling_of_compiling(told.append):
        assert outer(1) == 4
        assert outer(2) == 6
    assert told == [True, False]
    outer(1.5)
    assert told == [True, False]
