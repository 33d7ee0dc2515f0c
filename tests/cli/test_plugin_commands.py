"""``moseg plugin new``, ``check`` and ``explain``."""

from __future__ import annotations

import json

import pytest

from moseg_core.cli import plugin_check
from moseg_core.components.discovery.registry import registry
from moseg_core.testing import CHECKS, Check, Outcome
from moseg_core.testing.processes.watching_parent import BundleReport


def test_new_writes_a_bundle_and_says_what_is_next(moseg, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = moseg("plugin", "new", "steel_parts", "--kind", "seeder")
    assert run.code == 0, run.err
    assert (tmp_path / "moseg-steel-parts" / "src" / "moseg_steel_parts" / "scattered.py").exists()
    for line in ("  cd moseg-steel-parts", "  pytest", "  moseg plugin check steel_parts"):
        assert line in run.out.splitlines()
    again = moseg("plugin", "new", "steel_parts")
    assert again.code == 2
    assert "'moseg-steel-parts' is there already" in again.err


def test_new_elsewhere(moseg, tmp_path):
    assert moseg("plugin", "new", "a", "-o", tmp_path / "here").code == 0
    assert (tmp_path / "here" / "src" / "moseg_a" / "slender.py").exists()


@pytest.mark.parametrize(
    ("name", "owner"),
    [
        ("basic", "moseg-objectives-basic 0.1.0, which is installed"),
        ("core", "moseg-core 0.1.0, which is installed"),
        ("objectives_basic", "an installed package 'moseg_objectives_basic'"),
    ],
)
def test_new_refuses_names_in_use(moseg, tmp_path, name, owner):
    run = moseg("plugin", "new", name, "-o", tmp_path / "here")
    assert run.code == 2
    assert f"'{name}' is taken by {owner}" in run.err
    assert not (tmp_path / "here").exists()


def test_new_says_what_names_and_kinds_there_are(moseg, tmp_path):
    run = moseg("plugin", "new", "Steel-Parts", "-o", tmp_path / "here")
    assert run.code == 2
    assert "lower-case letters, digits and _" in run.err
    assert "did you mean 'steel_parts'" in run.err
    run = moseg("plugin", "new", "steel", "--kind", "objectiv", "-o", tmp_path / "here")
    assert run.code == 2
    assert "objective" in run.err


def test_explain_an_objective(moseg):
    run = moseg("plugin", "explain", "area_fraction")
    assert run.code == 0
    text = " ".join(run.out.split())
    for words in (
        "basic:area_fraction objective",
        "min = 0 number, 0 to 1 Bounds of the share",
        "range 0 to 1",
        "takes one label, or several to be summed",
        "needs nothing but the parts",
        "unchanged by order, reflection, rigid, scale, tessellation",
        "cost cheap",
        "from moseg-objectives-basic 0.1.0",
        "target moseg_objectives_basic.area:area_fraction",
        "max(min - share, share - max, 0)",
    ):
        assert words in text, words
    assert "`" not in run.out
    needs = " ".join(moseg("plugin", "explain", "basic:convex_parts").out.split())
    assert "needs volume" in needs
    assert "range 0 to infinity" in needs


def test_explain_begins_with_the_summary_and_says_nothing_twice(moseg):
    narrow = moseg("plugin", "explain", "narrow").out
    assert narrow.splitlines()[1].strip() == "one part: long and thin"
    assert "(s2 + s3) / (2 s1)" in narrow  # what the docstring begins with comes next
    assert moseg("plugin", "explain", "core:seg").out.lower().count("one label number a line") == 1


def test_explain_other_kinds(moseg):
    seeder = " ".join(moseg("plugin", "explain", "kmeans").out.split())
    assert "rounds = 100 whole number, 1 or more Most rounds to run." in seeder
    assert "Algorithm 2" in seeder  # where it comes from, in the words of its module
    assert "moseg recipes basic:hammer" in moseg("plugin", "explain", "hammer").out
    assert ".off" in moseg("plugin", "explain", "core:off").out
    assert "moseg embed --help" in moseg("plugin", "explain", "embed").out
    # One name for two kinds of the same bundle: both.
    both = json.loads(moseg("plugin", "explain", "core:ply", "--json").out)
    assert [told["kind"] for told in both] == ["reader", "writer"]


def test_explain_as_json(moseg):
    (told,) = json.loads(moseg("plugin", "explain", "rotational_symmetric", "--json").out)
    assert told["id"] == "basic:rotational_symmetric"
    assert told["distribution"] == "moseg-objectives-basic 0.1.0"
    assert told["traits"]["range"] == [0, 1]
    assert told["traits"]["requires"] == ["surface"]
    (parameter,) = told["parameters"]
    assert (parameter["name"], parameter["default"]) == ("n", 2)
    assert (parameter["low"], parameter["high"]) == (2, None)


def test_explain_everything_that_is_installed(moseg):
    for component in registry().components():
        told = json.loads(moseg("plugin", "explain", component.id, "--json").out)
        assert component.kind in [entry["kind"] for entry in told]
        assert all(entry["headline"] for entry in told)
        for parameter in [p for entry in told for p in entry["parameters"]]:
            assert parameter["says"], f"'{parameter['name']}' of {component.id} is not documented"


def test_explain_says_what_is_near(moseg):
    run = moseg("plugin", "explain", "narow")
    assert run.code == 2
    assert "did you mean 'narrow'" in run.err
    assert "did you mean 'core:kmeans'" in moseg("plugin", "explain", "core:kmean").err


@pytest.fixture
def outcomes(monkeypatch):
    """A report of five outcomes, under checks that are there for the test only."""
    for name in ("test-a", "test-b"):
        made = Check(id=name, kinds=("seeder",), since=1, why=f"Why {name}.", run=lambda _: None)
        monkeypatch.setitem(CHECKS, name, made)
    found = [
        Outcome(component="acme:one", check="test-a", status="passed"),
        Outcome(component="acme:one", check="test-b", status="failed", message="bad", fix="mend"),
        Outcome(component="acme:two", check="test-a", status="skipped", message="no volume"),
        Outcome(component="acme:two", check="test-b", status="passed"),
    ]

    def use(count: int) -> None:
        outcomes = tuple(found[:count])
        report = BundleReport(bundle="acme", distribution="moseg-acme 1.4", outcomes=outcomes)
        monkeypatch.setattr(plugin_check, "watch_checks", lambda bundle, **_: report)

    return use


def test_check_shows_failures_first_and_ends_with_1(moseg, outcomes):
    outcomes(4)
    run = moseg("plugin", "check", "acme")
    assert run.code == 1
    assert run.err == (
        "moseg: bundle 'acme' of moseg-acme 1.4 does not pass the contract checks: 1 check failed\n"
    )
    text = " ".join(run.out.split())
    assert text == (
        "failed check test-b on acme:one what bad why Why test-b. fix mend"
        " skipped acme:two test-a no volume"
        " passed acme:one 1 check acme:two 1 check"
        " acme (moseg-acme 1.4): 4 checks on 2 components: 2 passed, 1 failed, 1 skipped"
    )


def test_check_as_json(moseg, outcomes):
    outcomes(4)
    run = moseg("plugin", "check", "acme", "--json")
    assert run.code == 1
    told = json.loads(run.out)
    assert not told["passed"]
    assert told["counts"] == {"passed": 2, "failed": 1, "skipped": 1}
    assert told["outcomes"][1] == {
        "component": "acme:one",
        "check": "test-b",
        "status": "failed",
        "message": "bad",
        "why": "Why test-b.",
        "fix": "mend",
    }


def test_check_ends_with_0_where_all_is_well(moseg, outcomes):
    outcomes(1)
    run = moseg("plugin", "check", "acme")
    assert (run.code, run.err) == (0, "")
    assert "1 check on 1 component: 1 passed" in run.out


def test_check_of_something_that_is_not_there(moseg):
    run = moseg("plugin", "check", "bsic")
    assert run.code == 2
    assert "did you mean 'basic'" in run.err
