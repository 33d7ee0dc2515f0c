"""``moseg segment --profile``: where the time went, as tables on stderr."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from rich.table import Table

from moseg_core.cli.console import console
from moseg_core.components.profile import Entry, Profile, profiling


@contextmanager
def printing_profile() -> Iterator[None]:
    """Count what happens in this context, and print it at the end, also of a run that fails."""
    began = time.perf_counter()
    with profiling() as profile:
        try:
            yield
        finally:
            print_profile(profile, time.perf_counter() - began)


def print_profile(profile: Profile, total: float) -> None:
    """Print seconds by stage, by term and component, and by bundle.

    Parameters
    ----------
    profile : Profile
    total : float
        Seconds of the whole run, which shares refer to.
    """
    out = console(sys.stderr)
    stages = [(name, "", entry) for name, _, entry in profile.of("stage")]
    rest = Entry(1, total - sum(entry.seconds for _, _, entry in stages))
    asked = [*profile.of("term"), *profile.of("component")]
    asked.sort(key=lambda each: -each[2].seconds)
    sources = [(name, "", entry) for name, entry in profile.by_source().items()]
    for heading, rows in (
        ("stage", [*stages, ("rest", "", rest)]),
        ("term or component", asked),
        ("bundle", sources),
    ):
        out.print()
        out.print(_table(heading, rows, total))


def _table(heading: str, rows: Iterable[tuple[str, str, Entry]], total: float) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column(heading, overflow="fold")
    for column in ("seconds", "share", "calls", "us per call"):
        table.add_column(column, justify="right")
    shown = list(rows)
    if any(source for _, source, _ in shown):
        table.add_column("from")
    for name, source, entry in shown:
        table.add_row(
            name,
            f"{entry.seconds:.3f}",
            f"{entry.seconds / total:.1%}",
            str(entry.calls),
            f"{1e6 * entry.seconds / entry.calls:.0f}",
            *([source] if source else []),
        )
    return table
