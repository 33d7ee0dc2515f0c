"""Discovery: real distributions in a folder, whole and broken, and what can be asked of them."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib import metadata

import pytest

from moseg_core.components.discovery.registry import (
    discover,
    registry,
)
from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.errors import PluginError, UsageError
from tests.components.discovery.conftest import GOOD


def core_entry_point() -> metadata.EntryPoint:
    (point,) = [p for p in metadata.distribution("moseg-core").entry_points if p.group == "moseg"]
    return point


def test_a_distribution_in_order(good):
    found = good.discover()
    (bundle,) = found.bundles
    assert (bundle.name, bundle.distribution, bundle.version, bundle.module, bundle.problem) == (
        "good",
        "Good-Parts",
        "1.2.3",
        "good_bundle",
        None,
    )
    assert [(c.kind, c.id, c.distribution) for c in bundle.components] == [
        ("objective", "good:slim", "Good-Parts 1.2.3"),
        ("objective", "good:wide", "Good-Parts 1.2.3"),
        ("measure", "good:girth", "Good-Parts 1.2.3"),
    ]
    assert bundle.components[0].spec == ObjectiveSpec(
        name="slim", target="good_parts:slim", summary="long and thin"
    )
    assert found.names("objective") == ["slim", "wide"]
    assert found.components("measure") == [bundle.components[2]]
    assert found.components() == list(bundle.components)
    assert "good_parts" not in sys.modules


def test_bundles_are_in_order_of_their_names_after_the_core(site):
    for name in ("zebra", "ant", "mole"):
        source = GOOD.replace("good_parts", f"{name}_parts")
        site.add(name, bundles={name: f"{name}_bundle"}, **{f"{name}_bundle": source})
    found = discover([*site.entry_points(), core_entry_point()])
    assert [bundle.name for bundle in found.bundles] == ["core", "ant", "mole", "zebra"]
    assert all(bundle.problem is None for bundle in found.bundles)


def test_one_distribution_can_bring_several_bundles(site):
    other = GOOD.replace("slim", "slender")
    site.add("twins", bundles={"a": "a_bundle", "b": "b_bundle"}, a_bundle=GOOD, b_bundle=other)
    found = site.discover()
    assert [(b.name, b.distribution, b.problem) for b in found.bundles] == [
        ("a", "twins", None),
        ("b", "twins", None),
    ]
    assert found.names("objective") == ["a:wide", "b:wide", "slender", "slim"]


def test_an_entry_point_without_a_distribution(good):
    point = metadata.EntryPoint("good", "good_bundle", "moseg")
    (bundle,) = discover([point]).bundles
    assert bundle.problem is None
    assert bundle.distribution == "an unnamed distribution"


def test_an_unnamed_distribution_is_not_advised_to_be_reinstalled_by_half_its_name(good):
    found = discover([metadata.EntryPoint("good", "good_bundle", "moseg")])
    with pytest.raises(PluginError) as caught:
        found.find("objective", "slim").load()
    assert not str(caught.value).endswith("reinstall an")


def test_hooks_can_have_another_name_and_be_on_an_object(site):
    site.add(
        "objects",
        bundles={"things": "object_bundle:Bundle"},
        object_bundle="""
            from moseg_core import ObjectiveSpec, hookimpl

            class Bundle:
                @staticmethod
                @hookimpl(specname="moseg_objectives")
                def whatever():
                    yield ObjectiveSpec(name="slim", target="a:b")
        """,
    )
    assert site.discover().find("objective", "slim").id == "things:slim"


# --- what is set aside

HEAD = "from moseg_core import ObjectiveSpec, SeederSpec, hookimpl\n"
HOOK = f"{HEAD}@hookimpl\ndef moseg_objectives():\n    "
SPEC = "ObjectiveSpec(name='x', target='a:b')"

BROKEN = {
    "import error": ("import no_such_library", "ModuleNotFoundError: No module named 'no_such_lib"),
    "own error": ("raise RuntimeError('first\\n  second')", "RuntimeError: first second"),
    "silent error": ("raise RuntimeError", "importing 'bad_bundle' failed with RuntimeError; "),
    "syntax": ("def :", "SyntaxError"),
    "exit": ("import sys; sys.exit('no licence')", "SystemExit: no licence"),
    "recursion": ("def f(): f()\nf()", "RecursionError"),
    "misspelled hook": (
        f"{HEAD}@hookimpl\ndef moseg_objective(): return [{SPEC}]",
        "'moseg_objective' is marked as a hook, but there is no such hook (did you mean"
        " 'moseg_objectives'?)",
    ),
    "misspelled name of a hook": (
        f"{HEAD}@hookimpl(specname='moseg_seders')\ndef f(): return []",
        "'f' is marked as a hook, but there is no such hook (did you mean 'moseg_seeders'?)",
    ),
    "hook of no such kind": (
        f"{HEAD}@hookimpl\ndef zzz(): return []",
        "'zzz' is marked as a hook, but there is no such hook (known: moseg_objectives, moseg_meas",
    ),
    "a good hook beside a misspelled one": (
        f"{HOOK}return [{SPEC}]\n@hookimpl\ndef moseg_seeder(): return []",
        "did you mean 'moseg_seeders'?",
    ),
    "hook with arguments": (f"{HEAD}@hookimpl\ndef moseg_objectives(config): ...", "config"),
    "hook raises": (f"{HOOK}return 1 / 0", "hook 'moseg_objectives' failed with ZeroDivisionError"),
    "hook raises late": (f"{HOOK}yield {SPEC}\n    1 / 0", "failed with ZeroDivisionError"),
    "hook exits": (f"{HOOK}raise SystemExit(3)", "hook 'moseg_objectives' failed with SystemExit"),
    "hook returns None": (f"{HOOK}pass", "hook 'moseg_objectives' failed with TypeError"),
    "hook returns one spec": (f"{HOOK}return {SPEC}", "failed with TypeError"),
    "hook returns names": (f"{HOOK}return ['narrow']", "returned 'narrow', not a"),
    "hook returns a class": (f"{HOOK}return [ObjectiveSpec]", "not a"),
    "hook returns another kind": (
        f"{HOOK}return [SeederSpec(name='x', target='a:b')]",
        "hook 'moseg_objectives' returned SeederSpec(",
    ),
    "malformed name": (
        f"{HOOK}return [ObjectiveSpec(name='My-Name', target='a:b')]",
        "failed with ValueError: objective name 'My-Name' is not made of lower-case letters",
    ),
    "malformed target": (
        f"{HOOK}return [ObjectiveSpec(name='x', target='a')]",
        "failed with ValueError: target 'a' of objective 'x' is not of the form",
    ),
    "twice": (f"{HOOK}return [{SPEC}, {SPEC}]", "it offers the objective 'bad:x' twice"),
    "no hooks": ("x = 1", "it offers no components"),
    "empty hooks": (f"{HOOK}return []", "it offers no components"),
    # Modules that are in order, but hold something that must not be touched.
    "proxy": (
        f"{HOOK}return 1 / 0\nclass Proxy:\n    def __getattr__(self, name):\n"
        "        raise RuntimeError('no request')\nproxy = Proxy()",
        "",
    ),
    "lazy name": (f"{HOOK}return 1 / 0\ndef __dir__(): return ['moseg_objectives', 'gone']", ""),
    "mock": (f"{HOOK}return 1 / 0\nfrom unittest.mock import call", ""),
}


@pytest.mark.parametrize("case", BROKEN)
def test_what_fails_is_set_aside_with_the_reason_and_the_rest_goes_on(good, case):
    source, reason = BROKEN[case]
    good.add("Bad-Parts", "0.9", bundles={"bad": "bad_bundle"}, bad_bundle=source)
    found = good.discover()
    bad, whole = found.bundles
    assert (whole.name, whole.problem, len(whole.components)) == ("good", None, 3)
    assert (bad.name, bad.distribution, bad.version, bad.components) == (
        "bad",
        "Bad-Parts",
        "0.9",
        (),
    )
    assert bad.problem is not None
    assert bad.problem.startswith("Bad-Parts 0.9: ")
    assert reason in bad.problem
    assert "\n" not in bad.problem
    assert "; " in bad.problem  # and what to do
    assert found.names("objective") == ["slim", "wide"]


HARMLESS = {
    "proxy": "class P:\n    def __getattr__(self, n): raise RuntimeError\np = P()",
    "mock": "from unittest.mock import call",
    "any attribute": "class A:\n    def __getattr__(self, n): return {'specname': 'x'}\na = A()",
}


@pytest.mark.parametrize("case", HARMLESS)
def test_what_else_a_module_holds_does_not_matter(site, case):
    source = f"{HOOK}return [{SPEC}]\n{HARMLESS[case]}"
    site.add("odd", bundles={"odd": "odd_bundle"}, odd_bundle=source)
    (bundle,) = site.discover().bundles
    assert bundle.problem is None
    assert [c.id for c in bundle.components] == ["odd:x"]


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ("no_such_module", "ModuleNotFoundError"),
        ("good_bundle:gone", "AttributeError"),
        ("good_bundle.gone", "ModuleNotFoundError"),
    ],
)
def test_an_entry_point_that_leads_nowhere(good, value, reason):
    good.add("lost", "2.0", bundles={"lost": value})
    lost = good.discover().bundles[1]
    assert lost.name == "lost"
    assert lost.problem.startswith(f"lost 2.0: importing '{value}' failed with {reason}")
    assert lost.problem.endswith("; update or reinstall lost, or uninstall it")


@pytest.mark.parametrize("name", ["Good", "2d", "my-parts", "my.parts", "_x", "tête"])
def test_a_namespace_that_cannot_be_written_in_an_expression(site, name):
    site.add("odd-name", "1.0", bundles={name: "odd_bundle"}, odd_bundle=GOOD)
    (bundle,) = site.discover().bundles
    assert f"odd-name 1.0: '{name}' is not a valid namespace; " in bundle.problem
    assert "odd_bundle" not in sys.modules


def test_two_distributions_with_one_namespace_are_both_set_aside_and_named(good):
    good.add("Rival", "7", bundles={"good": "rival_bundle"}, rival_bundle=GOOD)
    good.add("third", bundles={"other": "third_bundle"}, third_bundle=GOOD)
    *rivals, other = good.discover().bundles
    assert other.problem is None
    assert {(b.name, b.distribution) for b in rivals} == {("good", "Good-Parts"), ("good", "Rival")}
    for bundle in rivals:
        assert bundle.components == ()
        assert "the namespace 'good' is claimed by Good-Parts 1.2.3 and Rival 7; " in bundle.problem
        assert bundle.problem.endswith("; uninstall one of them")
    assert not {"good_bundle", "rival_bundle"} & set(sys.modules)


def test_nobody_can_take_the_namespace_of_the_core(site):
    site.add("usurper", "6.6", bundles={"core": "usurper_bundle"}, usurper_bundle=GOOD)
    found = discover([*site.entry_points(), core_entry_point()])
    assert found.find("seeder", "kmeans").distribution.startswith("moseg-core ")
    aside = [bundle for bundle in found.bundles if bundle.problem]
    assert [bundle.distribution for bundle in aside] == ["usurper"]


def test_one_module_is_one_bundle(good):
    good.add("again", bundles={"again": "good_bundle"})
    first, second = good.discover().bundles
    assert (first.name, first.problem) == ("again", None)
    assert "registering it failed with ValueError" in second.problem


PRESSED = "import signal\nsignal.raise_signal(signal.SIGINT)"


def test_an_interruption_is_not_taken_for_a_failure(site):
    site.add("slow", bundles={"slow": "slow_bundle"}, slow_bundle=PRESSED)
    with pytest.raises(KeyboardInterrupt):
        site.discover()


# --- strictness


def test_without_plugins_there_is_the_core(good, no_registry_yet, monkeypatch):
    monkeypatch.setenv("MOSEG_NO_PLUGINS", "1")
    monkeypatch.setenv("MOSEG_PLUGINS", "good")
    assert [bundle.name for bundle in registry().bundles] == ["core"]
    with pytest.raises(UsageError, match=r"left out by --no-plugins, or MOSEG_NO_PLUGINS=1\)$"):
        registry().find("objective", "narrow")
    registry.cache_clear()
    monkeypatch.setenv("MOSEG_NO_PLUGINS", "yes")
    with pytest.raises(UsageError, match="MOSEG_NO_PLUGINS must be 1 or 0, not 'yes'"):
        registry()


def test_strictly_what_is_set_aside_is_an_error(good, no_registry_yet, monkeypatch):
    monkeypatch.setenv("MOSEG_STRICT", "1")
    assert registry().find("objective", "good:slim")
    registry.cache_clear()
    good.add("Bad-Parts", "0.9", bundles={"bad": "bad_bundle"}, bad_bundle="import no_such_library")
    with pytest.raises(PluginError, match=r"a bundle is set aside.*'bad': Bad-Parts 0\.9: import"):
        registry()
    monkeypatch.setenv("MOSEG_PLUGINS", "good")
    assert registry().find("objective", "good:slim")
    registry.cache_clear()
    monkeypatch.delenv("MOSEG_PLUGINS")
    monkeypatch.setenv("MOSEG_STRICT", "0")
    assert registry().find("objective", "good:slim")


def test_strictness_is_one_or_nothing(no_registry_yet, monkeypatch):
    monkeypatch.setenv("MOSEG_STRICT", "yes")
    with pytest.raises(UsageError, match="MOSEG_STRICT must be 1 or 0, not 'yes'"):
        registry()


# --- restriction


def test_a_restricted_bundle_is_not_even_imported(good):
    good.add("Bad-Parts", bundles={"bad": "bad_bundle"}, bad_bundle="import no_such_library")
    assert [b.name for b in good.discover(restrict_to={"good"}).bundles] == ["good"]
    assert good.discover(restrict_to=set()).bundles == ()
    good.add("quiet", bundles={"quiet": "quiet_bundle"}, quiet_bundle=GOOD)
    good.discover(restrict_to={"good", "core"})
    assert "quiet_bundle" not in sys.modules


@pytest.fixture
def no_registry_yet() -> Iterator[None]:
    """Have the registry of the process found anew, in the test and after it."""
    registry.cache_clear()
    yield
    registry.cache_clear()


@pytest.mark.parametrize(
    ("variable", "expected"),
    [
        ("", {"core"}),
        ("core", {"core"}),
        ("good", {"core", "good"}),
        (" good , basic ", {"core", "basic", "good"}),
        ("good,,", {"core", "good"}),
    ],
)
def test_the_environment_says_which_bundles_to_load(
    good, no_registry_yet, monkeypatch, variable, expected
):
    good.add("bad", bundles={"bad": "bad_bundle"}, bad_bundle="import no_such_library")
    monkeypatch.setenv("MOSEG_PLUGINS", variable)
    assert {bundle.name for bundle in registry().bundles} == expected
    assert ("good_bundle" in sys.modules) == ("good" in expected)


def test_the_environment_names_only_what_is_installed(good, no_registry_yet, monkeypatch):
    monkeypatch.setenv("MOSEG_PLUGINS", "core,goood")
    with pytest.raises(UsageError, match="MOSEG_PLUGINS: unknown bundle 'goood'; did you mean"):
        registry()


def test_without_it_everything_is_loaded(good, no_registry_yet, monkeypatch):
    good.add("bad", bundles={"bad": "bad_bundle"}, bad_bundle="import no_such_library")
    monkeypatch.delenv("MOSEG_PLUGINS", raising=False)
    names = [bundle.name for bundle in registry().bundles]
    assert names[0] == "core"
    assert {"core", "basic", "good", "bad"} <= set(names)
    assert registry() is registry()
