"""What every component promises when it runs: the same again, and nothing on the side.

Most checks compare two runs (:mod:`moseg_core.testing.fixtures.drivers`): pickled and not, in one
process and another, on one thread and on two. The search relies on all of it. Values are
remembered, runs are repeated from a seed, interrupted and resumed, and shared among processes.
"""

from __future__ import annotations

import pickle
import threading
from contextlib import suppress
from typing import Any

from moseg_core.components.faults import FAULTS, describe
from moseg_core.components.process_state import AT_IMPORT
from moseg_core.testing.check import ContractFailure, Subject, check
from moseg_core.testing.fixtures.comparison import (
    Answers,
    Raised,
    attempt,
    expect_no_error,
    expect_same,
)
from moseg_core.testing.fixtures.drivers import drive, run
from moseg_core.testing.fixtures.observation import listening, observed
from moseg_core.testing.fixtures.trial import DRIVEN, Trial
from moseg_core.testing.processes.other_hash_seed import ChildError, drive_elsewhere


def baseline(subject: Subject) -> Answers:
    """What comes of the component, once for all checks that compare with it."""
    result: Answers = _first_run(subject)[0]
    return result


def _first_run(subject: Subject) -> tuple[Answers, dict[str, str]]:
    """What comes of the component when it is first run, and what that changes of the process."""
    found: tuple[Answers, dict[str, str]] = subject.keep(
        "first run", lambda: observed(lambda: drive(subject), AT_IMPORT, draws=False)
    )
    return found


def _watched_run(subject: Subject) -> tuple[dict[str, str], dict[str, str]]:
    """What a second run changes of the process, and what it says."""
    _first_run(subject)  # what is imported on first use may say what it likes

    def run_again() -> tuple[dict[str, str], dict[str, str]]:
        with listening() as heard:
            _, changes = observed(lambda: drive(subject))
        return changes, heard

    found: tuple[dict[str, str], dict[str, str]] = subject.keep("watched run", run_again)
    return found


def side_effects(subject: Subject) -> dict[str, str]:
    """What runs of the component change of the process, each with more about it in words."""
    return {**_watched_run(subject)[0], **_first_run(subject)[1]}


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
        trial = Trial(subject=subject, read_only=read_only, closely=True)
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
    for name in side_effects(subject):
        if name.startswith("the global generator"):
            raise ContractFailure(
                did=f"it was run, and {name} was looked at",
                got="another state than before",
                expected="the state from before",
                fix="use the rng that is handed over, or np.random.default_rng(0) where none is",
            )


@check("silent", kinds=DRIVEN)
def _silent(subject: Subject) -> None:
    """It is called some ten thousand times a run, and standard output may be a pipe."""
    for where, text in _watched_run(subject)[1].items():
        if text:
            raise ContractFailure(
                did=f"it was run, and {where} was listened to",
                got=repr(text[:120]),
                expected="nothing",
                fix="take out prints; report progress where the kind has a way to; handle what"
                " numpy warns of, or wrap it in np.errstate",
            )


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
