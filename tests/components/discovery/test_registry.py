"""Looking up components among those discovered, and loading them."""

from __future__ import annotations

import sys
import types

import pytest

from moseg_core.components.discovery.registry import (
    Bundle,
    Component,
    Registry,
    registry,
)
from moseg_core.components.discovery.specs import MeasureSpec, ObjectiveSpec, ReaderSpec, WriterSpec
from moseg_core.errors import PluginError, UsageError


def bundle(name: str, *specs, problem: str | None = None) -> Bundle:
    distribution = f"moseg-{name}"
    components = tuple(Component(name, f"{distribution} 1.0", spec) for spec in specs)
    return Bundle(name, distribution, "1.0", name, components, problem)


def objectives(*names: str) -> list[ObjectiveSpec]:
    return [ObjectiveSpec(name=name, target="home:thing") for name in names]


TWO = Registry(
    (
        bundle(
            "basic", *objectives("slim", "narrow"), MeasureSpec(name="slim", target="home:thing")
        ),
        bundle("other", *objectives("slim", "wide")),
        bundle("broken", problem="moseg-broken 1.0: importing it failed; reinstall it"),
    )
)


@pytest.mark.parametrize(
    ("kind", "name", "found"),
    [
        ("objective", "narrow", "basic:narrow"),
        ("objective", "basic:narrow", "basic:narrow"),
        ("objective", "basic:slim", "basic:slim"),
        ("objective", "other:slim", "other:slim"),
        ("objective", "wide", "other:wide"),
        ("measure", "slim", "basic:slim"),
    ],
)
def test_components_are_found_by_id_or_by_a_name_that_is_unique(kind, name, found):
    component = TWO.find(kind, name)
    assert (component.kind, component.id) == (kind, found)


def test_names_are_the_shortest_that_are_unique():
    assert TWO.names("objective") == ["basic:slim", "narrow", "other:slim", "wide"]
    assert TWO.names("measure") == ["slim"]
    assert TWO.names("seeder") == []
    for kind in ("objective", "measure"):
        assert len({TWO.find(kind, name).id for name in TWO.names(kind)}) == len(TWO.names(kind))


def crowd(site, **requires: list[str]) -> Registry:
    """Distributions that each have an objective ``slim`` in a bundle of the distribution's name."""
    for name, needed in requires.items():
        site.add(
            f"Moseg_{name}",
            bundles={name: f"{name}_bundle"},
            requires=needed,
            **{
                f"{name}_bundle": """
                    from moseg_core import ObjectiveSpec, hookimpl

                    @hookimpl
                    def moseg_objectives():
                        return [ObjectiveSpec(name="slim", target="home:thing")]
                """
            },
        )
    return site.discover()


def test_a_bundle_means_its_own_component_by_a_name_that_several_have(site):
    found = crowd(site, one=[], two=["moseg-one"])
    for scope in ("one", "two"):
        assert found.find("objective", "slim", scope=scope).id == f"{scope}:slim"
        assert found.in_full("objective", "slim", scope) == f"{scope}:slim"
    assert found.find("objective", "one:slim", scope="two").id == "one:slim"


@pytest.mark.parametrize("requirement", ["moseg-two", "MOSEG.two>=1.0,<2", "moseg-between"])
def test_a_bundle_means_a_component_that_its_distribution_requires(site, requirement):
    site.add("moseg-between", bundles={}, requires=["moseg_two==1.0"])
    site.add(
        "mine",
        bundles={"mine": "mine_bundle"},
        requires=["no-such-distribution", requirement],
        mine_bundle="""
            from moseg_core import RecipeSpec, hookimpl

            @hookimpl
            def moseg_recipes():
                return [RecipeSpec(name="chair", target="home:thing")]
        """,
    )
    found = crowd(site, one=["mine"], two=[])
    assert found.find("objective", "slim", scope="mine").id == "two:slim"
    for scope in (None, "nobody"):
        with pytest.raises(UsageError, match="ambiguous; say which: one:slim, two:slim"):
            found.find("objective", "slim", scope=scope)


def test_what_a_bundle_requires_may_be_ambiguous_too(site):
    found = crowd(site, one=[], two=[], three=[])
    site.add("mine", bundles={}, requires=["moseg-one", "moseg-two", "moseg-three; extra == 'x'"])
    mine = Registry([*found.bundles, Bundle("mine", "mine", "1.0", "mine")])
    with pytest.raises(UsageError, match=r"say which: one:slim, two:slim$"):
        mine.find("objective", "slim", scope="mine")


def test_a_name_that_one_has_is_found_whoever_asks(site):
    found = crowd(site, one=[])
    lonely = Registry([*found.bundles, Bundle("mine", "mine", "1.0", "mine")])
    assert lonely.find("objective", "slim", scope="mine").id == "one:slim"
    assert lonely.in_full("objective", "slim", "mine") == "slim"
    assert lonely.in_full("objective", "unknown", "mine") == "unknown"


def test_every_bundle_was_written_with_the_core(install_stranger):
    found = install_stranger()
    lonely = Registry([*found.bundles, Bundle("mine", "mine", "1.0", "mine")])
    assert lonely.find("seeder", "kmeans", scope="mine").id == "core:kmeans"
    assert lonely.in_full("seeder", "kmeans", "mine") == "core:kmeans"


ASIDE = " (set aside, see 'moseg plugin list': broken)"


@pytest.mark.parametrize(
    ("kind", "name", "message"),
    [
        (
            "objective",
            "slim",
            "objective 'slim' is ambiguous; say which: basic:slim, other:slim",
        ),
        ("objective", "narow", f"unknown objective 'narow'; did you mean 'narrow'?{ASIDE}"),
        (
            "objective",
            "xyz",
            f"unknown objective 'xyz'; known: basic:slim, narrow, other:slim, wide{ASIDE}",
        ),
        (
            "objective",
            "basic:narow",
            f"unknown objective 'basic:narow'; did you mean 'basic:narrow'?{ASIDE}",
        ),
        (
            "objective",
            "gone:x",
            "unknown objective 'gone:x'; known: basic:narrow, basic:slim, other:slim, other:wide"
            + ASIDE,
        ),
        ("seeder", "narrow", f"unknown seeder 'narrow'; known: none{ASIDE}"),
        ("objective", "", "unknown objective ''; known: "),
        ("objective", "basic:", "unknown objective 'basic:'; "),
    ],
)
def test_names_that_are_not_found(kind, name, message):
    with pytest.raises(UsageError) as caught:
        TWO.find(kind, name)
    assert str(caught.value).startswith(message)


def test_without_bundles_set_aside_none_are_mentioned():
    with pytest.raises(UsageError, match=r"^unknown objective 'x'; known: none$"):
        Registry(()).find("objective", "x")


@pytest.mark.parametrize("kind", ["objective", "measure", "recipe"])
def test_an_id_of_a_bundle_that_is_set_aside_gives_the_reason(kind):
    with pytest.raises(PluginError) as caught:
        TWO.find(kind, "broken:anything")
    assert str(caught.value) == (
        f"{kind} 'broken:anything' is not available: bundle 'broken' is set aside:"
        " moseg-broken 1.0: importing it failed; reinstall it"
    )
    assert caught.value.exit_code == 1


def test_suffixes():
    def reader(name, *suffixes):
        return ReaderSpec(name=name, target="a:b", suffixes=suffixes)

    writer = WriterSpec(name="pts", target="a:b", suffixes=(".pts",))
    found = Registry(
        (
            bundle("core", reader("off", ".off"), reader("ply", ".ply")),
            bundle("other", reader("off", ".off", ".noff"), writer, *objectives("x")),
        )
    )
    assert found.by_suffix("reader", ".off").id == "core:off"
    assert found.by_suffix("reader", ".OFF").id == "core:off"
    assert found.by_suffix("reader", ".NOff").id == "other:off"
    assert found.by_suffix("reader", ".v2.off").id == "core:off"
    assert found.by_suffix("writer", ".pts").id == "other:pts"
    for kind, suffix, message in [
        ("reader", ".pts", "cannot read files '.pts'; formats: .noff, .off, .ply"),
        ("reader", ".Off2", "cannot read files '.Off2'; formats: .noff, .off, .ply"),
        ("reader", "", "cannot read files without a suffix; formats: .noff, .off, .ply"),
        ("writer", ".off", "cannot write files '.off'; formats: .pts"),
    ]:
        with pytest.raises(UsageError) as caught:
            found.by_suffix(kind, suffix)
        assert str(caught.value) == message


def test_an_unknown_suffix_mentions_what_is_set_aside():
    with pytest.raises(UsageError, match=r"cannot read files '\.step'.*set aside.*: broken\)$"):
        TWO.by_suffix("reader", ".step")


# --- loading


@pytest.fixture
def home(monkeypatch) -> types.ModuleType:
    """The module that the targets above are in."""
    module = types.ModuleType("home")
    monkeypatch.setitem(sys.modules, "home", module)
    return module


def test_a_component_is_what_its_target_names(home):
    home.thing = object()
    assert TWO.find("objective", "narrow").load() is home.thing


@pytest.fixture
def good(site):
    """A site with one distribution, whose components are yet to be written."""
    bundle = """
        from moseg_core import MeasureSpec, ObjectiveSpec, hookimpl

        @hookimpl
        def moseg_objectives():
            return [ObjectiveSpec(name="slim", target="good_parts:slim")]

        @hookimpl
        def moseg_measures():
            return [MeasureSpec(name="girth", target="good_parts:girth", keep=False)]
    """
    site.add("Good-Parts", "1.2.3", bundles={"good": "good_bundle"}, good_bundle=bundle)
    return site


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("import no_such_library", "ModuleNotFoundError: No module named 'no_such_library'"),
        ("raise SystemExit('no licence')", "SystemExit: no licence"),
        ("raise ValueError('first\\nsecond')", "ValueError: first second"),
        ("slim = ", "SyntaxError"),
        ("other = 1", "AttributeError: module 'good_parts' has no attribute 'slim'"),
    ],
)
def test_a_component_that_cannot_be_loaded_names_its_distribution(good, source, reason):
    (good.folder / "good_parts.py").write_text(source)
    component = good.discover().find("objective", "slim")
    with pytest.raises(PluginError) as caught:
        component.load()
    message = str(caught.value)
    assert message.startswith(
        "objective 'good:slim' of Good-Parts 1.2.3 cannot be loaded from 'good_parts:slim': "
    )
    assert reason in message
    assert "; update or reinstall " in message
    assert "\n" not in message


def test_the_core_is_a_bundle_like_others_and_all_its_components_load():
    core = registry().bundles[0]
    assert (core.name, core.distribution, core.problem) == ("core", "moseg-core", None)
    assert {component.kind for component in core.components} >= {
        "parameterization",
        "seeder",
        "labeler",
        "optimizer",
        "reader",
        "writer",
    }


@pytest.mark.parametrize("component", registry().components(), ids=lambda c: f"{c.kind} {c.id}")
def test_every_installed_component_loads(component):
    assert component.load() is not None


def test_of_several_suffixes_the_longest_that_is_known_counts():
    def reader(name, suffix):
        return ReaderSpec(name=name, target="a:b", suffixes=(suffix,))

    found = Registry((bundle("core", reader("gz", ".gz"), reader("nifti", ".nii.gz")),))
    assert found.by_suffix("reader", ".nii.gz").id == "core:nifti"
    assert found.by_suffix("reader", ".v2.NII.gz").id == "core:nifti"
    assert found.by_suffix("reader", ".off.gz").id == "core:gz"
    assert list(found.suffixes("reader")) == [".gz", ".nii.gz"]
