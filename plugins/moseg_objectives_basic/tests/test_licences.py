"""libigl's wheel carries parts under other licences; none of them is ever imported."""

from __future__ import annotations

import subprocess
import sys

_PROGRAM = """
import sys
import moseg_core as moseg
shape = moseg.load(moseg.sample_path("hammer"))
terms = "thick(a) + planar_symmetric(a) + ellipsoidal(a) + convex(a) + convex_parts"
moseg.Problem(["a"], terms).evaluate(shape, [0] * shape.n_elements)
print(*(name for name in sys.modules if name.startswith("igl")))
"""


def test_only_the_core_of_libigl_is_imported():
    done = subprocess.run(
        [sys.executable, "-c", _PROGRAM], check=True, capture_output=True, text=True
    )
    modules = done.stdout.split()
    assert "igl" in modules
    assert not [name for name in modules if "copyleft" in name or "triangle" in name]
