"""Where a process crashed, from what ``faulthandler`` wrote: the author's line.

A fault in native code ends its process without an exception. ``faulthandler`` then writes the
stacks of all threads, and the names of all extension modules that were imported; somebody else, who
survived, reads that here (:mod:`moseg_core.components.discovery.first_import`,
:mod:`moseg_core.testing.processes.watching_parent`). As with exceptions
(:func:`moseg_core.components.faults.place`) the line to begin at is the innermost of the author's
own; deeper ones are of the libraries that it called.
"""

from __future__ import annotations

import linecache
import os
import re
import sysconfig

from moseg_core.components.faults import BYSTANDERS, shortest

_STACK = re.compile(r"^(?:Current thread|Thread) .*\(most recent call first\):\n", re.MULTILINE)
_FRAME = re.compile(r'^  File "(.*)", line (\d+) in (.*)$', re.MULTILINE)
_FATAL = re.compile(r"^Fatal Python error: (.*)$", re.MULTILINE)

#: Characters of a source line that are shown.
_LONGEST = 80


def crash_place(dump: str) -> str:
    r"""Function, file and line where the author's code was; empty where no stack was written.

    Parameters
    ----------
    dump : str
        What the process wrote; what comes before the stack, and after it, is passed over.

    Examples
    --------
    >>> dump = (
    ...     "Current thread 0x1 (most recent call first):\n"
    ...     f'  File "{os.__file__}", line 9 in read\n'
    ...     '  File "/acme/bore.py", line 4 in bore\n'
    ...     "\nExtension modules: numpy.core (total: 1)\n"
    ... )
    >>> crash_place(dump)
    "in 'bore', /acme/bore.py:4"
    """
    # Of several stacks the one that is current; where a crash follows on another dump, the last.
    heads = list(_STACK.finditer(dump))
    current = [head for head in heads if head.group().startswith("Current")] or heads
    if not current:
        return ""
    stack = dump[current[-1].end() :].partition("\n\n")[0]
    frames = _FRAME.findall(stack)
    own = [frame for frame in frames if not _is_bystander(frame[0])] or frames
    if not own:
        return ""
    file, number, function = own[0]
    line = " ".join(linecache.getline(file, int(number)).split())
    shown = line if len(line) <= _LONGEST else f"{line[: _LONGEST - 3]}..."
    where = f"{shortest(file)}:{number}" + (f': "{shown}"' if shown else "")
    return where if function == "<module>" else f"in '{function}', {where}"


def crash_reason(dump: str) -> str:
    r"""What Python called the fault; empty where it did not say.

    Examples
    --------
    >>> crash_reason("Fatal Python error: Segmentation fault\n\nCurrent thread 0x1 ...")
    'Segmentation fault'
    """
    found = _FATAL.findall(dump)
    return found[-1].strip() if found else ""


def _is_bystander(file: str) -> bool:
    """Whether a file is of Python, of the core, or of what the core stands on."""
    if file.startswith("<frozen "):
        return True
    parts = os.path.normpath(file).split(os.sep)
    for packages in ("site-packages", "dist-packages"):
        if packages in parts:
            place = len(parts) - parts[::-1].index(packages)
            return parts[place : place + 1] != [] and parts[place] in BYSTANDERS
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    standard = sysconfig.get_path("stdlib")
    return any(os.path.normpath(file).startswith(folder + os.sep) for folder in (home, standard))
