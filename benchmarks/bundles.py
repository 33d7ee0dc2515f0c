"""What many installed bundles add to ``moseg plugin list``.

    python benchmarks/bundles.py [REPEAT]

Writes 3 and 50 small distributions, each a bundle of two objectives and a measure, into folders on
``PYTHONPATH`` and lists them in fresh processes, in turns. Medians, their difference and ratio are
printed, of the wall time, which is what a user with many bundles waits for, and of the processor
time, which others on the machine have less to do with.
"""

from __future__ import annotations

import compileall
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

FEW, MANY = 3, 50

BUNDLE = '''"""A bundle of the benchmark."""

from moseg_core import MeasureSpec, ObjectiveSpec, hookimpl

moseg_contract = 1


@hookimpl
def moseg_objectives():
    return [
        ObjectiveSpec(name="first", target="{name}.parts:first", summary="one part: the first"),
        ObjectiveSpec(name="second", target="{name}.parts:second", summary="one part: the second"),
    ]


@hookimpl
def moseg_measures():
    return [MeasureSpec(name="girth", target="{name}.parts:girth")]
'''


def install(folder: Path, count: int) -> None:
    """Write so many distributions, as an installer would leave them."""
    for k in range(count):
        name = f"moseg_made_up_{k}"
        package = folder / name
        package.mkdir(parents=True)
        (package / "__init__.py").write_text("")
        (package / "plugin.py").write_text(BUNDLE.format(name=name))
        info = folder / f"{name}-1.0.dist-info"
        info.mkdir()
        header = f"Metadata-Version: 2.1\nName: {name.replace('_', '-')}\nVersion: 1.0\n"
        (info / "METADATA").write_text(header)
        (info / "entry_points.txt").write_text(f"[moseg]\nmade_up_{k} = {name}.plugin\n")


def seconds(folder: Path) -> tuple[float, float]:
    """Wall and processor time of one listing in a fresh process."""
    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, "-m", "moseg_core", "plugin", "list"],
        env=os.environ | {"PYTHONPATH": str(folder)},
        stdout=subprocess.DEVNULL,
        check=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - start, used


def main() -> None:
    """Print medians, difference and ratio."""
    repeat = int(sys.argv[1]) if len(sys.argv) > 1 else 15
    with tempfile.TemporaryDirectory() as temporary:
        folders = {count: Path(temporary) / str(count) for count in (FEW, MANY)}
        times: dict[int, list[tuple[float, float]]] = {FEW: [], MANY: []}
        for count, folder in folders.items():
            install(folder, count)
            compileall.compile_dir(folder, quiet=1)
            seconds(folder)
        for _ in range(repeat):
            for count, folder in folders.items():
                times[count].append(seconds(folder))
    for k, what in enumerate(("wall", "processor")):
        few, many = (1e3 * statistics.median(t[k] for t in times[count]) for count in (FEW, MANY))
        print(
            f"moseg plugin list, {what} time, medians: {few:.1f} ms with {FEW} more bundles,"
            f" {many:.1f} ms with {MANY}; {MANY - FEW} add {many - few:.1f} ms"
            f" (ratio {many / few:.2f})"
        )


if __name__ == "__main__":
    main()
