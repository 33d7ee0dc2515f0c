"""The driver of a batch: hands out jobs, few at a time, and writes down what becomes of them.

Jobs go to an executor, which is all that is known of where they are done: by default a thread for
each worker, with a guarded child each (:mod:`moseg_core.batching.running`); any other
``concurrent.futures.Executor`` takes the same jobs to other processes or machines. The driver
alone writes the ledger. It can be killed at any moment, and whoever resumes does what is missing.

What would be wrong with every shape is refused before the first is begun.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from moseg_core.batching.handing_out import REPORT_EVERY, HandedOut
from moseg_core.batching.instructions import EarlierResult, Instructions
from moseg_core.batching.jobs import (
    PLACE,
    Job,
    check_outputs,
    expand_shapes,
    job_key,
    shape_names,
)
from moseg_core.batching.ledger import Ledger
from moseg_core.batching.leftovers import take_away_leftovers
from moseg_core.batching.outcome import BatchProgress, BatchResult, Outcome
from moseg_core.batching.report.making import describing_job, make_page
from moseg_core.batching.running import EndedError, close_children, forget_children
from moseg_core.batching.versions import own_versions
from moseg_core.errors import MosegError, UsageError
from moseg_core.io.files import check_form
from moseg_core.io.part_files import PartForm
from moseg_core.io.reading import Reading
from moseg_core.problem.recipe import Recipe, load_recipe
from moseg_core.problem.settings import SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.shape.row_threads import available_processors

BatchReport = Callable[[BatchProgress], bool]
"""Receives progress; ends the batch, when what is under way is done, by returning True."""

#: How often a job is handed out whose worker is lost with it.
_MOST_HAND_OUTS = 4
#: Bytes below which no process of moseg starts.
_LEAST_MEMORY = 500e6


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What each shape may take.

    Parameters
    ----------
    timeout : float or None
        Seconds.
    memory : float or None
        GB, of 1e9 bytes.

    Raises
    ------
    UsageError
        A limit that makes no sense.
    """

    timeout: float | None = None
    memory: float | None = None

    def __post_init__(self) -> None:
        for name, value in (("timeout", self.timeout), ("memory", self.memory)):
            if value is not None and (
                isinstance(value, bool)
                or not isinstance(value, int | float)
                or not 0 < value < float("inf")
            ):
                raise UsageError(f"the {name} must be a positive number, not {value!r}")
        if self.memory is not None and self.memory * 1e9 < _LEAST_MEMORY:
            raise UsageError(
                f"a memory of {self.memory:g} GB is too little for any shape; give"
                f" {_LEAST_MEMORY / 1e9:g} or more"
            )


def batch(
    shapes: Iterable[str | os.PathLike[str]],
    recipe: str | Recipe | Statement,
    folder: str | os.PathLike[str],
    *,
    n_parts: int | str | None = None,
    options: SearchOptions | None = None,
    reading: Reading | None = None,
    outputs: Sequence[str | os.PathLike[str]] = (),
    clip: bool = False,
    close: bool = False,
    hulls: bool = False,
    hull_vertices: int | None = None,
    start_from: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    timeout: float | None = None,
    memory: float | None = None,
    term_timeout: float | None = None,
    resume: bool = False,
    retry_failed: bool = False,
    executor: Executor | None = None,
    report: BatchReport | None = None,
    page: bool = False,
) -> BatchResult:
    """Segment many shapes, each in a guarded process; what goes wrong with one harms no other.

    Parameters
    ----------
    shapes : iterable of path-like
        Files, and patterns such as ``"models/*.off"``.
    recipe : str, Recipe or Statement
        What to look for in each: a recipe's name or path, a recipe, or a statement. All shapes have
        their parts named alike.
    folder : path-like
        Where results (``.json``) and the ledger (``batch.jsonl``) are written; made where it lacks.
    n_parts : int, "auto" or None
        How many parts there are, for a recipe that leaves their number open.
    options : SearchOptions, optional
        How to search. Each search is done by one process.
    reading : Reading, optional
        How to read the shapes.
    outputs : sequence of path-like
        Further files for each shape, with ``{shape}`` in their paths: ``"out/{shape}.glb"``,
        ``"out/{shape}/{part}.stl"``.
    clip : bool
        Whether boundaries are clipped (:func:`moseg_core.clip`).
    close, hulls, hull_vertices
        As for :func:`moseg_core.save`.
    start_from : path-like, optional
        A saved result (.json) of another shape, which is laid onto each (:func:`moseg_core.align`):
        searches start from there, and parts are called as there.
    workers : int, optional
        How many shapes are segmented at a time; as many as there are processors by default.
    timeout : float, optional
        Seconds that a shape may take; to compile kernels once is not counted.
    memory : float, optional
        GB (1e9 bytes) that a shape may take.
    term_timeout : float, optional
        Seconds that a call of an objective may take.
    resume : bool
        Go on with the batch in the folder: do what is missing or has changed.
    retry_failed : bool
        The same, and do again what has failed.
    executor : concurrent.futures.Executor, optional
        Where to do the jobs instead of on this machine; all of its workers see the same files.
        `workers` says how many it has.
    report : callable, optional
        Receives a :class:`moseg_core.BatchProgress` several times a second. Returning True, it ends
        the batch: no shape is begun any more, and those at work are finished.
    page : bool
        Whether to write ``report.html`` into the folder when all is done: a picture of each result,
        its cost, and how unlike the others it is, outliers first.

    Returns
    -------
    BatchResult

    Raises
    ------
    UsageError
        What would be wrong with every shape; two shapes whose results would have one name; a folder
        with another batch's ledger; other versions where a job was done.
    MosegError
        The ledger cannot be written, or no process be started.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> done = moseg.batch(["models/*.off"], "fourleg", "out", timeout=60)  # doctest: +SKIP
    >>> done.counts  # doctest: +SKIP
    {'ok': 198, 'bad shape': 2}
    """
    if isinstance(recipe, str):
        recipe = load_recipe(recipe)
    statement = recipe.statement if isinstance(recipe, Recipe) else recipe
    if not isinstance(statement, Statement):
        raise UsageError(f"batch takes a Recipe or a Statement, not {recipe!r:.60}")
    return run_batch(
        shapes,
        Instructions(
            statement=statement,
            n_parts=n_parts,
            options=options or SearchOptions(),
            reading=reading or Reading(),
            clip=clip,
            form=PartForm(close=close, hulls=hulls, hull_vertices=hull_vertices),
            start_from=None if start_from is None else EarlierResult.at(Path(start_from)),
            term_timeout=term_timeout,
        ),
        Path(folder),
        templates=[os.fspath(output) for output in outputs],
        limits=Limits(timeout=timeout, memory=memory),
        workers=workers,
        resume=resume or retry_failed,
        retry_failed=retry_failed,
        executor=executor,
        report=report or (lambda progress: False),
        page=page,
    )


def run_batch(
    shapes: Iterable[str | os.PathLike[str]],
    instructions: Instructions,
    folder: Path,
    *,
    templates: Sequence[str],
    limits: Limits,
    workers: int | None,
    resume: bool,
    retry_failed: bool,
    executor: Executor | None,
    report: BatchReport,
    page: bool = False,
) -> BatchResult:
    """The same as :func:`batch`, with what is to be done in one piece."""
    if not hasattr(os, "killpg"):
        raise UsageError("a batch guards its processes by means of POSIX, which this system lacks")
    count = available_processors() if workers is None else workers
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise UsageError(f"the number of workers must be a whole number from 1 on, not {workers!r}")
    instructions.check()
    paths = expand_shapes(shapes)
    names = shape_names(paths)
    made = make_folder(folder)
    try:
        check_outputs(folder, templates, paths, names)
        check_form(
            instructions.form,
            [Path(template.replace(PLACE, names[0])) for template in templates],
        )
    except MosegError:
        if made:
            folder.rmdir()
        raise
    with Ledger(folder, resume=resume) as ledger:
        take_away_leftovers(folder, templates, names)
        jobs = _jobs(paths, names, instructions, folder, templates, limits)
        with _executor(executor, count) as pool:
            handed_out = HandedOut(pool, count)
            run = _Run(
                ledger=ledger,
                folder=folder,
                total=len(paths),
                handed_out=handed_out,
                report=report,
            )
            run.carry_out(jobs, retry_failed=retry_failed)
            outcomes = {path: run.outcomes[path] for path in paths if path in run.outcomes}
            result = BatchResult(
                folder=folder, outcomes=outcomes, total=len(paths), stopped=run.stopped
            )
            if page and not run.stopped:
                name_of = dict(zip(paths, names, strict=True))
                drawn = {
                    shape: describing_job(run.jobs[shape], name_of[shape])
                    for shape, outcome in outcomes.items()
                    if outcome.ok
                }
                result = replace(result, page=make_page(result, drawn, handed_out, report))
    return result


def make_folder(folder: Path) -> bool:
    """Make the folder of a batch where it lacks; whether it lacked.

    Raises
    ------
    UsageError
        It is a file, its own folder does not exist, or it cannot be made.
    """
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"'{folder}' is a file; give a folder for the results")
    if not folder.parent.is_dir():
        raise UsageError(f"'{folder}': there is no folder '{folder.parent}'")
    try:
        folder.mkdir()
    except FileExistsError:
        return False
    except OSError as error:
        raise UsageError(f"'{folder}' cannot be made: {error.strerror}") from error
    return True


class _Run:
    """A batch under way."""

    def __init__(
        self,
        *,
        ledger: Ledger,
        folder: Path,
        total: int,
        handed_out: HandedOut,
        report: BatchReport,
    ) -> None:
        self.outcomes: dict[str, Outcome] = {}
        self.jobs: dict[str, Job] = {}
        self.stopped = False
        self._ledger, self._folder, self._total, self._report = ledger, folder, total, report
        self._counts: dict[str, int] = {}
        self._kept = 0
        self._began = time.monotonic()
        self._handed_out = handed_out
        self._hand_outs: dict[str, int] = {}
        self._news: list[Outcome] = []
        self._told = self._began

    def carry_out(self, jobs: Iterator[Job], *, retry_failed: bool) -> None:
        """Hand out jobs until all are done or somebody asks to stop."""
        again: list[Job] = []
        self._report_and_heed()
        with self._handed_out:
            while True:
                while not self.stopped and self._handed_out.has_room:
                    job = again.pop() if again else next(jobs, None)
                    if job is None:
                        break
                    self.jobs[job.shape] = job
                    if not self._is_done(job, retry_failed=retry_failed):
                        self._handed_out.add(job)
                    elif time.monotonic() - self._told >= REPORT_EVERY:
                        self._report_and_heed()
                if not self._handed_out:
                    self._tell()
                    return
                for job, future in self._handed_out.take_done():
                    again += self._finished(job, future)
                self._report_and_heed()

    def _is_done(self, job: Job, *, retry_failed: bool) -> bool:
        """Whether there is nothing to do for a job, because an earlier run has done it."""
        before = self._ledger.by_key.get(job.key)
        if before is None or self._hand_outs.get(job.key):
            return False
        if before.ok:
            kept = before.files and all((self._folder / file).is_file() for file in before.files)
        else:
            kept = not retry_failed
        if kept:
            self.outcomes[job.shape] = before
            self._kept += 1
            self._news.append(before)
        return bool(kept)

    def _finished(self, job: Job, future: Future[Outcome]) -> list[Job]:
        """Write down what a job came to; jobs that are to be handed out once more."""
        try:
            outcome = future.result()
        except UsageError:  # of all jobs: other versions over there
            raise
        except (Exception, CancelledError) as error:  # whatever kind an executor has for it
            if isinstance(error, MosegError) and not isinstance(error, EndedError):
                raise
            tried = self._hand_outs.get(job.key, 1)
            if tried < _MOST_HAND_OUTS:
                self._hand_outs[job.key] = tried + 1
                return [job]
            outcome = Outcome(
                shape=job.shape,
                key=job.key,
                kind="crashed",
                message=f"the worker that had it was lost {tried} times"
                f" ({type(error).__name__}: {' '.join(str(error).split())[:200]})",
            )
        if outcome.ok and not all((self._folder / file).is_file() for file in outcome.files):
            outcome = replace(
                outcome,
                kind="failed",
                message=f"its files are not in '{self._folder}', though they were written where the"
                " job was done; all workers of a batch have to see the same files",
                files=(),
            )
        self._ledger.add(outcome)
        self.outcomes[outcome.shape] = outcome
        self._news.append(outcome)
        self._counts[outcome.kind] = self._counts.get(outcome.kind, 0) + 1
        return []

    def _report_and_heed(self) -> None:
        """Report; asked to stop, take back what was handed out and not begun."""
        if self._tell() and not self.stopped:
            self.stopped = True
            self._handed_out.take_back()

    def _tell(self) -> bool:
        """Report, and whether to stop."""
        progress = BatchProgress(
            total=self._total,
            kept=self._kept,
            counts=dict(self._counts),
            at_work=self._handed_out.shapes,
            seconds=time.monotonic() - self._began,
            news=tuple(self._news),
        )
        self._news, self._told = [], time.monotonic()
        return bool(self._report(progress))


def _jobs(
    paths: Sequence[str],
    names: Sequence[str],
    instructions: Instructions,
    folder: Path,
    templates: Sequence[str],
    limits: Limits,
) -> Iterator[Job]:
    """The job of each shape; a shape's file is looked at when its turn comes."""
    whole = os.path.abspath(folder)
    text, components, here = instructions.text(), instructions.components(), os.getcwd()
    common = Job(
        shape="",
        here=here,
        folder=whole,
        outputs=(),
        instructions=text,
        key="",
        seed=instructions.options.seed,
        versions=own_versions(),
        timeout=limits.timeout,
        memory=None if limits.memory is None else limits.memory * 1e9,
    )
    for path, name in zip(paths, names, strict=True):
        asked = [
            os.path.join(whole, f"{name}.json"),
            *(os.path.abspath(template.replace(PLACE, name)) for template in templates),
        ]
        relative = [os.path.relpath(output, whole) for output in asked]
        key = job_key(path, relative, text, components)
        yield replace(common, shape=path, outputs=tuple(asked), key=key)


@contextmanager
def _executor(given: Executor | None, count: int) -> Iterator[Executor]:
    """The executor that was given; or threads with a guarded child each, gone at the end."""
    if given is not None:
        yield given
        return
    threads: list[int] = []

    def begin() -> None:
        threads.append(threading.get_ident())

    pool = ThreadPoolExecutor(count, thread_name_prefix="moseg-batch", initializer=begin)
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        close_children(threads)
        pool.shutdown(wait=True)
        forget_children(threads)
