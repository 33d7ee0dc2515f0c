"""``moseg plot``: the convergence curves of a result (Fig. 6)."""

from __future__ import annotations

from pathlib import Path

from moseg_core.cli.console import message
from moseg_core.cli.saving import check_distinct
from moseg_core.errors import UsageError
from moseg_core.io import read_result, write_file
from moseg_core.io.whole_file import check_destination
from moseg_core.view.convergence import FORMATS, render_convergence


def run_plot(source: Path, out: Path) -> None:
    """Read the history of a result, and write it as a chart."""
    format = out.suffix.lower().removeprefix(".")
    if format not in FORMATS:
        asked = f"'{out.suffix}'" if out.suffix else "a file without a suffix"
        raise UsageError(f"a chart is written as .svg or .png, not {asked}")
    check_destination(out)
    check_distinct([out], read=[source], what="the chart")
    saved = read_result(source)
    title = f"{saved.shape.get('name', source.stem)}, cost {saved.evaluation.cost.value:.4g}"
    write_file(out, render_convergence(saved.history, format=format, title=title))
    message(f"wrote {out}")
