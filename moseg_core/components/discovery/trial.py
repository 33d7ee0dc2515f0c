"""The child that imports new bundles first: it may die of one, hang in one, or be changed by one.

Started by :mod:`moseg_core.components.discovery.first_import` with the bundles to try. For each the
child does what the registry will do, imports its module and calls its hooks, and reports line by
line as JSON through a pipe of its own, since what a bundle prints must not get in between::

    {"event": "begin", "index": 0}
    {"event": "end", "index": 0, "problem": "", "printed": "hello",
     "files": ["/.../moseg_vessels/plugin.py"]}
    {"event": "copied", "index": 0}

A bundle that merely raises has no problem here: the registry will find the same, and say it in its
own words. What it must not meet is what this module looks for: a bundle's own
``KeyboardInterrupt``, and changes of the process (:mod:`moseg_core.components.process_state`). The
child ends after the first bundle with a problem, since the next ones would meet what that one has
left behind. In the end it exits with a code of its own, which a bundle that has arranged for
something else at exit changes.
"""

from __future__ import annotations

import faulthandler
import json
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from moseg_core.components.discovery.distributions import Claim, installed_points, read_claims
from moseg_core.components.discovery.first_import import SOUND
from moseg_core.components.discovery.known_bundles import identity
from moseg_core.components.discovery.registry import load_alone
from moseg_core.components.faults import describe
from moseg_core.components.process_state import AT_IMPORT, changed, look, told

#: Characters of what a bundle prints that are reported.
_MOST = 200


def main(arguments: Sequence[str]) -> None:
    """Try bundles, and report.

    Parameters
    ----------
    arguments : sequence of str
        The number of a descriptor to write to, the seconds that a bundle may take, and the
        identities of the bundles (:func:`moseg_core.components.discovery.known_bundles.identity`)
        as JSON.
    """
    faulthandler.enable()
    descriptor, timeout, wanted = int(arguments[0]), float(arguments[1]), json.loads(arguments[2])
    pipe = os.fdopen(descriptor, "w", encoding="utf-8")

    def write(**fields: Any) -> None:
        print(json.dumps(fields), file=pipe, flush=True)

    def leave() -> None:
        """End a copy of this process, which a bundle has made, and tell of it."""
        write(event="copied", index=index)
        os._exit(SOUND)

    os.register_at_fork(after_in_child=leave)
    index = 0
    claims = {identity(claim): claim for claim in read_claims(installed_points())}
    loaded = set(sys.modules)
    for index, name in enumerate(wanted):
        if name not in claims:  # uninstalled meanwhile
            continue
        write(event="begin", index=index)
        # A little before the other side loses patience: it shows where a bundle hangs.
        faulthandler.dump_traceback_later(0.9 * timeout)
        problem, printed = _tried(claims[name])
        faulthandler.cancel_dump_traceback_later()
        new = [sys.modules[name] for name in set(sys.modules) - loaded]
        files = sorted({file for module in new if (file := _file_of(module))})
        write(event="end", index=index, problem=problem, printed=printed, files=files)
        if problem:
            os._exit(SOUND)  # without what it may have arranged for the end
    sys.exit(SOUND)


def _tried(claim: Claim) -> tuple[str, str]:
    """What is wrong with a bundle, and what it printed on standard output."""
    problem = ""
    with _listening() as heard:
        before = look(AT_IMPORT)
        try:
            load_alone(claim)
        except BaseException as error:  # noqa: BLE001  # nobody interrupts this process
            problem = f"failed with {describe(error)}"
        changes = changed(before)
    if _seeded_numpy():
        changes["the global generator of numpy.random"] = ""
    if changes and not problem:
        problem = f"changes {told(changes)}"
    return problem, heard[0]


def _seeded_numpy() -> bool:
    """Whether somebody has seeded numpy's global generator: it then has no seed sequence."""
    module = sys.modules.get("numpy.random")
    generator = getattr(getattr(module, "mtrand", None), "_rand", None)
    bits = getattr(generator, "_bit_generator", None)
    return getattr(bits, "seed_seq", bits) is None and bits is not None


@contextmanager
def _listening() -> Iterator[list[str]]:
    """What is printed on standard output, also below Python: in a list, once it is known."""
    heard: list[str] = []
    with tempfile.TemporaryFile("w+b") as file:
        kept, stream = os.dup(1), sys.stdout
        text = os.fdopen(os.dup(file.fileno()), "w", encoding="utf-8", errors="replace")
        os.dup2(file.fileno(), 1)
        sys.stdout = text
        try:
            yield heard
        finally:
            if not text.closed:
                text.flush()
            sys.stdout = stream
            os.dup2(kept, 1)
            os.close(kept)
            file.seek(0)
            words = file.read(4 * _MOST).decode("utf-8", "replace").split()
            heard.append(" ".join(words)[:_MOST])


def _file_of(module: object) -> str:
    """The file of a module, but for Python's own and the core's."""
    try:
        file, name = vars(module).get("__file__"), vars(module).get("__name__")
    except TypeError:  # anything can stand among the modules
        return ""
    if not isinstance(file, str) or not isinstance(name, str):
        return ""
    if name.partition(".")[0] in ("moseg_core", *sys.stdlib_module_names):
        return ""
    return os.path.abspath(file)
