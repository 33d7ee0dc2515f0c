"""Each check of side effects fails for the measure that has it, and no other."""

from __future__ import annotations

import sys
import threading

import pytest

from moseg_core.components.discovery.specs import MeasureSpec
from tests.testing.broken.side_effects import BROKEN, BUNDLES, OVER
from tests.testing.outcomes import HOME, assert_fails_only, failures


@pytest.fixture(autouse=True)
def no_threads_left():
    yield
    OVER.set()
    for thread in threading.enumerate():
        if thread.name == "left":
            thread.join()


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id], BUNDLES.get(id, HOME))


@pytest.mark.parametrize(
    ("name", "id"),
    [
        ("seeds", "random-state-untouched"),
        ("moves_vertices", "inputs-untouched"),
        ("raises_filters", "environment-untouched"),
        ("divides_quietly", "environment-untouched"),
    ],
)
def test_other_ways_to_the_same(name, id):
    spec = MeasureSpec(name="broken", target=f"tests.testing.broken.side_effects:{name}")
    assert set(failures(spec)) == {id}


MODULES = {
    "prints": 'print("hello")',
    "writes_below_python": 'import os; os.write(1, b"hello\\n")',
    "goes_elsewhere": 'import os; os.chdir("/")',
    "seeds": "import random; random.seed(3)",
    "takes_a_signal": "import signal; signal.signal(signal.SIGUSR2, signal.SIG_IGN)",
}


@pytest.mark.parametrize("name", MODULES)
def test_a_component_whose_module_does_something_when_it_is_imported(name, tmp_path, monkeypatch):
    module = f"loud_{name}"
    (tmp_path / f"{module}.py").write_text(
        f"{MODULES[name]}\ndef spread(part):\n    return float(sum(part.scales))\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, module, raising=False)
    spec = MeasureSpec(name="own", target=f"{module}:spread")
    # Other checks ask processes that were started before the module was there.
    assert {"imports-quietly", "target-resolves"} & set(failures(spec))
