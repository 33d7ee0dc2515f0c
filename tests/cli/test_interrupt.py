"""Ctrl-C in a long run."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys

import pytest

from moseg_core.cli.interrupt import Stop, stop_on_interrupt
from moseg_core.errors import Terminated

SENTENCE = "3*narrow(handle) + perpendicular(handle, head) + convex_parts"


def interrupted(words, cwd, number=signal.SIGINT):
    """Run the command line and press Ctrl-C, or send another signal, in the middle of a search."""
    process = subprocess.Popen(
        # One process: a copy of it would not see that the signal has come.
        [sys.executable, "-u", "-c", _RUNNER, *words, "--workers", "1"],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    for line in process.stderr:
        if "polling" in line:
            process.send_signal(number)
            break
    out, err = process.communicate(timeout=120)
    return process.returncode, out, err


# The search says when it polls and then waits, so that the signal comes in the middle of it.
_RUNNER = """
import signal, sys, time
# A job in the background of a shell starts with the signal ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
import moseg_core.builtin.pattern_search as module
ask = module.PatternSearch.ask
count = 0
def slow(self):
    global count
    count += 1
    if count == 3:
        print("polling", file=sys.stderr, flush=True)
        until = time.monotonic() + 60
        while time.monotonic() < until and not stopped:
            time.sleep(0.01)
    return ask(self)
module.PatternSearch.ask = slow
stopped = []
import moseg_core.cli.interrupt as interrupt
say = interrupt.message
interrupt.message = lambda text: (stopped.append(1), say(text))
from moseg_core.cli import main
main(sys.argv[1:])
"""


def test_ctrl_c_writes_the_best_so_far_when_outputs_were_asked_for(mallet, tmp_path):
    out = tmp_path / "cut.json"
    code, _, err = interrupted(
        ["segment", str(mallet), "--recipe", "paper_hammer", "-o", str(out)], "."
    )
    assert code == 130
    assert "finishing with the best so far" in err
    assert json.loads(out.read_text())["reason"] == "interrupted"
    assert "interrupted" in json.loads(out.read_text())["warnings"][0]


def test_ctrl_c_without_outputs_ends_at_once(mallet, tmp_path):
    code, out, err = interrupted(["segment", str(mallet), "--recipe", "paper_hammer"], ".")
    assert code == 130
    assert out == ""
    assert "interrupted" in err


def test_told_to_end_it_writes_the_best_so_far_too(mallet, tmp_path):
    out = tmp_path / "cut.json"
    words = ["segment", str(mallet), "--recipe", "paper_hammer", "-o", str(out)]
    code, _, err = interrupted(words, ".", signal.SIGTERM)
    assert code == 143
    assert "told to end; finishing with the best so far" in err
    assert json.loads(out.read_text())["reason"] == "interrupted"


def test_the_second_signal_ends_at_once_and_what_was_there_before_is_back():
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = [signal.default_int_handler, signal.SIG_DFL, signal.SIG_DFL]
    # Behind a shell, or under nohup, some are ignored.
    first = [signal.signal(*each) for each in zip(numbers, before, strict=True)]
    with stop_on_interrupt(wanted=True) as stop:
        stop.raise_if_asked()
        assert not stop()
        os.kill(os.getpid(), signal.SIGHUP)
        assert stop()
        with pytest.raises(Terminated) as ended:
            stop.raise_if_asked()
        assert ended.value.exit_code == 129
        with pytest.raises(Terminated) as ended:
            os.kill(os.getpid(), signal.SIGTERM)
        assert ended.value.exit_code == 143
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
    assert [signal.getsignal(number) for number in numbers] == before
    for number, handler in zip(numbers, first, strict=True):
        signal.signal(number, handler)


def test_what_is_ignored_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does
    try:
        with stop_on_interrupt(wanted=True) as stop:
            os.kill(os.getpid(), signal.SIGHUP)
            assert not stop()
        assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_signal_in_the_middle_of_a_line_is_heard_without_words(monkeypatch):
    def reentered(text):
        raise RuntimeError("reentrant call")

    monkeypatch.setattr("moseg_core.cli.interrupt.message", reentered)
    stop = Stop()
    stop.note(signal.SIGTERM, None)
    assert stop()
