"""No hostile file hangs moseg, breaks it, or is believed.

``make fuzz`` reads them all and prints the table of the page "What moseg promises"; the suite
reads a sample. ``python -m tests.fuzz`` is for whoever mends something.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.case import Case, constant
from tests.fuzz.children import Outcome, run
from tests.fuzz.command_line import sample
from tests.fuzz.everything import all_cases
from tests.fuzz.page import PAGE, counted, page_with
from tests.fuzz.statements import box_file
from tests.fuzz.table import by, counts, fallen_short, text
from tests.fuzz.verdict import (
    CRASH,
    HANG,
    INTERNAL,
    MEMORY,
    NONSENSE,
    REFUSAL,
    RESULT,
    WRONGLY_REFUSED,
)

_SLOW_KINDS = {"large", "expansion", "many corners"}


def told(outcomes: list[Outcome]) -> str:
    return "\n".join(
        f"{o.case.key} | {o.verdict.outcome} | {o.verdict.said}" for o in fallen_short(outcomes)
    )


def test_a_sample_is_refused_in_a_line_or_sound():
    quick = [case for case in all_cases() if case.kind not in _SLOW_KINDS]
    assert told(run(sample(quick, 200), children=1)) == ""


@pytest.mark.fuzz
def test_every_file_is_refused_in_a_line_or_sound():
    outcomes = run(all_cases())
    for key in ("format", "kind"):
        print(f"\n{text(by(outcomes, key), key)}")
    assert told(outcomes) == ""
    assert page_with(outcomes) == PAGE.read_text(encoding="utf-8"), "run 'make fuzz-page'"


@pytest.mark.fuzz
def test_the_command_line_says_what_is_wrong_in_a_line():
    outcomes = run(sample(all_cases(), 600), by_command=True)
    print(f"\nthrough the command line\n{text(by(outcomes, 'format'), 'format')}")
    assert told(outcomes) == ""


def test_there_are_many_of_each_and_the_page_has_their_number():
    cases = all_cases()
    assert len(cases) >= 1800
    assert min(counts(cases, "format").values()) >= 40
    for key in ("format", "kind"):
        assert counted(key) == counts(cases, key), "run 'make fuzz-page'"


def test_a_case_is_the_same_bytes_each_time():
    for case in sample(all_cases(), 60):
        assert case.files() == case.files(), case.key


# --- what would be found is found


def _case(data: bytes, **known) -> Case:
    return Case(
        format="off", kind="k", name=str(known), suffix=".off", make=constant(data), **known
    )


def test_nonsense_and_wrong_refusals_are_found():
    box = next(iter(box_file().values()))
    cases = [
        _case(box, expected="sound", elements=(44, 44), area=22.0),
        _case(box, expected="refused"),
        _case(box, elements=(1, 43)),
        _case(box, area=21.0),
        _case(b"OFF\n", expected="sound"),
        _case(b"OFF\n", expected="refused"),
    ]
    found = [outcome.verdict.outcome for outcome in run(cases, children=1)]
    assert found == [RESULT, NONSENSE, NONSENSE, NONSENSE, WRONGLY_REFUSED, REFUSAL]


def test_hangs_crashes_and_errors_are_found():
    tasks = {"hang": HANG, "crash": CRASH, "error": INTERNAL, "exhaust": MEMORY}
    found = run([_case(b"", task=task) for task in tasks], children=1, seconds=0.5)
    assert [outcome.verdict.outcome for outcome in found] == list(tasks.values())


def test_a_sample_has_every_format_and_kind():
    cases = all_cases()
    pairs = {(case.format, case.kind) for case in cases}
    assert {(case.format, case.kind) for case in sample(cases, len(pairs))} == pairs


def test_files_are_within_their_folder():
    for case in all_cases():
        if case.kind == "references" and case.format in ("gltf", "recipe"):
            assert not any(".." in Path(name).parts for name in case.files())
