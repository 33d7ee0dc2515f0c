"""Which distributions are installed, and what they require."""

from __future__ import annotations

from moseg_core.components.discovery.distributions import normal_name, required_distributions


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
