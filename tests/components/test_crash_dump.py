"""What is read from the stacks that a dying process has written."""

from __future__ import annotations

import subprocess
import sys

import numpy as np

from moseg_core.components.crash_dump import crash_place, crash_reason

SOURCE = """
import ctypes
def bore(address):
    return ctypes.string_at(address)
bore(0)
"""


def test_the_line_is_the_authors_and_not_of_the_library_that_crashed(tmp_path):
    script = tmp_path / "acme.py"
    script.write_text(SOURCE)
    command = [sys.executable, "-X", "faulthandler", str(script)]
    dump = subprocess.run(command, stderr=subprocess.PIPE, text=True).stderr
    assert crash_place(f"noise\n{dump}") == (
        f"in 'bore', {script}:4: \"return ctypes.string_at(address)\""
    )
    assert crash_reason(dump) == "Segmentation fault"


def test_libraries_that_the_core_stands_on_are_passed_over():
    frames = [(np.__file__, 3, "dot"), ("/acme/bore.py", 7, "bore"), ("/acme/main.py", 9, "main")]
    stack = "".join(f'  File "{file}", line {line} in {name}\n' for file, line, name in frames)
    head = "Thread 0x1 (most recent call first):\n"
    other = f'{head}  File "/acme/other.py", line 1 in other\n\n'
    dump = f"Timeout (0:00:09)!\n{other}{head}{stack}"
    assert crash_place(dump) == "in 'bore', /acme/bore.py:7"
    assert crash_place(dump.replace("/acme/", "/usr/lib/python3/dist-packages/numpy/")).startswith(
        "in 'dot'"
    )


def test_where_nothing_was_written_there_is_no_place():
    assert (crash_place(""), crash_reason("")) == ("", "")
    assert crash_place("Current thread 0x1 (most recent call first):\n  <no Python frame>\n") == ""
