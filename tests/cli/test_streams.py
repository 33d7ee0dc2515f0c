"""Messages are written without heed, and warnings are messages."""

from __future__ import annotations

import subprocess
import sys
import warnings

import pytest

from moseg_core.cli.streams import show_warnings

CHILD = """
import sys
from moseg_core.cli.streams import prepare_streams
prepare_streams()
for _ in range(3):
    print("\\udcf6" * 9000, file=sys.stderr)
first = open("first", "w")
assert first.fileno() > 2
print("done")
"""


@pytest.mark.parametrize(
    ("streams", "out"), [("2>/dev/full", "done\n"), ("<&- >&- 2>&-", ""), (">&-", "")]
)
def test_nobody_need_read_messages_and_no_file_takes_the_place_of_a_stream(tmp_path, streams, out):
    command = ["sh", "-c", f'exec "$@" {streams}', "sh", sys.executable, "-c", CHILD]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, out)
    assert "Traceback" not in done.stderr
    assert (tmp_path / "first").read_text() == ""


def test_warnings_are_told_in_a_line_with_the_place_where_it_is_a_strangers():
    told = []
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        show_warnings(told.append)
        warnings.warn_explicit("two\nlines", RuntimeWarning, "/usr/lib/x.py", 3)
        warnings.warn_explicit(
            "ours", RuntimeWarning, sys.modules[show_warnings.__module__].__file__, 3
        )
    assert told == ["warning: two lines (RuntimeWarning, /usr/lib/x.py:3)", "warning: ours"]
