"""What a job of the benchmark is asked, and what it answers: records of repeated measurements.

A job is a function of a :class:`Request` that yields a :class:`Record` for each thing it has
measured, as soon as it has. The first line of its docstring says what it measures. A record keeps
all values; median, least and greatest come from them, so that whoever reads the figures sees how
much they vary.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is to be measured, and how often.

    Parameters
    ----------
    mesh : Path
        The mesh that most jobs are about.
    folder : Path
        For files that a job makes; empty, and deleted at the end.
    repeat : int
        How often each thing is measured, 1 or more.
    peers : str, optional
        An interpreter that has other programs' packages.
    """

    mesh: Path
    folder: Path
    repeat: int = 5
    peers: str | None = None


@dataclass(frozen=True, kw_only=True)
class Record:
    """One thing that was measured, once or several times.

    Parameters
    ----------
    job : str
    what : str
        Unique within the job.
    unit : str
        "s", "ms", "us" (microseconds), "GB" (1e9 bytes), "cost", ": 1" (a ratio), "faces",
        "a minute".
    runs : tuple of float
        At least one, in the order in which they were measured.
    """

    job: str
    what: str
    unit: str
    runs: tuple[float, ...]

    @property
    def median(self) -> float:
        """The median of all runs."""
        return statistics.median(self.runs)

    def document(self) -> dict[str, Any]:
        """The record as JSON has it."""
        return {
            "job": self.job,
            "what": self.what,
            "unit": self.unit,
            "median": self.median,
            "least": min(self.runs),
            "greatest": max(self.runs),
            "runs": list(self.runs),
        }


Job = Callable[[Request], Iterator[Record]]


def repeated(
    function: Callable[[], object],
    repeat: int,
    *,
    scale: float = 1.0,
    clock: Callable[[], float] = time.perf_counter,
) -> tuple[float, ...]:
    """How long a call takes each time, in seconds times `scale`, after one call to warm up."""
    function()
    (times,) = alternating([function], repeat, scale=scale, clock=clock)
    return times


def alternating(
    calls: Sequence[Callable[[], object]],
    repeat: int,
    *,
    scale: float = 1.0,
    clock: Callable[[], float] = time.perf_counter,
) -> list[tuple[float, ...]]:
    """For each of some calls how long it takes each time; they are made in turn.

    What else the machine does then falls on all of them alike.
    """
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(repeat):
        for mine, call in zip(times, calls, strict=True):
            start = clock()
            call()
            mine.append(scale * (clock() - start))
    return [tuple(mine) for mine in times]


def quotients(over: Sequence[float], under: Sequence[float]) -> tuple[float, ...]:
    """Ratios run by run of two things that were measured in turn."""
    return tuple(a / b for a, b in zip(over, under, strict=True))
