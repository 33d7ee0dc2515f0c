"""Processes that hang, die and speak out of turn, and what is reported of them."""

from __future__ import annotations

import sys
from textwrap import dedent

import pytest

from moseg_core.errors import PluginError, UsageError
from moseg_core.testing.processes.watching_parent import watch_checks

# A child with five cases; what the second does is up to the test.
SCRIPT = """
import faulthandler, json, os, signal, sys, time
faulthandler.register(signal.SIGUSR1, all_threads=False)
bundle, _, pipe, _, numbers = sys.argv[1:]
pipe = os.fdopen(int(pipe), "w")
def write(**fields): print(json.dumps(fields), file=pipe, flush=True)
def endless():
    print("still here")
    while True: time.sleep(0.05)
def second():
    {second}
BEFORE
write(event="cases", distribution="acme 1.0", cases=[
    [f"{{bundle}}:one", "first"], [f"{{bundle}}:two", "first"], [f"{{bundle}}:two", "second"],
    [f"{{bundle}}:three", "first"], [f"{{bundle}}:three", "second"]])
for number in range(5):
    if str(number) in numbers.split(","): continue
    write(event="start", case=number)
    print("noise")
    if number == 1: second()
    write(event="outcome", case=number, status="passed", message="", fix="")
"""


def watched(second: str, *, before: str = "", timeout: float = 60.0, report=None):
    script = dedent(SCRIPT).format(second=second).replace("BEFORE", before)
    command = [sys.executable, "-c", script]
    return watch_checks("b", timeout=timeout, report=report, command=command)


def test_all_is_well():
    calls = []
    report = watched("pass", report=lambda *call: calls.append(call))
    assert report.passed
    assert calls[0] == (0, 5, "b:one first")
    assert calls[-1] == (4, 5, "b:three second")
    assert report.distribution == "acme 1.0"
    assert [outcome.component for outcome in report.outcomes] == [
        "b:one",
        "b:two",
        "b:two",
        "b:three",
        "b:three",
    ]


@pytest.mark.parametrize(
    ("second", "ending"),
    [
        ("os.kill(os.getpid(), signal.SIGSEGV)", "died of SIGSEGV: noise"),
        ("sys.exit('so long')", "ended with exit code 1: so long"),
        ("os._exit(0)", "ended by itself"),
    ],
)
def test_one_that_dies_is_named_and_the_rest_goes_on(second, ending):
    report = watched(second)
    assert not report.passed
    found = {(o.component, o.check): (o.status, o.message) for o in report.outcomes}
    assert found == {
        ("b:one", "first"): ("passed", ""),
        ("b:two", "first"): ("failed", f"its process {ending}"),
        ("b:two", "second"): ("skipped", f"not run, since the process of first {ending}"),
        ("b:three", "first"): ("passed", ""),
        ("b:three", "second"): ("passed", ""),
    }


def test_one_that_takes_forever_is_ended_and_says_where_it_was():
    report = watched("endless()", timeout=3.0)
    statuses = [outcome.status for outcome in report.outcomes]
    assert statuses == ["passed", "failed", "skipped", "passed", "passed"]
    ended = report.outcomes[1]
    assert ended.message.startswith("its process was ended after 3 s, in 'endless' (<string>, line")
    assert "--timeout" in ended.fix


def test_one_that_takes_forever_before_the_first_check():
    with pytest.raises(PluginError, match="bundle 'b' cannot be checked: its process was ended af"):
        watched("pass", before="endless()", timeout=2.0)


def test_one_that_dies_before_the_first_check():
    with pytest.raises(PluginError, match="its process ended with exit code 1: no such luck"):
        watched("pass", before="sys.exit('no such luck')")


@pytest.mark.parametrize(("code", "kind"), [(2, UsageError), (1, PluginError)])
def test_refusals_come_through(code, kind):
    before = f"write(event='refused', message='not this one', code={code}); sys.exit()"
    with pytest.raises(kind, match="not this one"):
        watched("pass", before=before)


@pytest.mark.parametrize("timeout", [0.0, -1.0, float("nan")])
def test_a_timeout_is_positive(timeout):
    with pytest.raises(UsageError, match="--timeout"):
        watch_checks("b", timeout=timeout)


def test_the_real_child_refuses_what_is_not_installed():
    with pytest.raises(UsageError, match="unknown bundle 'bsic'; did you mean 'basic'"):
        watch_checks("bsic")
