"""Run command lines of moseg one after the other in this process, and write where the time went.

    python profiled.py REPORT.json COMMANDS.json

COMMANDS holds a list of lists of arguments. The report has the seconds by stage, as ``moseg segment
--profile`` prints them, summed over all. That is of one process: let commands say ``--workers 1``.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from moseg_core.cli import main
from moseg_core.components.profile import profiling


def stages(commands: list[list[str]]) -> dict[str, float]:
    """Seconds by stage.

    Raises
    ------
    SystemExit
        A command fails.
    """
    with profiling() as profile:
        for arguments in commands:
            try:
                main(arguments)
            except SystemExit as end:
                if end.code:
                    raise
    return {name: entry.seconds for name, _, entry in profile.of("stage")}


if __name__ == "__main__":
    report, commands = map(Path, sys.argv[1:])
    report.write_text(json.dumps(stages(json.loads(commands.read_text()))))
