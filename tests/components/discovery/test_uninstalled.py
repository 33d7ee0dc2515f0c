"""Classes and functions as components, by their qualified names."""

from __future__ import annotations

import functools

import pytest

from moseg_core.components.discovery.uninstalled import (
    NOT_INSTALLED,
    qualified_name,
    uninstalled,
    with_arguments,
)
from moseg_core.errors import PluginError, UsageError


class CamelCase2D:
    class Inner:
        pass

    def __call__(self):
        pass


@pytest.mark.parametrize(
    ("target", "name", "spec_name"),
    [
        (CamelCase2D, "CamelCase2D", "camel_case2_d"),
        (CamelCase2D.Inner, "CamelCase2D.Inner", "inner"),
        (CamelCase2D(), "CamelCase2D", "camel_case2_d"),
        (lambda: None, "<lambda>", "lambda_"),
    ],
)
def test_names(target, name, spec_name):
    component = uninstalled(target, "seeder")
    assert component.id == qualified_name(target) == f"{__name__}:{name}"
    assert component.spec.name == spec_name
    assert component.load() is target
    assert (component.kind, component.distribution) == ("seeder", NOT_INSTALLED)


def test_errors_name_the_class():
    with (
        pytest.raises(PluginError, match=r":CamelCase2D', which is not installed, failed: Zero"),
        uninstalled(CamelCase2D, "seeder").guard(),
    ):
        _ = 1 / 0


def test_a_reader_needs_suffixes():
    with pytest.raises(UsageError, match="give a ReaderSpec"):
        uninstalled(CamelCase2D, "reader")


def test_only_keywords_are_parameters():
    keywords, positional = functools.partial(print, end=""), functools.partial(print, "a")
    assert with_arguments(keywords) == (print, {"end": ""})
    assert with_arguments(positional) == (positional, {})
    assert with_arguments(print) == (print, {})
