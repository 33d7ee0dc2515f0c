"""What every component leaves alone: the process that it runs in belongs to others.

Working directory, signal handlers, threads and the rest of
:mod:`moseg_core.components.process_state` are the program's. They are looked at around two runs of
the component (:func:`moseg_core.testing.checks.repeats.side_effects`), and where its module and its
bundle's are first imported. What is put into a process by importing libraries, variables of the
environment for one, is excused at import and in the first run.
"""

from __future__ import annotations

from collections.abc import Collection

from moseg_core.components.discovery.registry import NOT_INSTALLED
from moseg_core.components.process_state import told
from moseg_core.testing.check import ContractFailure, Subject, check
from moseg_core.testing.checks.general import ALL, bundle_import, target_import
from moseg_core.testing.checks.repeats import side_effects
from moseg_core.testing.fixtures.trial import DRIVEN

#: What the last check looks at.
_AMBIENT = (
    *("the environment", "the filters of warnings", "numpy's handling of floating-point errors"),
    *("the locale", "the limit of recursion", "the mask of file modes", "the function that traces"),
    *("sys.stdin, sys.stdout and sys.stderr", "whether garbage is collected"),
)


@check("imports-quietly", kinds=ALL)
def _imports_quietly(subject: Subject) -> None:
    """What is printed breaks the output of every command, and what is changed stays changed."""
    spec, name = subject.component.spec, subject.component.bundle
    found = {f"'{spec.target.partition(':')[0]}'": target_import(subject)}
    if subject.component.distribution != NOT_INSTALLED:
        module = next(b.module for b in subject.registry.bundles if b.name == name)
        found[f"'{module}'"] = bundle_import(module)
    for imported, (said, changes) in found.items():
        if said or changes:
            raise ContractFailure(
                did=f"{imported} was imported",
                got=f"another state of {changes}" if changes else repr(said[:120]),
                expected="nothing printed, and nothing changed",
                fix="let modules define things and do nothing else; what must be set up belongs"
                " into the component, and is put back when the call is over",
            )


@check("working-directory-untouched", kinds=DRIVEN)
def _working_directory_untouched(subject: Subject) -> None:
    """Files that users name are looked for, and written, below the working directory."""
    _expect_untouched(
        subject,
        ["the working directory"],
        fix="open files by their full path; give programs their folder with cwd=",
    )


@check("signals-untouched", kinds=DRIVEN)
def _signals_untouched(subject: Subject) -> None:
    """The best found so far is kept at Ctrl-C as long as nobody else takes the signal."""
    _expect_untouched(
        subject,
        ["the handlers of signals"],
        fix="leave signals alone, or put signal.getsignal(...) back before the call ends",
    )


@check("no-threads-left", kinds=DRIVEN)
def _no_threads_left(subject: Subject) -> None:
    """The search copies its process, and a copy has the locks of threads, but not the threads."""
    _expect_untouched(
        subject,
        ["the threads that run"],
        fix="end threads before the call ends: with ThreadPoolExecutor() as pool: ...",
    )


@check("environment-untouched", kinds=DRIVEN)
def _environment_untouched(subject: Subject) -> None:
    """Variables, filters of warnings and numpy's error handling decide what others do and show."""
    _expect_untouched(
        subject,
        _AMBIENT,
        fix="change such things for the time of a call only: with np.errstate(...), with"
        " warnings.catch_warnings(), subprocess.run(..., env=...)",
    )


def _expect_untouched(subject: Subject, items: Collection[str], *, fix: str) -> None:
    found = {name: how for name, how in side_effects(subject).items() if name in items}
    if found:
        raise ContractFailure(
            did="it was run, and the process was looked at",
            got=f"a change of {told(found)}",
            expected="all as it was before",
            fix=fix,
        )
