"""The default components of a search; see also ``test_search_options.py``."""

from __future__ import annotations

from moseg_core.components.chosen import prepare
from moseg_core.components.discovery.registry import registry
from moseg_core.problem.settings import SearchOptions


def test_the_defaults_are_installed_and_need_no_parameters():
    settled = SearchOptions().settled()
    for kind in ("parameterization", "seeder", "labeler", "optimizer"):
        ready = prepare(getattr(settled, kind), kind, registry())
        assert ready.component.bundle == "core"
        assert ready.parameters == {}
