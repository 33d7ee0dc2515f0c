"""One job, done in this process: read the shape, search, write the files.

The same steps as ``moseg segment`` takes, with one process for the search, so that the result has
the same bytes. All files are made before the first is written, and the result (.json) comes last:
where it is, the others are.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from moseg_core.batching.instructions import Instructions
from moseg_core.clipping.clip import check_clippable
from moseg_core.components.faults import FAULTS, describe
from moseg_core.components.protocols import never_stop
from moseg_core.errors import REPORT, MosegError, PluginError, ShapeError, UsageError
from moseg_core.io.files import files_of, write_files
from moseg_core.io.part_files import check_part_form, is_for_parts, part_files
from moseg_core.io.write.formats import check_writable
from moseg_core.problem.call_limit import limiting_calls
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.variants import Variants
from moseg_core.search.alignment import align
from moseg_core.search.clipped_result import clip
from moseg_core.search.number_of_parts import solve_parts
from moseg_core.search.pieces import searched_part
from moseg_core.search.result import Result
from moseg_core.search.variants import solve_variants
from moseg_core.shape.shape import Shape


@dataclass(frozen=True, eq=False, kw_only=True)
class Prepared:
    """Instructions with their names looked up, which takes as long as a small shape does.

    Parameters
    ----------
    instructions : Instructions
    smallest : Hierarchy
        The problem with the fewest labels, by which shapes are checked.
    variants : Variants or None
        None where the number of parts is open.
    """

    instructions: Instructions
    smallest: Hierarchy
    variants: Variants | None


@lru_cache(maxsize=1)
def prepared(text: str) -> Prepared:
    """What instructions, as JSON, stand for; remembered for the next shape."""
    instructions = Instructions.read(json.loads(text))
    tasks = instructions.problems()
    return Prepared(
        instructions=instructions,
        smallest=min(tasks, key=lambda task: len(task.problem.labels)),
        variants=instructions.variants() if instructions.n_parts is None else None,
    )


def do_job(shape: str, outputs: Sequence[str], instructions: str) -> dict[str, Any]:
    """Segment a shape and write what is asked for.

    Parameters
    ----------
    shape : str
        Path.
    outputs : sequence of str
        Paths, the result (.json) first.
    instructions : str
        As JSON.

    Returns
    -------
    dict
        Fields of an :class:`~moseg_core.batching.outcome.Outcome`, as plain data.
    """
    try:
        ready = prepared(instructions)
        read = ready.instructions.reading.read(shape)
        result = _solved(read, ready, [Path(output) for output in outputs])
        files = _written(result, [Path(output) for output in outputs], Path(shape), ready)
    except MemoryError as error:
        return _failed("out of memory", describe(error))
    except MosegError as error:
        if _for_want_of_memory(error):
            return _failed("out of memory", str(error))
        kinds = ((ShapeError, "bad shape"), (UsageError, "usage"), (PluginError, "plugin error"))
        kind = next((name for cls, name in kinds if isinstance(error, cls)), "failed")
        return _failed(kind, str(error))
    except SystemExit as error:  # of code that no component's call is around
        said = f"a component ended the search: {describe(error)}; {REPORT}"
        return _failed("plugin error", said)
    except FAULTS as error:
        return _failed("failed", f"internal error: {describe(error)}")
    evaluation = result.evaluation
    return {
        "kind": "ok",
        "files": [os.fspath(file) for file in files],
        "cost": evaluation.cost.value,
        "parts": [name for name in result.problem.labels if name not in evaluation.empty],
        "warnings": [*read.notes, *result.warnings],
    }


def _solved(shape: Shape, ready: Prepared, outputs: Sequence[Path]) -> Result:
    """Check what can be checked before the search, and search."""
    given = ready.instructions
    problem = ready.smallest.problem
    problem.check(problem.embed(searched_part(shape, given.options)))
    if given.clip:
        check_clippable(shape)
    for output in outputs:
        if is_for_parts(output):
            check_part_form(output, shape, given.form)
        else:
            check_writable(output.suffix, shape)
    start = None
    if given.start_from is not None:
        start = align(given.start_from.template(), shape, problem)
    with limiting_calls(given.term_timeout):
        if ready.variants is not None:
            result = solve_variants(
                shape, ready.variants, given.options, start=start, report=never_stop
            )
        else:
            assert given.n_parts is not None  # or there would be variants
            result = solve_parts(
                shape, given.statement, given.n_parts, given.options, report=never_stop
            )
    return clip(result) if given.clip else result


def _written(result: Result, outputs: Sequence[Path], shape: Path, ready: Prepared) -> list[Path]:
    """Make all files, then write them, the first output's last."""
    form = ready.instructions.form
    files: dict[Path, bytes] = {}
    for output in reversed(outputs):
        if is_for_parts(output):
            files |= part_files(result, output, form)[0]
        else:
            files |= files_of(result, output, hull_vertices=form.hull_vertices)
    for file in files:
        if file.exists() and shape.exists() and file.samefile(shape):
            raise UsageError(f"an output comes with '{file}', which is the shape itself")
    write_files(files)
    return [outputs[0], *(file for file in files if file != outputs[0])]


def _for_want_of_memory(error: BaseException) -> bool:
    """Whether an error was raised from one about memory."""
    cause: BaseException | None = error
    for _ in range(10):
        if cause is None:
            return False
        if isinstance(cause, MemoryError):
            return True
        cause = cause.__cause__ or cause.__context__
    return False


def _failed(kind: str, message: str) -> dict[str, Any]:
    return {"kind": kind, "message": message}
