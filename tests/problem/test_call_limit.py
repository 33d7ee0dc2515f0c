"""Calls that take too long."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time

import pytest

from moseg_core.components.part import Part
from moseg_core.errors import PluginError, UsageError
from moseg_core.problem.call_limit import CallTimeoutError, is_limited, limited, limiting_calls
from moseg_core.problem.problem import Problem


def test_a_call_that_takes_too_long_ends_and_others_do_not():
    handler = signal.getsignal(signal.SIGALRM)
    with limiting_calls(0.2):
        assert is_limited()
        with limited("short"):
            pass
        with pytest.raises(CallTimeoutError, match=r"more than 0\.2 s"), limited("long"):
            time.sleep(60)
        with limited("short"):
            pass
    assert not is_limited()
    assert signal.getsignal(signal.SIGALRM) is handler


def test_one_that_catches_everything_is_told_again():
    def stubborn():
        for _ in range(2):
            try:
                time.sleep(60)
            except BaseException:  # noqa: BLE001  # that is what is tried
                continue
        time.sleep(60)

    with limiting_calls(0.1), pytest.raises(CallTimeoutError), limited("stubborn"):
        stubborn()


def test_an_alarm_between_two_calls_is_nobodys():
    """A limit that is over when the call begins rings before it, or after it."""
    with limiting_calls(1e-6):
        for _ in range(50):
            with contextlib.suppress(CallTimeoutError), limited("short"):
                pass
        time.sleep(0.4)
        assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_the_objective_is_named(row):
    def odd(part: Part) -> float:
        while True:
            pass

    with limiting_calls(0.1), pytest.raises(PluginError) as caught:
        Problem(["a"], "odd(a)", objectives={"odd": odd}).evaluate(row, [0] * 6)
    assert "objective 'python:odd' of the calling program took more than 0.1 s in 'odd(a)'" in str(
        caught.value
    )
    assert "test_call_limit.py:" in str(caught.value)


DEAF = """
import collections, itertools
from moseg_core.problem.call_limit import limited, limiting_calls
with limiting_calls(0.1), limited("objective 'acme:bore'"):
    collections.deque(itertools.repeat(0), maxlen=0)
"""


def test_a_call_that_never_comes_back_to_python_is_ended_by_somebody_else():
    done = subprocess.run([sys.executable, "-c", DEAF], stderr=subprocess.PIPE, text=True)
    assert done.returncode == -signal.SIGKILL
    assert done.stderr == (
        "moseg: objective 'acme:bore' takes too long, and cannot be interrupted; its process is"
        " ended\n"
    )


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("nan"), float("inf")])
def test_a_limit_is_a_positive_number(seconds):
    with pytest.raises(UsageError, match="must be more than 0"), limiting_calls(seconds):
        pass


def test_without_a_limit_nothing_is_started():
    with limiting_calls(None):
        assert not is_limited()
        assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert os.getpid()
