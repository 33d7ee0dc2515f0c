"""Running a command: errors and exit codes."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from moseg_core.errors import MosegError, PluginError, ShapeError, Terminated, UsageError


def run_command(moseg, monkeypatch, error):
    """What ``moseg recipes`` ends with where it raises."""

    def fail(*args, **options):
        raise error

    monkeypatch.setattr("moseg_core.cli.recipes.run_recipes", fail)
    return moseg("recipes")


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (MosegError("it broke"), 1),
        (PluginError("it broke"), 1),
        (UsageError("it broke"), 2),
        (ShapeError("it broke"), 3),
    ],
)
def test_an_error_is_its_message_and_its_exit_code(moseg, monkeypatch, error, code):
    run = run_command(moseg, monkeypatch, error)
    assert (run.code, run.out, run.err) == (code, "", "moseg: it broke\n")


def test_an_interruption_is_130(moseg, monkeypatch):
    run = run_command(moseg, monkeypatch, KeyboardInterrupt())
    assert (run.code, run.err) == (130, "moseg: interrupted\n")


@pytest.mark.parametrize(("number", "code"), [(15, 143), (1, 129)])
def test_told_to_end_it_is_128_and_the_signal(moseg, monkeypatch, number, code):
    run = run_command(moseg, monkeypatch, Terminated(number))
    assert (run.code, run.err) == (code, "moseg: told to end\n")


def test_an_error_of_the_system_names_its_file(moseg, monkeypatch):
    run = run_command(moseg, monkeypatch, OSError(5, "Input/output error", "shapes/a.off"))
    assert (run.code, run.err) == (1, "moseg: 'shapes/a.off': Input/output error\n")


def test_too_little_memory_is_told_in_a_line(moseg, monkeypatch):
    run = run_command(moseg, monkeypatch, MemoryError())
    assert (run.code, run.err) == (1, "moseg: there is not enough memory for that\n")


def test_no_terminal_obeys_a_message(moseg, monkeypatch):
    run = run_command(moseg, monkeypatch, UsageError("a\x1b[2J\nmoseg: wrote r.json"))
    assert run.err == r"moseg: a\x1b[2J\nmoseg: wrote r.json" + "\n"


def test_what_is_no_error_of_ours_keeps_its_traceback(moseg, monkeypatch):
    with pytest.raises(ZeroDivisionError):
        run_command(moseg, monkeypatch, ZeroDivisionError())


@pytest.mark.parametrize(("lines", "code"), [(1, 0), (None, 1)], ids=["reader gone", "disk full"])
def test_output_that_nobody_takes(lines, code):
    """``moseg plugin list | head -1`` is no failure; a full disk is one, told in a line."""
    command = [sys.executable, "-m", "moseg_core", "plugin", "list", "--json"]
    if lines is None:
        with open("/dev/full", "w") as full:
            done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
        assert done.stderr == "moseg: cannot write the output: No space left on device\n"
        assert done.returncode == code
        return
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True)
    os.close(writer)
    assert (done.returncode, done.stderr) == (code, "")


def test_words_that_are_left_over(moseg):
    run = moseg("segment", "a.ply", "b.ply", "c.ply", "--recipe", "hammer")
    assert run.code == 2
    assert run.err.startswith(
        "moseg: 'segment' takes one shape at a time, and has no use for 'b.ply'"
    )
    assert "moseg batch 'models/*.off' --recipe NAME -o out" in run.err
    run = moseg("explain", "a.json", "b.json")
    assert 'for f in *.ply; do moseg explain "$f" ... ; done' in run.err
    run = moseg("recipes", "a", "b")
    assert run.err == "moseg: 'recipes' has no use for 'b' (see 'moseg recipes --help')\n"


def test_without_plugins_only_the_core_is_there(moseg, monkeypatch):
    seen = []

    def look(*arguments, **options):
        seen.append(os.environ.get("MOSEG_NO_PLUGINS"))

    monkeypatch.delenv("MOSEG_NO_PLUGINS", raising=False)
    monkeypatch.setattr("moseg_core.cli.recipes.run_recipes", look)
    for words in (("--no-plugins", "recipes"), ("recipes", "--no-plugins"), ("recipes",)):
        assert moseg(*words).code == 0
    assert seen == ["1", "1", None]


def test_what_comes_after_two_dashes_is_no_option(moseg):
    run = moseg("recipes", "--", "--no-plugins")
    assert run.code == 2
    assert "--no-plugins" in run.err


LEFT = """
import sys, threading
from moseg_core.cli import recipes
from moseg_core.cli import main
recipes.run_recipes = lambda *given, **more: threading.Thread(
    target=threading.Event().wait, name="helper"
).start()
sys.argv = ["moseg", "recipes"]
main()
"""


def test_threads_that_components_leave_do_not_keep_the_process():
    done = subprocess.run([sys.executable, "-c", LEFT], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0
    assert done.stderr == "moseg: warning: threads of components go on: helper\n"
