"""Measures that change the process that they run in, and the module of a bundle that speaks.

Measures, because nothing else is asked of them.
"""

from __future__ import annotations

import os
import signal
import tempfile
import threading

from moseg_core.components.discovery.specs import MeasureSpec

_NAMES = {
    "working-directory-untouched": "goes_elsewhere",
    "signals-untouched": "takes_a_signal",
    "no-threads-left": "leaves_a_thread",
    "environment-untouched": "sets_a_variable",
}

BROKEN = {
    **{
        id: MeasureSpec(name="broken", target=f"tests.testing.broken.side_effects:{name}")
        for id, name in _NAMES.items()
    },
    "imports-quietly": MeasureSpec(
        name="broken", target="tests.testing.broken.side_effects:is_announced"
    ),
}

BUNDLES = {"imports-quietly": "tests.testing.talkative"}
"""Modules of bundles that are not quiet themselves."""


def is_announced(part):
    """Its bundle greets everybody who asks what is installed."""
    return part.area


def goes_elsewhere(part):
    """It wants to find its files more easily."""
    os.chdir(tempfile.gettempdir())
    return part.area


def takes_a_signal(part):
    """It wants to hear of it first."""
    signal.signal(signal.SIGUSR2, signal.SIG_IGN) if _in_main_thread() else None
    return part.area


def _in_main_thread():
    return threading.current_thread() is threading.main_thread()


def leaves_a_thread(part):
    """It starts a helper once, and keeps it."""
    if not any(thread.name == "left" for thread in threading.enumerate()):
        OVER.clear()
        threading.Thread(target=OVER.wait, name="left", daemon=True).start()
    return part.area


OVER = threading.Event()
"""Ends that thread, for the sake of other tests."""


def sets_a_variable(part):
    """It tells a library how many threads to use, and everybody else too."""
    os.environ["MOSEG_TESTS_THREADS"] = "1"
    return part.area


def seeds(part):
    """It always draws the same, and so does everybody else afterwards."""
    import random

    import numpy as np

    np.random.seed(1)  # noqa: NPY002  # that is what is wrong
    random.seed(1)
    return part.area


def moves_vertices(part):
    """It centres the part, for all who look at it."""
    if not part.shape.has_surface:
        return part.area
    part.vertices.flags.writeable = True
    part.vertices[:] += 1e-3
    return part.area


def raises_filters(part):
    """It shows all warnings from now on."""
    import warnings

    warnings.simplefilter("always", category=FutureWarning, append=True)
    return part.area


def divides_quietly(part):
    """It does not want to hear of zeros, nor does anybody else from now on."""
    import numpy as np

    np.seterr(under="raise")
    return part.area
