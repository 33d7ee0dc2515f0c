"""The contract that a bundle was written for, and which ones the core accepts."""

from __future__ import annotations

from textwrap import dedent

import pytest

from moseg_core import __version__
from tests.components.discovery.conftest import GOOD

CONTRACTS = {
    "stated": ("moseg_contract = 1", None),
    "unstated": ("", None),
    "newer": (
        "moseg_contract = 7",
        f"it was written for contract 7, and moseg-core {__version__} accepts 1; install a newer"
        " moseg-core, or a Good-Parts for contract 1",
    ),
    "newer, with a hook that there is not": (
        "moseg_contract = 7\n@hookimpl\ndef moseg_textures(): return []",
        "it was written for contract 7, and",
    ),
    "not a number": ("moseg_contract = '1'", "moseg_contract must be a whole number from 1 on"),
    "none at all": ("moseg_contract = 0", "moseg_contract must be a whole number from 1 on, not 0"),
    "true": ("moseg_contract = True", "moseg_contract must be a whole number from 1 on, not True"),
}


@pytest.mark.parametrize("case", CONTRACTS)
def test_a_bundle_says_which_contract_it_was_written_for(site, case):
    said, problem = CONTRACTS[case]
    source = f"{dedent(GOOD)}\n{said}\n"
    site.add("Good-Parts", "1.2.3", bundles={"good": "good_bundle"}, good_bundle=source)
    site.add("other", bundles={"other": "other_bundle"}, other_bundle=GOOD)
    bundle, other = site.discover().bundles
    assert (other.problem, len(other.components)) == (None, 3)
    if problem is None:
        assert (bundle.problem, bundle.contract, len(bundle.components)) == (None, 1, 3)
    else:
        assert bundle.problem.startswith("Good-Parts 1.2.3: ")
        assert problem in bundle.problem
        assert bundle.components == ()
        assert "no such hook" not in bundle.problem


def test_contracts_of_the_past_ask_for_a_newer_bundle(good, monkeypatch):
    monkeypatch.setattr("moseg_core.components.discovery.contract.CONTRACT", 5)
    monkeypatch.setattr("moseg_core.components.discovery.contract.ACCEPTED", frozenset({4, 5}))
    (bundle,) = good.discover().bundles
    assert bundle.problem == (
        f"Good-Parts 1.2.3: it was written for contract 1, and moseg-core {__version__} accepts"
        " 4, 5; install a newer Good-Parts, or an older moseg-core"
    )


def test_a_name_that_the_core_has_not_may_be_of_another_version_of_it(site):
    source = "from moseg_core import TextureSpec"
    site.add("new", "2.0", bundles={"new": "new_bundle"}, new_bundle=source)
    (bundle,) = site.discover().bundles
    assert "ImportError: cannot import name 'TextureSpec' from 'moseg_core'" in bundle.problem
    assert bundle.problem.endswith(f"it may need another moseg-core than {__version__}")
