"""What components do on the side of their calls."""

from __future__ import annotations

import os
import random
import signal
import threading
from pathlib import Path

import pytest

from moseg_core.components import side_effects
from moseg_core.components.side_effects import EndedProcessError, own_program, without_side_effects
from moseg_core.errors import PluginError

WHO = "seeder 'mine:far' of mine 1.0"


@pytest.fixture
def who(request):
    """A name of its own for each test: how closely is looked depends on earlier calls."""
    return f"{WHO} in {request.node.name}"


@pytest.fixture
def alone(monkeypatch):
    """As if no other threads ran: a library of an earlier test may keep some."""
    monkeypatch.setattr(side_effects, "_alone", lambda: True)


def call(who, does):
    with without_side_effects(who):
        does()


@pytest.mark.parametrize(
    ("does", "what"),
    [
        (lambda: os.chdir("/"), "the working directory"),
        (lambda: random.seed(2), "the global generator of random"),
        (lambda: signal.signal(signal.SIGUSR2, signal.SIG_IGN), "the handlers of signals"),
    ],
    ids=["chdir", "seed", "signal"],
)
def test_what_is_changed_is_named_and_undone(alone, who, does, what):
    here, state = Path.cwd(), random.getstate()
    with pytest.raises(PluginError, match=f"mine:far.* changed {what}.*report it"):
        call(who, does)
    assert (Path.cwd(), random.getstate()) == (here, state)
    assert signal.getsignal(signal.SIGUSR2) == signal.SIG_DFL


def test_the_directory_is_looked_at_with_each_call_and_the_rest_now_and_then(alone, who):
    for _ in range(4):
        call(who, lambda: None)
    state = random.getstate()
    for _ in range(3):  # the fifth to the seventh
        with pytest.raises(PluginError):
            call(who, lambda: os.chdir("/"))
    random.setstate(state)
    with pytest.raises(PluginError):
        call(who, lambda: random.seed(4))


def test_drawing_is_no_fault(who):
    call(who, random.random)


def test_an_error_of_the_call_comes_first_and_the_change_is_undone(alone, who):
    def fail():
        os.chdir("/")
        raise ZeroDivisionError

    here = Path.cwd()
    with pytest.raises(ZeroDivisionError):
        call(who, fail)
    assert Path.cwd() == here


def test_where_other_threads_run_nobody_is_blamed(who):
    over = threading.Event()
    other = threading.Thread(target=over.wait)
    other.start()
    state = random.getstate()
    try:
        call(who, lambda: random.seed(3))
    finally:
        over.set()
        other.join()
        random.setstate(state)


def test_in_a_program_of_its_own_the_first_that_is_printed_is_told(who, capsys):
    heard = []
    with own_program(lambda *said: heard.append(said)):
        for _ in range(3):
            call(who, lambda: print("hello", "there"))
        print("done")
    assert heard == [(who, "hello")]
    assert capsys.readouterr().out == "done\n"


def test_calls_within_calls_have_their_own_words(who, capsys):
    heard = []
    with own_program(lambda *said: heard.append(said)):
        with without_side_effects(f"{who}, without"):
            call(f"{who}, within", lambda: print("in"))
            print("out")
        print("done")
    assert heard == [(f"{who}, within", "in"), (f"{who}, without", "out")]
    assert capsys.readouterr().out == "done\n"


def test_nobody_ends_the_process_but_itself(who):
    leave = os._exit
    with own_program(lambda *said: None), pytest.raises(EndedProcessError, match=r"_exit\(0\)"):
        call(who, lambda: os._exit(0))
    assert os._exit is leave


def test_a_copy_of_the_process_ends_as_it_likes(who):
    def fork():
        process = os.fork()
        if not process:
            os._exit(7)
        assert os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) == 7

    with own_program(lambda *said: None):
        call(who, fork)


def test_elsewhere_printing_is_nobodys_business(who, capsys):
    call(who, lambda: print("hello"))
    assert capsys.readouterr().out == "hello\n"
