"""What every component promises when it runs: the same again, and nothing on the side.

Most checks compare two runs (:mod:`moseg_core.testing.fixtures.drivers`): pickled and not, in one
process and another, on one thread and on two. The search relies on all of it. Values are
remembered, runs are repeated from a seed, interrupted and resumed, and shared among processes.
"""

from __future__ import annotations

import os
import pickle
import random
import sys
import tempfile
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from typing import Any

import numpy as np

from moseg_core.components.faults import FAULTS, describe
from moseg_core.testing.check import ContractFailure, Subject, check
from moseg_core.testing.fixtures.comparison import (
    Answers,
    Raised,
    attempt,
    expect_no_error,
    expect_same,
)
from moseg_core.testing.fixtures.drivers import drive, run
from moseg_core.testing.fixtures.trial import DRIVEN, Trial
from moseg_core.testing.processes.other_hash_seed import ChildError, drive_elsewhere


def baseline(subject: Subject) -> Answers:
    """What comes of the component, once for all checks that compare with it."""
    result: Answers = subject.keep("baseline", lambda: drive(subject))
    return result


@check("runs-on-the-zoo", kinds=tuple(k for k in DRIVEN if k not in ("objective", "field")))
def _runs_on_the_zoo(subject: Subject) -> None:
    """Shapes are open, flat, scattered or single faces, and a search must not end on one."""
    expect_no_error(
        baseline(subject),
        did="it was run on a small shape",
        excused=subject.component.kind in ("embedding", "constraint"),
        fix="handle the case; raise moseg_core.ShapeError where the kind allows it; or say in"
        " requires=(...) of the spec, where the kind has it, what a shape must have",
    )


@check("pickles", kinds=DRIVEN)
def _pickles(subject: Subject) -> None:
    """Runs are interrupted and resumed, and shared among processes, as pickles."""

    def packed(made: Any) -> Any:
        try:
            return pickle.loads(pickle.dumps(made))
        except FAULTS as error:
            raise ContractFailure(
                did=f"the {type(made).__name__} was pickled and unpickled",
                got=describe(error),
                expected="the same object again",
                fix="keep no open files, locks, lambdas or local functions in it, and let a"
                " decorated function keep its module and name",
            ) from error

    expect_same(
        baseline(subject),
        drive(subject, through=packed),
        did="it was run as it is, and after it was pickled and unpickled",
        fix="let its pickled state hold everything that it works with",
    )


@check("inputs-untouched", kinds=DRIVEN)
def _inputs_untouched(subject: Subject) -> None:
    """Arrays are shared by all components and remembered; a change shows up elsewhere."""
    for read_only in (False, True):
        trial = Trial(subject=subject, read_only=read_only)
        found = run(trial)
        if changed := trial.changed():
            raise ContractFailure(
                did="it was run, and the arrays that it could reach were looked at",
                got=f"{changed[0]} had changed",
                expected="the contents from before",
                fix="work on a copy: array.copy()",
            )
        expect_same(
            baseline(subject),
            found,
            did=f"it was given {'read-only' if read_only else 'writable'} arrays",
            fix="work on a copy: array.copy()",
        )


@check("same-in-every-process", kinds=DRIVEN)
def _same_in_every_process(subject: Subject) -> None:
    """A run must come out the same tomorrow; the order of sets and hashes of texts does not."""
    baseline(subject)  # skips where it cannot be run
    results = []
    for hash_seed in (1, 2):
        try:
            results.append(drive_elsewhere(subject, hash_seed=hash_seed))
        except ChildError as error:
            raise ContractFailure(
                did=f"it was run in a process of its own with PYTHONHASHSEED={hash_seed}",
                got=str(error),
                expected="what it gives in this one",
                fix="let it depend on nothing but its module and its inputs",
            ) from error
    expect_same(
        *results,
        did="it was run in two processes, with PYTHONHASHSEED=1 and 2",
        fix="sort what comes out of a set; use no hash() and no id(); draw random numbers only"
        " from the generator that is handed over",
    )


@check("random-state-untouched", kinds=DRIVEN)
def _random_state_untouched(subject: Subject) -> None:
    """Who seeds the global generators must not have them moved by a component."""
    baseline(subject)
    before = _random_states()
    drive(subject)
    for name, state in _random_states().items():
        if state != before[name]:
            raise ContractFailure(
                did=f"it was run, and the global generator of {name} was looked at",
                got="another state than before",
                expected="the state from before",
                fix="use the rng that is handed over, or np.random.default_rng(0) where none is",
            )


def _random_states() -> dict[str, str]:
    return {
        "numpy.random": repr(pickle.dumps(np.random.get_state())),  # noqa: NPY002  # to be looked at
        "random": repr(random.getstate()),
    }


@check("silent", kinds=DRIVEN)
def _silent(subject: Subject) -> None:
    """It is called some ten thousand times a run, and standard output may be a pipe."""
    baseline(subject)  # what is imported on first use may say what it likes
    with _listening() as heard:
        drive(subject)
    for where, text in heard.items():
        if text:
            raise ContractFailure(
                did=f"it was run, and {where} was listened to",
                got=repr(text[:120]),
                expected="nothing",
                fix="take out prints; report progress where the kind has a way to; handle what"
                " numpy warns of, or wrap it in np.errstate",
            )


@contextmanager
def _listening() -> Iterator[dict[str, str]]:
    """Texts that go to standard output and error, below Python too, and warnings."""
    heard: dict[str, str] = {}
    with tempfile.TemporaryFile("w+b") as out, tempfile.TemporaryFile("w+b") as err:
        files = {1: out, 2: err}
        sys.stdout.flush()
        sys.stderr.flush()
        kept = {number: os.dup(number) for number in files}
        texts = {number: os.fdopen(os.dup(file.fileno()), "w") for number, file in files.items()}
        try:
            for number, file in files.items():
                os.dup2(file.fileno(), number)
            with (
                redirect_stdout(texts[1]),
                redirect_stderr(texts[2]),
                warnings.catch_warnings(record=True) as warned,
            ):
                warnings.simplefilter("always")
                yield heard
        finally:
            for number, original in kept.items():
                texts[number].close()
                os.dup2(original, number)
                os.close(original)
            for number, name in ((1, "standard output"), (2, "standard error")):
                files[number].seek(0)
                heard[name] = files[number].read().decode(errors="replace")
    shown = [w for w in warned if not issubclass(w.category, _FOR_DEVELOPERS)]
    heard["warnings"] = "; ".join(f"{w.category.__name__}: {w.message}" for w in shown)


_FOR_DEVELOPERS = (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning)
"""Warnings that Python does not show to users."""


@check("usable-from-two-threads", kinds=DRIVEN)
def _usable_from_two_threads(subject: Subject) -> None:
    """A program that embeds moseg may segment two shapes at a time."""
    alone = baseline(subject)
    found: dict[bool, Answers] = {}
    start = threading.Barrier(2)

    def work(backwards: bool) -> None:
        start.wait()
        with suppress(SystemExit):  # ends only a thread that is not the main one, and says nothing
            answers = attempt(drive, subject, backwards=backwards)
            found[backwards] = {"all": answers} if isinstance(answers, Raised) else answers

    threads = [threading.Thread(target=work, args=(backwards,)) for backwards in (False, True)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    did = "it was run alone, and on two threads at the same time"
    for backwards in (False, True):
        if backwards not in found:
            raise ContractFailure(
                did=did,
                got="no answer from one of the threads, which had ended",
                expected="the same",
                fix="raise an error where something is wrong; no sys.exit()",
            )
        expect_same(
            alone,
            found[backwards],
            did=did,
            fix="keep nothing of a call outside of it: no globals, no attributes that one call"
            " writes and reads again",
        )
