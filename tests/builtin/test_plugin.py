"""The core's own bundle: what it offers, under which names, and that it is light."""

from __future__ import annotations

import subprocess
import sys

import moseg_core.builtin.plugin as plugin
from moseg_core.components.discovery.hookspecs import HOOKS
from moseg_core.components.discovery.registry import registry


def offered():
    hooks = [(kind, getattr(plugin, hook, None)) for hook, (kind, _) in HOOKS.items()]
    return {(kind, spec.name): spec for kind, hook in hooks if hook for spec in hook()}


def test_what_it_offers_is_what_the_registry_knows_of_the_core():
    known = {(c.kind, c.spec.name): c.spec for c in registry().components() if c.bundle == "core"}
    assert known == offered()


def test_there_is_one_of_every_kind_that_a_search_needs():
    kinds = {kind for kind, _ in offered()}
    assert {"parameterization", "seeder", "labeler", "optimizer", "reader", "writer"} <= kinds
    # What the paper only gives examples of, and what needs more than the core, are bundles.
    assert not kinds & {"objective", "constraint", "embedding"}


def test_targets_are_in_the_core_and_suffixes_are_no_two_components():
    suffixes = []
    for (kind, _), spec in offered().items():
        assert spec.target.startswith("moseg_core.")
        suffixes += [(kind, suffix) for suffix in getattr(spec, "suffixes", ())]
    assert len(suffixes) == len(set(suffixes))
    assert {("reader", ".off"), ("writer", ".json"), ("writer", ".seg")} <= set(suffixes)


def test_importing_it_imports_no_component():
    code = "import sys, moseg_core.builtin.plugin; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert not loaded & {spec.target.partition(":")[0] for spec in offered().values()}
    assert "numpy" not in loaded
