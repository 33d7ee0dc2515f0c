"""Which distributions are installed and what they require; of copies, which one counts."""

from __future__ import annotations

import json
import sys
from textwrap import dedent

from moseg_core.components.discovery.distributions import normal_name, required_distributions
from moseg_core.components.discovery.registry import (
    discover,
)
from tests.components.discovery.conftest import GOOD
from tests.conftest import Site


def test_of_two_copies_the_one_that_python_imports_is_used_and_said_so(good, monkeypatch):
    ahead = Site(good.folder / "ahead")
    ahead.folder.mkdir()
    source = GOOD.replace("slim", "slender")
    ahead.add("good_parts", "2.0", bundles={"good": "good_bundle"}, good_bundle=source)
    points = [*good.entry_points(), *ahead.entry_points()]
    (bundle,) = discover(points).bundles
    assert (bundle.problem, bundle.version) == (None, "1.2.3")
    assert bundle.note == (
        f"Good-Parts is installed 2 times, 1.2.3 in {good.folder} and 2.0 in {ahead.folder}; Python"
        f" imports 1.2.3 in {good.folder}, so that one is used; uninstall the rest"
    )
    del sys.modules["good_bundle"]
    monkeypatch.syspath_prepend(str(ahead.folder))
    (bundle,) = discover(points).bundles
    assert (bundle.problem, bundle.version) == (None, "2.0")
    assert bundle.components[0].id == "good:slender"
    assert f"Python imports 2.0 in {ahead.folder}" in bundle.note


def test_an_editable_copy_is_at_home_in_its_project(site, monkeypatch):
    wheel = Site(site.folder / "wheel")
    wheel.folder.mkdir()
    project = site.folder / "project"
    (project / "src").mkdir(parents=True)
    (project / "src" / "good_bundle.py").write_text(dedent(GOOD))
    site.add("good-parts", "1.0", bundles={"good": "good_bundle"})
    (info,) = site.folder.glob("*.dist-info")
    direct = {"url": project.as_uri(), "dir_info": {"editable": True}}
    (info / "direct_url.json").write_text(json.dumps(direct))
    wheel.add("good-parts", "1.1", bundles={"good": "good_bundle"}, good_bundle=GOOD)
    points = [*wheel.entry_points(), *site.entry_points()]
    monkeypatch.syspath_prepend(str(wheel.folder))
    monkeypatch.syspath_prepend(str(project / "src"))
    (bundle,) = discover(points).bundles
    assert (bundle.problem, bundle.version) == (None, "1.0")
    assert f"Python imports 1.0 in {project}, so" in bundle.note


def test_the_same_folder_twice_on_the_path_is_one_copy(good):
    (bundle,) = discover([*good.entry_points(), *good.entry_points()]).bundles
    assert (bundle.problem, bundle.note) == (None, "")


def test_requirements_are_followed_to_their_end_and_back(site):
    site.add("One.Part", bundles={}, requires=["two_parts (>=1)", "three[fast]>=2; os_name != 'x'"])
    site.add("two-parts", bundles={}, requires=["FOUR ~= 1.0", "one-part"])
    site.add("four", bundles={}, requires=["five @ https://example.org/five.whl"])
    assert required_distributions("one_part") == {"one-part", "two-parts", "three", "four", "five"}


def test_what_only_extras_need_is_not_required(site):
    extras = ["two; extra == 'all'", 'three; os_name == "x" and extra=="b"']
    site.add("one", bundles={}, requires=extras)
    assert required_distributions("one") == frozenset()


def test_what_is_not_installed_requires_nothing():
    assert required_distributions("no-such-distribution") == frozenset()


def test_names_have_one_normal_form():
    for name in ("Moseg-MDS", "moseg_mds", "moseg.-_mds"):
        assert normal_name(name) == "moseg-mds"
