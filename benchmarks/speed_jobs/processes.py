"""Measurements of whole processes: a command line, or moseg's by its stages.

Everything is counted that a user waits for, from the start of the interpreter to its end. Files
that a run writes go into the folder of the request.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from speed_jobs.records import Record, Request

HERE = Path(__file__).parent
MOSEG = str(Path(sys.executable).with_name("moseg"))
"""The command, as it is installed beside this interpreter."""

SEARCH = (
    *("fields", "super-elements", "seeds and labels", "search", "exchange of labels"),
    *("polish", "refine"),
)
"""The stages that are a search; the others are the start, reading and writing."""


@dataclass(frozen=True, kw_only=True)
class Used:
    """What a process has used.

    Parameters
    ----------
    wall, cpu : float
        Seconds, by the clock and by the processor, its children's included.
    memory : float
        1e9 bytes at the most.
    """

    wall: float
    cpu: float
    memory: float


def run(
    command: Sequence[str], request: Request, *, environment: Mapping[str, str] | None = None
) -> Used:
    """Run a command to its end, and say what it has used.

    Raises
    ------
    RuntimeError
        It fails; its last words are in the message.
    """
    report = request.folder / "used.json"
    watcher = [sys.executable, "-I", "-S", str(HERE / "watch.py"), str(report)]
    ended = subprocess.run(
        [*watcher, *command],
        env={**os.environ, **(environment or {})},
        capture_output=True,
        text=True,
        check=True,
    )
    used = json.loads(report.read_text())
    if used["code"]:
        said = ended.stderr.strip().splitlines() or ["nothing said"]
        raise RuntimeError(f"'{' '.join(command)}' ended with {used['code']}: {said[-1]}")
    return Used(wall=used["wall"], cpu=used["cpu"], memory=used["memory"] / 1e9)


def run_by_stage(
    commands: Sequence[Sequence[str]], request: Request
) -> tuple[Used, dict[str, float]]:
    """Run command lines of moseg in one process: what it has used, and seconds by stage.

    The stage "rest" is all that is none of the stages that moseg tells apart: starting the
    interpreter, imports, the report at the end.
    """
    report, listed = request.folder / "stages.json", request.folder / "commands.json"
    listed.write_text(json.dumps([[*command, "--workers", "1"] for command in commands]))
    program = [sys.executable, str(HERE / "profiled.py"), str(report), str(listed)]
    used = run(program, request)
    stages: dict[str, float] = json.loads(report.read_text())
    return used, {**stages, "rest": used.wall - sum(stages.values())}


def segmenting(mesh: Path, recipe: str, request: Request, *more: str) -> list[str]:
    """The arguments of a run that writes a result and a coloured mesh."""
    outputs = ["-o", str(request.folder / "result.json"), "-o", str(request.folder / "result.ply")]
    return ["segment", str(mesh), "--recipe", recipe, "--quiet", *outputs, *more]


def final_cost(request: Request) -> float:
    """The cost of the result that was written last."""
    cost: float = json.loads((request.folder / "result.json").read_text())["cost"]["value"]
    return cost


def used_records(job: str, what: str, runs: Sequence[Used]) -> Iterator[Record]:
    """Records of what runs of the same thing have used."""
    for title, unit, key in (
        ("seconds", "s", "wall"),
        ("processor seconds", "s", "cpu"),
        ("memory", "GB", "memory"),
    ):
        values = tuple(getattr(each, key) for each in runs)
        yield Record(job=job, what=f"{what}: {title}", unit=unit, runs=values)


def stage_records(job: str, what: str, runs: Sequence[Mapping[str, float]]) -> Iterator[Record]:
    """Records of the seconds by stage of runs of the same thing."""
    for stage in runs[0]:
        values = tuple(each.get(stage, 0.0) for each in runs)
        yield Record(job=job, what=f"{what}: {stage}", unit="s", runs=values)
