"""``python -m tests.fuzz``: read all cases, or some, and say what became of them.

``--only TEXT`` takes the cases whose key has the text, ``--sample N`` so many of every format and
kind. ``--by-command`` gives them to the command line. ``--keep FOLDER`` writes the files of what
falls short, ``--slowest N`` lists what took longest.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

from tests.fuzz.children import Outcome, run, write_files
from tests.fuzz.command_line import sample
from tests.fuzz.everything import all_cases
from tests.fuzz.table import by, fallen_short, text
from tests.fuzz.verdict import BAD


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--only", default="")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--slowest", type=int, default=0)
    parser.add_argument("--sample", type=int, default=0)
    parser.add_argument("--by-command", action="store_true")
    parser.add_argument("--children", type=int, default=2)
    chosen = parser.parse_args()
    cases = [case for case in all_cases() if chosen.only in case.key]

    def told(outcome: Outcome) -> None:
        if outcome.verdict.outcome not in BAD:
            return
        said = f"{outcome.case.key} | {outcome.verdict.outcome} | {outcome.verdict.said[:300]!r}"
        print(said, flush=True)
        if chosen.keep is not None:
            folder = chosen.keep / re.sub(r"[^A-Za-z0-9^.-]+", "_", outcome.case.key)[:100]
            folder.mkdir(parents=True, exist_ok=True)
            write_files(outcome.case.files(), folder)

    if chosen.sample:
        cases = sample(cases, chosen.sample)
    outcomes = run(cases, children=chosen.children, by_command=chosen.by_command, told=told)
    for key in ("format", "kind"):
        print(text(by(outcomes, key), key), end="\n\n")
    for outcome in sorted(outcomes, key=lambda o: -o.seconds)[: chosen.slowest]:
        print(f"{outcome.seconds:6.1f} s  {outcome.case.key}  {outcome.verdict.outcome}")
    bad = fallen_short(outcomes)
    print(f"{len(outcomes)} files, {len(bad)} fall short")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
