"""A sample of the cases through the command line, as a user would give them to it.

``main`` runs within the child. It must end with an exit code of :mod:`moseg_core.errors` that is
about the input, say a failure in one line, and print nothing that a terminal obeys.
"""

from __future__ import annotations

import atexit
import contextlib
import io
import shutil
import tempfile
import traceback
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from tests.fuzz.case import REFUSED, SOUND, Case
from tests.fuzz.verdict import (
    ANYTHING,
    INTERNAL,
    MESSAGE,
    NONSENSE,
    REFUSAL,
    RESULT,
    WRONGLY_REFUSED,
    Verdict,
)

_ABOUT_THE_INPUT = (0, 2, 3)


def sample(cases: Sequence[Case], size: int) -> list[Case]:
    """So many cases, of every format and kind alike: each pair in turn gives one, then another."""
    groups: dict[tuple[str, str], list[Case]] = {}
    for case in cases:
        groups.setdefault((case.format, case.kind), []).append(case)
    # Places in a group that are far from each other, the same each time.
    queues = [[group[k * 7 % len(group)] for k in range(len(group))] for group in groups.values()]
    turns = (queue[k] for k in range(max(map(len, queues))) for queue in queues if k < len(queue))
    chosen = dict.fromkeys(case.key for case, _ in zip(turns, range(size), strict=False))
    return [case for case in cases if case.key in chosen]


@cache
def _beside() -> Path:
    """A folder that lasts as long as this process: the box, labels of it, and grids."""
    from tests.fuzz.seeds import ell, nifti, nrrd
    from tests.fuzz.statements import LABELS, box_file

    folder = Path(tempfile.mkdtemp(prefix="moseg-fuzz-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    (folder / "box.off").write_bytes(next(iter(box_file().values())))
    (folder / "labels.seg").write_text("".join(f"{label}\n" for label in LABELS))
    (folder / "grid.nii").write_bytes(nifti(ell()))
    (folder / "grid.nrrd").write_bytes(nrrd(ell()))
    return folder


def words_of(asked: dict[str, Any]) -> list[str]:
    """The command that reads a case: the cheapest that does."""
    path, folder = asked["path"], _beside()
    box, labels = str(folder / "box.off"), str(folder / "labels.seg")
    grid = folder / f"grid{Path(path).suffix}"
    whole = str(grid) if grid.is_file() else box
    text = Path(path).read_bytes().decode("utf-8", "surrogateescape")
    words: dict[str, list[str]] = {
        "shape": ["field", path, "height"],
        "labels": ["evaluate", whole, path, path],
        "result": ["explain", path],
        "recipe": ["explain", box, "--parts", labels, "--recipe", path],
        "expression": ["explain", box, "--parts", labels, "--labels", "head,handle",
                       f"--minimize={text}"],
        # It is of another run, which is said.
        "checkpoint": ["segment", box, "--labels", "head,handle", "--minimize", "narrow(head)",
                       "--quiet", "--resume", path, "-o", str(Path(path).with_suffix(".seg"))],
    }  # fmt: skip
    return words[asked["task"]]


def judge_command(asked: dict[str, Any]) -> Verdict:
    """Run the command of one case; see :func:`tests.fuzz.verdict.judge`."""
    from moseg_core.cli import main

    out, err = io.StringIO(), io.StringIO()
    code: object = 0
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            main(words_of(asked))
    except SystemExit as ended:
        code = ended.code
    except ANYTHING as error:
        lines = traceback.format_exception(error)
        return Verdict(outcome=INTERNAL, said=f"{error!r:.300} {''.join(lines[-3:]):.600}")
    printed, said = out.getvalue(), err.getvalue()
    if "Traceback" in said or code not in _ABOUT_THE_INPUT:
        return Verdict(outcome=INTERNAL, said=f"exit code {code}: {said[-600:]}")
    raw = [c for c in printed + said if not c.isprintable() and c != "\n"]
    if raw:
        return Verdict(outcome=MESSAGE, said=f"prints {raw[0]!r}: {said[-300:]}")
    if not code:
        wrong = asked["expected"] == REFUSED
        return Verdict(outcome=NONSENSE if wrong else RESULT, said=printed[:200])
    if asked["expected"] == SOUND and asked["task"] != "checkpoint":
        return Verdict(outcome=WRONGLY_REFUSED, said=said[-300:])
    lines = said.splitlines()
    caret = len(lines) > 2 and lines[-1].strip(" ^") == ""
    last = lines[-3] if caret else lines[-1] if lines else ""
    if not last.startswith("moseg: ") or len(last) > 3000:
        return Verdict(outcome=MESSAGE, said=f"{len(said)} characters: {said[-300:]}")
    return Verdict(outcome=REFUSAL, said=last[:300])
