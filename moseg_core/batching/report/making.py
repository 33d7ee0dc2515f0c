"""From the results of a batch to its page: what has not been drawn yet is, then the page written.

Drawing and measuring are jobs as segmenting is, and go to the same executor; what fails there is a
card without a picture, and no shape's failure.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import replace
from pathlib import Path

from moseg_core.batching.jobs import Job
from moseg_core.batching.outcome import BatchProgress, BatchResult, Outcome
from moseg_core.batching.report.describing import (
    Description,
    description_files,
    read_description,
)
from moseg_core.batching.report.page import batch_page
from moseg_core.batching.running import run_job
from moseg_core.io.whole_file import write_file

#: Seconds between two reports while nothing happens.
_REPORT_EVERY = 0.2

PAGE = "report.html"
"""The page's file in the folder of a batch."""


def describing_job(solved: Job, outcome: Outcome, name: str) -> Job:
    """The job of drawing and measuring what another has found.

    Parameters
    ----------
    solved : Job
        The one that found it.
    outcome : Outcome
        What it came to.
    name : str
        The shape's, in the batch's folder.
    """
    picture, measures = description_files(Path(solved.folder), name)
    return replace(
        solved,
        task="describe",
        outputs=(solved.outputs[0], os.fspath(picture), os.fspath(measures), outcome.key),
    )


def make_page(
    result: BatchResult,
    jobs: Mapping[str, Job],
    pool: Executor,
    most: int,
    report: Callable[[BatchProgress], bool],
) -> Path | None:
    """Draw and measure what lacks, and write the page.

    Parameters
    ----------
    result : BatchResult
    jobs : mapping of str to Job
        For each shape with a result, by its path, the job of :func:`describing_job`.
    pool : concurrent.futures.Executor
    most : int
        How many jobs are handed out at a time.
    report : callable
        Receives progress; True ends it, without a page.

    Returns
    -------
    Path or None
        The page; None where somebody asked to stop.

    Raises
    ------
    MosegError
        The page cannot be written.
    """
    waiting = [shape for shape, job in jobs.items() if _described(job) is None]
    if not _carry_out([jobs[shape] for shape in waiting], pool, most, report):
        return None
    found = {shape: _described(job) for shape, job in jobs.items()}
    descriptions = {shape: each for shape, each in found.items() if each is not None}
    pictures = {
        shape: Path(os.path.relpath(jobs[shape].outputs[1], jobs[shape].folder)).as_posix()
        for shape in descriptions
    }
    page = result.folder / PAGE
    write_file(page, batch_page(result, descriptions, pictures))
    return page


def _described(job: Job) -> Description | None:
    """The description that a job makes, where it is there."""
    _, picture, measures, key = job.outputs
    return read_description(Path(measures), key) if os.path.isfile(picture) else None


def _carry_out(
    jobs: Sequence[Job], pool: Executor, most: int, report: Callable[[BatchProgress], bool]
) -> bool:
    """Do the jobs, a few at a time; whether all were done.

    Asked to stop, those at work are finished.
    """
    began, done = time.monotonic(), 0
    failed: list[Outcome] = []
    stopped = False
    left, at_work = iter(jobs), dict[Future[Outcome], Job]()
    try:
        while True:
            while not stopped and len(at_work) < most and (job := next(left, None)) is not None:
                at_work[pool.submit(run_job, job)] = job
            progress = BatchProgress(
                total=len(jobs),
                kept=0,
                counts={"drawn": done} if done else {},
                at_work=tuple(job.shape for job in at_work.values()),
                seconds=time.monotonic() - began,
                news=tuple(failed),
            )
            failed = []
            if report(progress) and not stopped:
                stopped = True
                at_work = {f: job for f, job in at_work.items() if not f.cancel()}
            if not at_work:
                return not stopped
            for future in wait(at_work, _REPORT_EVERY, return_when=FIRST_COMPLETED).done:
                done += 1
                failed += _without_picture(at_work.pop(future), future)
    finally:
        for future in at_work:
            future.cancel()


def _without_picture(job: Job, future: Future[Outcome]) -> list[Outcome]:
    """What went wrong with drawing a result, which is there all the same; empty where nothing."""
    try:
        outcome = future.result()
    except Exception as error:  # noqa: BLE001  # whatever kind an executor has for it
        said = " ".join(str(error).split())[:200] or type(error).__name__
        outcome = Outcome(shape=job.shape, key=job.key, kind="failed", message=said)
    if outcome.ok:
        return []
    return [
        replace(outcome, message=f"it has no picture on the page, but a result: {outcome.message}")
    ]
