"""The table of outcomes: how many files of each format, or kind, ended how."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from tests.fuzz.case import Case
from tests.fuzz.children import Outcome
from tests.fuzz.verdict import BAD, GOOD

FILES, SHORT = "files", "falls short"
COLUMNS = (FILES, *GOOD, SHORT)

Table = dict[str, Counter[str]]


def by(outcomes: Iterable[Outcome], key: str) -> Table:
    """How many ended how, for each format or kind, and in all."""
    table: Table = {}
    for outcome in outcomes:
        ended = SHORT if outcome.verdict.outcome in BAD else outcome.verdict.outcome
        for row in (getattr(outcome.case, key), ""):
            table.setdefault(row, Counter()).update((FILES, ended))
    table[""] = table.pop("", Counter())
    return table


def counts(cases: Iterable[Case], key: str) -> Counter[str]:
    """How many cases there are of each format or kind, and in all."""
    found: Counter[str] = Counter()
    for case in cases:
        found.update((getattr(case, key), ""))
    return found


def fallen_short(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """What did not end well."""
    return [outcome for outcome in outcomes if outcome.verdict.outcome in BAD]


def text(table: Mapping[str, Counter[str]], key: str) -> str:
    """For a terminal, in columns."""
    rows = [[key, *COLUMNS]]
    rows += [[row or "all", *(str(n[c]) for c in COLUMNS)] for row, n in table.items()]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(_line(row, widths) for row in rows)


def _line(row: Sequence[str], widths: Sequence[int]) -> str:
    first, *rest = [
        cell.ljust(w) if k == 0 else cell.rjust(w)
        for k, (cell, w) in enumerate(zip(row, widths, strict=True))
    ]
    return "  ".join((first, *rest)).rstrip()


def markdown(table: Mapping[str, Counter[str]], key: str) -> str:
    """For a page."""
    lines = [f"| {key} | {' | '.join(COLUMNS)} |", f"|---|{'---:|' * len(COLUMNS)}"]
    lines += [
        f"| {row or 'all'} | {' | '.join(str(n[c]) for c in COLUMNS)} |" for row, n in table.items()
    ]
    return "\n".join(lines)
