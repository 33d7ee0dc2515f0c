"""What moseg makes of a case: a refusal in a line, a sound result, or one of the bad outcomes.

A child process (:mod:`tests.fuzz.children`) reads the file as a user's command would, by the
public functions, and looks at what comes out. It knows of the case what the generator knew.
"""

from __future__ import annotations

import math
import os
import tempfile
import traceback
import warnings
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from tests.fuzz.case import REFUSED, SOUND

REFUSAL, RESULT, NOTED = "refused in a line", "sound result", "sound, with a note"
GOOD = (REFUSAL, RESULT, NOTED)
HANG, CRASH, MEMORY = "hang", "crash", "out of memory"
INTERNAL, MESSAGE = "internal error", "message of many lines or too long"
NONSENSE, WRONGLY_REFUSED, WARNED = "nonsense accepted", "refused though sound", "NumPy's warning"
BAD = (HANG, CRASH, MEMORY, INTERNAL, MESSAGE, NONSENSE, WRONGLY_REFUSED, WARNED)

ANYTHING: tuple[type[BaseException], ...] = (Exception, SystemExit)
"""What may come out of moseg instead of its own errors; whatever it is, it is the finding."""

_LONGEST = 2000
"""Characters of a message, without the path of the file."""


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """An outcome, and what moseg said or what is wrong."""

    outcome: str
    said: str = ""


def judge(asked: dict[str, Any]) -> Verdict:
    """Read one case.

    Parameters
    ----------
    asked : dict
        ``path``, ``task``, ``expected``, ``elements`` and ``area`` of the case.
    """
    from moseg_core import MosegError

    path = Path(asked["path"])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            found = _TASKS[asked["task"]](path)
            wrong = found.wrong(asked)
        except MosegError as error:
            return _of_message(str(error), error, asked)
        except MemoryError as error:
            return Verdict(outcome=MEMORY, said=repr(error))
        except ANYTHING as error:
            lines = traceback.format_exception(error)
            return Verdict(outcome=INTERNAL, said=f"{error!r:.300} {''.join(lines[-3:]):.600}")
    said = [w for w in caught if not issubclass(w.category, DeprecationWarning)]
    if said:
        return Verdict(outcome=WARNED, said=f"{said[0].message} ({said[0].filename})")
    if wrong:
        return Verdict(outcome=NONSENSE, said=wrong)
    if asked["expected"] == REFUSED:
        return Verdict(outcome=NONSENSE, said=f"accepted: {found.summary}")
    return Verdict(outcome=NOTED if found.notes else RESULT, said="; ".join(found.notes)[:300])


def _of_message(text: str, error: BaseException, asked: dict[str, Any]) -> Verdict:
    """Whether a message is one: of a line, of bounded length, about the file and not the code."""
    from moseg_core import PluginError
    from moseg_core.untrusted.terminal import printable_message

    text = text.replace(str(Path(asked["path"]).parent), "")
    # What is printed; an expression is repeated with a caret below it.
    lines = printable_message(text).split("\n")
    most = 3 if lines[-1].strip(" ^") == "" else 1
    if len(lines) > most or len(text) > _LONGEST:
        what = f"{len(lines)} lines, {len(text)} characters: {text:.300}"
        return Verdict(outcome=MESSAGE, said=what)
    if isinstance(error, PluginError):
        return Verdict(outcome=INTERNAL, said=text)
    if asked["expected"] == SOUND:
        return Verdict(outcome=WRONGLY_REFUSED, said=text)
    return Verdict(outcome=REFUSAL, said=text)


@dataclass(frozen=True, kw_only=True)
class _Found:
    """What was read, in numbers that can be checked."""

    count: int
    summary: str
    notes: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    area: float | None = None

    def wrong(self, asked: dict[str, Any]) -> str:
        least, most = asked["elements"]
        if self.faults:
            return "; ".join(self.faults)
        if not least <= self.count <= most:
            return f"{self.summary}: {self.count} instead of {least} to {most}"
        area = asked["area"]
        if area is not None and not math.isclose(self.area or 0.0, area, rel_tol=1e-3):
            return f"the area is {self.area} instead of {area}"
        return ""


def _read_shape(path: Path) -> _Found:
    import moseg_core as moseg

    shape = moseg.load(path)
    areas = np.asarray(shape.areas)
    weighty = areas > 0
    total = float(areas.sum())
    faults = []
    if len(areas) != shape.n_elements or not (areas >= 0).all() or not np.isfinite(areas).all():
        faults.append("areas that are no areas")
    if not 0 < total < math.inf:
        faults.append(f"areas that add up to {total}")
    if not np.isfinite(np.asarray(shape.points)[weighty]).all():
        faults.append("elements without a place")
    if not (np.isfinite(shape.frame.center).all() and 0 < shape.frame.scale < math.inf):
        faults.append("no size or middle")
    moments = np.concatenate([shape.first_moments, shape.second_moments], axis=1)
    if not np.isfinite(moments).all():
        faults.append("moments that are no numbers")
    if shape.volume is not None and not math.isfinite(shape.volume):
        faults.append(f"a volume of {shape.volume}")
    if shape.adjacency is not None:
        ends = np.asarray(shape.adjacency.indices)
        if ends.size and (ends.min() < 0 or ends.max() >= shape.n_elements):
            faults.append("neighbours that are no elements")
    if any(len(note) > _LONGEST for note in shape.notes):
        faults.append("a note of too many characters")
    return _Found(
        count=shape.n_elements,
        summary=f"{shape.n_elements} elements of {total:g}",
        notes=shape.notes,
        faults=tuple(faults),
        area=total,
    )


@cache
def _labelled(suffix: str) -> Any:
    """What the labels of a file are of: the box, or of medical formats a grid."""
    import moseg_core as moseg
    from tests.fuzz.seeds import box, ell, nifti, nrrd

    write = {".nii": nifti, ".nrrd": nrrd}.get(suffix)
    if write is None:
        return moseg.Shape.from_mesh(*box())
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"grid{suffix}"
        file.write_bytes(write(ell()))
        return moseg.load(file)


def _read_labels(path: Path) -> _Found:
    import moseg_core as moseg

    shape = _labelled(path.suffix)
    found = moseg.read_labels(path, shape)
    labels = np.asarray(found.labels)
    faults = []
    if labels.shape != (shape.n_elements,) or labels.dtype.kind != "i" or labels.min() < -1:
        faults.append("labels that are none")
    if found.names is not None and labels.max() >= len(found.names):
        faults.append("labels without a name")
    if any(len(note) > _LONGEST for note in found.notes):
        faults.append("a note of too many characters")
    return _Found(
        count=int((labels >= 0).sum()),
        summary="labels",
        notes=found.notes,
        faults=tuple(faults),
    )


def _read_result(path: Path) -> _Found:
    import moseg_core as moseg

    result = moseg.load_result(path)
    labels = np.asarray(result.labels)
    faults = []
    if labels.min() < 0 or labels.max() >= len(result.problem.labels):
        faults.append("labels of no part")
    if len(labels) != result.shape.n_elements:
        faults.append(f"{len(labels)} labels of {result.shape.n_elements} elements")
    if not math.isfinite(result.evaluation.cost.value):
        faults.append("a cost that is no number")
    if not np.isfinite(result.centers.positions).all():
        faults.append("centres without a place")
    return _Found(count=len(labels), summary="labels", faults=tuple(faults))


def _read_recipe(path: Path) -> _Found:
    import moseg_core as moseg

    recipe = moseg.load_recipe(str(path))
    levels = sum(len(each.labels) for each in recipe.hierarchies())
    again = recipe.toml()
    return _Found(count=max(1, levels), summary=f"{levels} parts, {len(again)} characters")


def _read_expression(path: Path) -> _Found:
    import moseg_core as moseg
    from moseg_core.language import parse

    text = path.read_bytes().decode("utf-8", "surrogateescape")
    problem = moseg.Problem(["head", "handle"], text)
    expression = parse(text)
    faults = () if parse(str(expression)) == expression else ("reads back as another",)
    return _Found(count=len(problem.terms), summary="terms", faults=faults)


def _read_checkpoint(path: Path) -> _Found:
    from moseg_core.io.checkpoint import Checkpoint
    from tests.fuzz.checkpoints import RUN

    found = Checkpoint(path.with_name("new.checkpoint"), path)
    try:
        known = found.begin(RUN)
    finally:
        found.close()
    faults = () if all(len(key) == 16 and not len(v) % 8 for key, v in known.items()) else ("cut",)
    return _Found(count=len(known), summary=f"{len(known)} answers", faults=faults)


def _hang(path: Path) -> _Found:
    while True:
        pass


def _crash(path: Path) -> _Found:
    os.abort()


def _err(path: Path) -> _Found:
    raise RuntimeError("as a reader may")


def _exhaust(path: Path) -> _Found:
    return _Found(count=len(bytes(1 << 40)), summary="a terabyte")


TRIALS = {"hang": _hang, "crash": _crash, "error": _err, "exhaust": _exhaust}
"""What a child must tell, or die of alone; tried in test_fuzz.py."""

_TASKS = {
    **TRIALS,
    "shape": _read_shape,
    "labels": _read_labels,
    "result": _read_result,
    "recipe": _read_recipe,
    "expression": _read_expression,
    "checkpoint": _read_checkpoint,
}
