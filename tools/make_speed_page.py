"""Make docs/speed.md, and its plot, of what the benchmark of record has measured.

    python benchmarks/speed.py MESH --peers PYTHON --json first.json
    python benchmarks/speed.py MESH --peers PYTHON --json second.json
    python tools/make_speed_page.py first.json second.json

Of two runs of the same on the same machine the page has both figures side by side, which shows how
much they vary; one is enough. The plot (``tools/growth_plot.py``) is of the first.
"""

from __future__ import annotations

import argparse
import json
import sys
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
from tools.growth_plot import growth_plot, meshes

ROOT = Path(__file__).parents[1]
PAGE, PLOT = ROOT / "docs" / "speed.md", ROOT / "docs" / "images" / "growth.svg"

Run = Mapping[str, Any]
"""What ``benchmarks/speed.py --json`` writes."""

UNITS = {"us": "µs", "cost": "", ": 1": ": 1", "faces": ""}

#: The lines of the first table: job, how the name of a record begins or ends, and a title.
HEADLINES = (
    ("record", "paper_horse: seconds", "{mesh}, recipe `paper_horse`, everything"),
    ("record", "paper_horse: final cost", "its final cost, seeds 0 and on"),
    ("peers", "moseg : CoACD", "moseg : CoACD on the same mesh"),
    ("peers", "moseg : V-HACD", "moseg : V-HACD on the same mesh"),
    ("peers", "moseg : MeshLib", "moseg : MeshLib on the same mesh"),
    ("learned", "fourleg: seconds", "{mesh}, learned recipe `fourleg`, everything"),
    ("growth", "{largest}: seconds", "hammer of {largest} faces, read to written"),
    ("growth", "{largest}: memory", "its memory"),
    ("growth", "search, ", "its search : that of a hammer of {smallest} faces"),
    ("small", "over its search", "a small shape of 100, over its search"),
    ("small", "alone in a process", "a small shape alone, everything"),
    ("start", "less its search", "start, reading and writing of a run"),
    ("start", "moseg --help", "`moseg --help`"),
    ("literal", "literal : moseg", "literal implementation : `--settings paper`, per evaluation"),
    (
        "literal",
        "mirror images left out",
        "the same without the literal distances to mirror images",
    ),
)

INTRODUCTION = """\
# Speed

How long moseg takes, as `benchmarks/speed.py` has measured it and `tools/make_speed_page.py` has
written it down.

{measured}

{reading}

To measure again, on a quiet machine, with CoACD, V-HACD and MeshLib in an interpreter of their own:

```
python benchmarks/speed.py MESH --peers PYTHON --json first.json
python tools/make_speed_page.py first.json
```
"""

READING = """\
How to read it: timings depend on the machine, and on what else it does. On the same machine the
same run may well take a fifth longer an hour later. So {figures}; what is compared was measured in
turn, and ratios are what to take along to another machine. Seconds are by the clock and of whole
processes unless said otherwise: from the start of the interpreter to its end, reading and writing
included. Memory is the most that a process, or all of a run's together, had at a time. Where "one
process" is said, the run was told `--workers 1` and its stages are those of `moseg segment
--profile`; elsewhere a run has as many processes as there are processors.
"""

MEDIANS = "Medians; where there are two, of the first run and of the second.\n"

GROWTH = """\
![Seconds and memory over the number of faces](images/growth.svg)

The surface is the same each time, its triangles cut up, so that only the number of elements grows.
"""


def page(runs: Sequence[Run], note: str = "") -> str:
    """The text of docs/speed.md.

    Parameters
    ----------
    runs : sequence of mapping
        One or two.
    note : str
        What readers should know of these figures.
    """
    heads = ["median (least to greatest)"]
    if len(runs) > 1:
        heads = ["first run", "second run"]
    text = [
        INTRODUCTION.format(
            measured=_filled(f"{_measured(runs[0])} {note}".rstrip()),
            reading=_filled(READING.format(figures=_figures(runs))),
        ),
        "## In short\n",
        _table(["", *heads], _headlines(runs)),
    ]
    for job, summary in runs[0]["jobs"].items():
        if not _of(runs[0], job):
            continue
        text.append(f"## {job}\n\n{summary}\n")
        if job == "growth":
            text += [GROWTH, _growth(runs)]
        elif job == "objectives":
            text.append(_objectives(runs))
        else:
            text.append(_table([job, *heads], ([what, *cells] for what, cells in _rows(runs, job))))
    return "\n".join(text)


def _filled(text: str) -> str:
    """A paragraph in lines of 100."""
    return textwrap.fill(text, 100, break_on_hyphens=False)


def _figures(runs: Sequence[Run]) -> str:
    """What each figure is."""
    repeat = runs[0]["repeat"]
    often = f"the median of {repeat}, with the least and greatest behind it"
    once = f"a figure is {often if repeat > 1 else 'of a single measurement'}"
    if len(runs) == 1:
        return once
    again = runs[1]["repeat"]
    return f"{once}; what has a second column was run again, {again} times each"


def _measured(run: Run) -> str:
    """On what."""
    machine, mesh = run["machine"], run["mesh"]
    packages = ", ".join(f"{name} {version}" for name, version in machine["packages"].items())
    memory = f"{machine['memory']:.0f} GB of memory"
    return (
        f"Measured on {machine['day']}: {machine['processor']}, {machine['cores']} cores, {memory},"
        f" {machine['system']}, Python {machine['python']}; {packages}; commit"
        f" `{machine['commit']}`. The mesh is {mesh['name']}, of {mesh['elements']:,} faces, unless"
        " another is named."
    )


def _of(run: Run, job: str) -> dict[str, Mapping[str, Any]]:
    """The records of a job, by what was measured."""
    return {record["what"]: record for record in run["records"] if record["job"] == job}


def _rows(runs: Sequence[Run], job: str) -> list[tuple[str, list[str]]]:
    """Of each record of a job what it is, and a cell for each run."""
    found = [_of(run, job) for run in runs]
    return [(what, [_cell(records.get(what)) for records in found]) for what in found[0]]


def _headlines(runs: Sequence[Run]) -> Iterable[list[str]]:
    sizes = meshes(runs[0])
    names = {
        "mesh": runs[0]["mesh"]["name"],
        "largest": str(sizes[-1]) if sizes else "",
        "smallest": str(sizes[0]) if sizes else "",
    }
    for job, asked, title in HEADLINES:
        wanted = asked.format(**names)
        for what, cells in _rows(runs, job):
            if what.startswith(wanted) or what.endswith(wanted):
                yield [title.format(**names), *cells]
                break


def _growth(runs: Sequence[Run]) -> str:
    """A column for each mesh, a line for each thing measured."""
    sizes = meshes(runs[0])
    found = [_of(run, "growth") for run in runs]
    first = f"{sizes[0]}"
    lines = []
    for what in found[0]:
        kind = what.removeprefix(first)
        if kind == what or kind == ": faces":
            continue
        cells = []
        for size in sizes:
            medians = [_number(records.get(f"{size}{kind}")) for records in found]
            cells.append(" / ".join(medians))
        lines.append([kind.lstrip(":, "), *cells])
    ratios = [[what, *cells] for what, cells in _rows(runs, "growth") if not what[0].isdigit()]
    heads = ["first run", "second run"][: len(runs)] if len(runs) > 1 else ["median"]
    columns = ["", *(f"{size:,} faces" for size in sizes)]
    return "\n".join([MEDIANS, _table(columns, lines), _table(["ratio", *heads], ratios)])


def _objectives(runs: Sequence[Run]) -> str:
    """A line for each objective and measure, with its vectorised form beside it."""
    lines, joined = [], ", all parts at once"
    found = [_of(run, "objectives") for run in runs]
    for what in found[0]:
        if not what.endswith(joined):
            single = " / ".join(_number(records.get(what)) for records in found)
            many = " / ".join(_number(records.get(what + joined)) for records in found)
            lines.append([what, single, many if many.strip(" /") else ""])
    return f"{MEDIANS}\n{_table(['', 'a call', 'a call of many made at once'], lines)}"


def _cell(record: Mapping[str, Any] | None) -> str:
    """A median with its unit and range."""
    if record is None:
        return ""
    least, greatest = _rounded(record["least"]), _rounded(record["greatest"])
    spread = f" ({least} to {greatest})" if least != greatest else ""
    return f"{_number(record)}{spread}"


def _number(record: Mapping[str, Any] | None) -> str:
    """A median with its unit."""
    if record is None:
        return ""
    unit = UNITS.get(record["unit"], record["unit"])
    digits = f"{record['median']:.6g}" if record["unit"] == "cost" else _rounded(record["median"])
    return f"{digits} {unit}".rstrip()


def _rounded(value: float) -> str:
    """Three digits, without an exponent.

    Examples
    --------
    >>> [_rounded(value) for value in (12345.6, 0.01234, 7.0, 99.96)]
    ['12,346', '0.0123', '7.00', '100']
    """
    if abs(value) >= 99.95:
        return f"{value:,.0f}"
    if value == 0.0:
        return "0"
    places = 2 if abs(value) >= 1.0 else 3 - int(f"{value:.2e}".partition("e")[2]) - 1
    return f"{value:.{1 if abs(value) >= 9.995 else places}f}"


def _table(heads: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A table in Markdown; numbers stand to the right."""
    rule = ["---", *["---:"] * (len(heads) - 1)]
    rows = [heads, rule, *lines]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows) + "\n"


def main() -> None:
    """Write the page and its plot."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", nargs="+", type=Path, metavar="RUN.json", help="one or two")
    parser.add_argument("--note", default="", help="a sentence for readers of these figures")
    asked = parser.parse_args()
    runs = [json.loads(path.read_text()) for path in asked.runs[:2]]
    PAGE.write_text(page(runs, asked.note))
    if meshes(runs[0]):
        PLOT.write_bytes(growth_plot(runs[0]))


if __name__ == "__main__":
    main()
