"""The benchmark of record: how fast moseg is, by job.

    python benchmarks/speed.py [MESH] [--json FILE] [--repeat 5] [--only JOB ...]
        [--peers PYTHON] [--list]

Most jobs are about the sample horse unless another mesh is given. Each thing is measured as often
as ``--repeat`` says, and what is compared is measured in turn; shown are the median, and the least
and greatest value. ``--peers`` names an interpreter that has coacd, vhacdx or meshlib, whose times
for the same mesh are then measured in the same run (``speed_jobs/peers.py``). All jobs together
take the better part of an hour; ``--list`` says what each measures.

Timings depend on the machine, and vary from hour to hour on the same: run it on a quiet machine,
compare ratios, and run it twice. ``tools/make_speed_page.py`` makes docs/speed.md of what
``--json`` has written.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from speed_jobs import JOBS
from speed_jobs.records import Job, Record, Request

import moseg_core as moseg

PACKAGES = ("moseg-core", "numpy", "scipy", "numba", "manifold3d")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the jobs that are asked for, and print and write what they found."""
    asked = read_arguments(arguments)
    if asked.list:
        for name, job in JOBS.items():
            print(f"{name:12s}{summary(job)}")
        return
    mesh, failed = asked.mesh or moseg.sample_path("horse"), []
    found = document(mesh, asked.repeat)
    for name in asked.only or JOBS:
        found["jobs"][name] = summary(JOBS[name])
        print(f"\n{name}: {summary(JOBS[name])}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            request = Request(
                mesh=mesh, folder=Path(folder), repeat=asked.repeat, peers=asked.peers
            )
            try:
                for record in JOBS[name](request):
                    print(line(record), flush=True)
                    found["records"].append(record.document())
                    if asked.json:  # each time, for a run that is ended early
                        asked.json.write_text(json.dumps(found, indent=1) + "\n")
            except (RuntimeError, AssertionError, moseg.MosegError) as error:
                print(f"  failed: {error}", flush=True)  # the other jobs may well be all right
                failed.append(name)
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")


def summary(job: Job) -> str:
    """What a job measures, in a line."""
    return (job.__doc__ or "").splitlines()[0]


def read_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The options of the command line."""
    parser = argparse.ArgumentParser(description="Measure how fast moseg is, by job.")
    parser.add_argument("mesh", nargs="?", type=Path, help="the sample horse by default")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all records")
    parser.add_argument("--repeat", type=int, default=5, help="how often each thing is measured")
    parser.add_argument("--only", nargs="+", choices=JOBS, metavar="JOB", help="see --list")
    parser.add_argument("--peers", metavar="PYTHON", help="an interpreter with other programs")
    parser.add_argument("--list", action="store_true", help="print the jobs and what they measure")
    asked = parser.parse_args(arguments)
    if asked.repeat < 1:
        parser.error("--repeat is 1 or more")
    return asked


def line(record: Record) -> str:
    """A record as a line: what, the median, and the range where there is one."""
    least, greatest = min(record.runs), max(record.runs)
    spread = f"   {least:.4g} to {greatest:.4g}" if least < greatest else ""
    return f"  {record.what:64s}{record.median:10.4g} {record.unit}{spread}"


def document(mesh: Path, repeat: int) -> dict[str, Any]:
    """What is known before anything is measured."""
    return {
        "machine": machine(),
        "mesh": {"name": mesh.stem, "elements": moseg.load(mesh).n_elements},
        "repeat": repeat,
        "jobs": {},
        "records": [],
    }


def machine() -> dict[str, Any]:
    """What the figures are of, as far as it can be found out."""
    return {
        "processor": processor(),
        "cores": moseg.available_workers(),
        "memory": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "packages": {name: version(name) for name in PACKAGES},
        "day": datetime.date.today().isoformat(),
        "commit": commit(),
    }


def processor() -> str:
    """The model of the processor."""
    listing = Path("/proc/cpuinfo")
    for row in listing.read_text().splitlines() if listing.exists() else ():
        if row.startswith("model name"):
            return row.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def commit() -> str:
    """The commit that is checked out, "" where nobody knows."""
    asked = ["git", "-C", str(Path(__file__).parent), "rev-parse", "--short", "HEAD"]
    try:
        return subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    except OSError:
        return ""


if __name__ == "__main__":
    main()
