"""What killed processes leave behind: files that were being written.

A file is written aside, under its own name with a dot in front and some letters behind
(:mod:`moseg_core.io.whole_file`), and renamed when it is whole. Who is killed meanwhile leaves it
there. When a batch is gone on with, nobody else is at work on it, and what bears such a name of one
of its outputs is taken away.
"""

from __future__ import annotations

import fnmatch
import glob
import os
import re
from collections.abc import Sequence
from pathlib import Path

from moseg_core.batching.jobs import PLACE
from moseg_core.io.part_files import is_for_parts

#: The name of a file that is being written: that of the file itself, and letters behind.
_ASIDE = re.compile(r"\.(.+)\.[a-z0-9_]{8}")
#: Characters of such a name that are kept at least, where it is long.
_CUT = 40


def take_away_leftovers(folder: Path, templates: Sequence[str], names: Sequence[str]) -> None:
    """Take away what processes that were killed have left of files that they were writing.

    Parameters
    ----------
    folder : Path
        Of the batch.
    templates : sequence of str
        Further outputs, with ``{shape}`` in them.
    names : sequence of str
        What stands for it.
    """
    asked = (os.path.join(folder, f"{PLACE}.json"), *templates)
    wanted: dict[Path, list[str]] = {}
    for template in asked:
        for name in names:
            output = Path(os.path.abspath(template.replace(PLACE, name)))
            wanted.setdefault(output.parent, []).append(output.name)
    for place, files in wanted.items():
        exact = {file for file in files if not is_for_parts(Path(file))}
        patterns = [glob.escape(file).replace("{part}", "*") for file in {*files} - exact]
        for entry in os.scandir(place) if place.is_dir() else ():
            if aside := _ASIDE.fullmatch(entry.name):
                name = aside[1]
                cut = len(name) >= _CUT and any(file.startswith(name) for file in exact)
                if name in exact or cut or any(fnmatch.fnmatchcase(name, p) for p in patterns):
                    Path(entry.path).unlink(missing_ok=True)
