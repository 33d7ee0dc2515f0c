"""What is told of an error that a component raises: kind, message, the author's own line."""

from __future__ import annotations

import asyncio
import importlib
import os
import signal
import sys

import numpy as np
import pytest

from moseg_core.components.chosen import PreparedComponent
from moseg_core.components.discovery.registry import Component
from moseg_core.components.discovery.specs import ReaderSpec, SeederSpec
from moseg_core.components.faults import describe, place, safe_repr, summary
from moseg_core.errors import PluginError, UsageError

SOURCE = (
    '''
import numpy as np


def deep(k):
    return 1 / k


def shallow(k):
    return deep(k)


def in_a_library():
    matrix = np.zeros((2, 2))
    return np.linalg.inv(
        matrix)


def through_a_library():
    return np.vectorize(deep)(0)


def long_line():
    raise ValueError("'''
    + 90 * "x"
    + """")


def leave():
    raise SystemExit(3)


def busy():
    open("/no/such/folder/weights.bin")


class Broken:
    def __str__(self):
        return "only two\\n lines"
"""
)


@pytest.fixture
def module(tmp_path, monkeypatch):
    (tmp_path / "stranger_parts.py").write_text(SOURCE)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "stranger_parts", raising=False)
    return importlib.import_module("stranger_parts")


def caught(function, *given):
    """What a function raises, as if the core had called it: without the frame of this call."""
    with pytest.raises(BaseException) as raised:  # noqa: PT011  # of any kind
        function(*given)
    error = raised.value
    return error.with_traceback(error.__traceback__.tb_next)


def test_the_place_is_the_innermost_line_of_the_author(module, tmp_path):
    error = caught(module.shallow, 0)
    file = tmp_path / "stranger_parts.py"
    assert place(error) == f'{file}:6: "return 1 / k"'
    assert describe(error) == f"ZeroDivisionError: division by zero ({place(error)})"
    assert summary(error) == "ZeroDivisionError: division by zero"


def test_frames_of_libraries_are_nobodys_fault(module):
    assert ':15: "return np.linalg.inv("' in place(caught(module.in_a_library))
    assert ':6: "return 1 / k"' in place(caught(module.through_a_library))


def test_a_file_below_the_working_directory_is_named_from_there(module, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert place(caught(module.deep, 0)).startswith("stranger_parts.py:6: ")
    monkeypatch.chdir(tmp_path.parent)
    assert place(caught(module.deep, 0)).startswith(f"{tmp_path.name}{os.sep}stranger_parts.py:6: ")


def test_a_long_line_is_cut(module):
    where = place(caught(module.long_line))
    assert where.endswith('..."')
    assert len(where.partition(': "')[2]) == 81


def test_code_without_a_file_has_a_line_number_still():
    scope = {"__name__": "typed_in"}
    exec("def fail():\n    return [][0]", scope)
    assert place(caught(scope["fail"])) == "<string>:2"


def test_the_core_and_python_have_no_place(module):
    assert place(caught(importlib.import_module, "no_such_module")) == ""
    assert place(caught(np.linalg.inv, np.zeros((2, 2)))) == ""
    assert place(ValueError("never raised")) == ""


def test_errors_of_moseg_say_themselves_what_is_wrong():
    def refuse():
        raise UsageError("no")

    assert place(caught(refuse)) == ""
    assert describe(caught(refuse)) == "UsageError: no"


def guarded(kind, function, *given):
    spec = kind(name="odd", target="a:b", **({"suffixes": (".odd",)} if kind is ReaderSpec else {}))
    component = Component("strange", "moseg-strange 2.0", spec)
    PreparedComponent(component=component, factory=function, parameters={}).make(*given)


def test_a_guarded_component_is_named_with_the_place_and_the_cause(module):
    error = caught(guarded, SeederSpec, module.shallow, 0)
    assert isinstance(error, PluginError)
    assert isinstance(error.__cause__, ZeroDivisionError)
    assert str(error).startswith("seeder 'strange:odd' of moseg-strange 2.0 cannot be made: ")
    assert "ZeroDivisionError: division by zero (" in str(error)
    assert 'stranger_parts.py:6: "return 1 / k")' in str(error)
    assert "\n" not in str(error)


def test_a_component_that_exits_is_named(module):
    error = caught(guarded, SeederSpec, module.leave)
    assert isinstance(error, PluginError)
    assert error.exit_code == 1
    assert "SystemExit: 3 (" in str(error)
    assert "raise SystemExit(3)" in str(error)


def test_ctrl_c_passes():
    def press():
        signal.raise_signal(signal.SIGINT)

    assert isinstance(caught(guarded, SeederSpec, press), KeyboardInterrupt)


@pytest.mark.parametrize("kind", [KeyboardInterrupt, BaseException, asyncio.CancelledError])
def test_what_a_component_raises_itself_is_its_fault_whatever_it_is(kind):
    def pretend():
        raise kind("as if")

    error = caught(guarded, SeederSpec, pretend)
    assert isinstance(error, PluginError)
    assert f"{kind.__name__}: as if (" in str(error)


def test_what_cannot_be_shown_is_told_all_the_same():
    class Shy(BaseException):
        def __str__(self):
            raise RuntimeError("no")

        __repr__ = __str__

    def shy():
        raise Shy

    assert "Shy: it does not say what" in str(caught(guarded, SeederSpec, shy))
    assert safe_repr(Shy()) == "a Shy, which cannot be shown"


def test_errors_about_files_pass_from_readers_only(module):
    assert isinstance(caught(guarded, ReaderSpec, module.busy), FileNotFoundError)
    error = caught(guarded, SeederSpec, module.busy)
    assert "seeder 'strange:odd' of moseg-strange 2.0 cannot be made: FileNotFoundError" in str(
        error
    )
