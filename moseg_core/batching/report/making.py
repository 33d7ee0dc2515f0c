"""From the results of a batch to its page: what has not been drawn yet is, then the page written.

Drawing and measuring are jobs as segmenting is, and go to the same executor; what fails there is a
card without a picture, and no shape's failure.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path

from moseg_core.batching.handing_out import HandedOut
from moseg_core.batching.jobs import Job
from moseg_core.batching.outcome import BatchProgress, BatchResult, Outcome
from moseg_core.batching.report.describing import (
    Description,
    description_files,
    read_description,
)
from moseg_core.batching.report.page import batch_page
from moseg_core.io.whole_file import write_file

PAGE = "report.html"
"""The page's file in the folder of a batch."""


def describing_job(solved: Job, name: str) -> Job:
    """The job of drawing and measuring what another has found.

    Parameters
    ----------
    solved : Job
        The one that found it.
    name : str
        The shape's, in the batch's folder.
    """
    files = description_files(Path(solved.folder), name)
    return replace(solved, task="describe", outputs=(solved.outputs[0], *map(os.fspath, files)))


def make_page(
    result: BatchResult,
    jobs: Mapping[str, Job],
    handed_out: HandedOut,
    report: Callable[[BatchProgress], bool],
) -> Path | None:
    """Draw and measure what lacks, and write the page.

    Parameters
    ----------
    result : BatchResult
    jobs : mapping of str to Job
        For each shape with a result, by its path, the job of :func:`describing_job`.
    handed_out : HandedOut
        What gives jobs to the executor; empty.
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
    waiting = [job for job in jobs.values() if _described(job) is None]
    if not _carry_out(waiting, handed_out, report):
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
    result, picture, measures = map(Path, job.outputs)
    return read_description(measures, result) if picture.is_file() else None


def _carry_out(
    jobs: Sequence[Job], handed_out: HandedOut, report: Callable[[BatchProgress], bool]
) -> bool:
    """Do the jobs; whether all were done. Asked to stop, those at work are finished."""
    began, done = time.monotonic(), 0
    failed: list[Outcome] = []
    stopped = False
    left = iter(jobs)
    with handed_out:
        while True:
            while not stopped and handed_out.has_room and (job := next(left, None)) is not None:
                handed_out.add(job)
            progress = BatchProgress(
                total=len(jobs),
                kept=0,
                counts={"drawn": done} if done else {},
                at_work=handed_out.shapes,
                seconds=time.monotonic() - began,
                news=tuple(failed),
            )
            failed = []
            if report(progress) and not stopped:
                stopped = True
                handed_out.take_back()
            if not handed_out:
                return not stopped
            for job, future in handed_out.take_done():
                done += 1
                failed += _without_picture(job, future)


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
