"""The hooks: one for each kind of component, with its spec."""

from __future__ import annotations

import typing

from moseg_core.components.discovery import hookspecs
from moseg_core.components.discovery.hookspecs import HOOKS
from moseg_core.components.discovery.specs import (
    Kind,
    Spec,
)


def test_every_kind_has_its_spec_and_its_hook():
    assert [kind for kind, _ in HOOKS.values()] == list(typing.get_args(Kind))
    for hook, (kind, spec_type) in HOOKS.items():
        assert issubclass(spec_type, Spec)
        assert spec_type.kind == kind
        declared = getattr(hookspecs, hook)
        assert declared.moseg_spec is not None
        assert spec_type.__name__ in declared.__annotations__["return"]


def test_no_hook_is_declared_that_is_not_collected():
    declared = {name for name in dir(hookspecs) if hasattr(getattr(hookspecs, name), "moseg_spec")}
    assert declared == set(HOOKS)
