"""The table on the page "What moseg promises": ``python -m tests.fuzz.page`` makes it anew."""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from tests.fuzz.children import Outcome, run
from tests.fuzz.everything import all_cases
from tests.fuzz.table import by, fallen_short, markdown

PAGE = Path(__file__).parents[2] / "docs" / "promises.md"
_BETWEEN = "<!-- {key}: made by 'make fuzz-page' -->\n\n", "\n\n<!-- end of {key} -->"


def page_with(outcomes: Iterable[Outcome]) -> str:
    """The page with the tables of these outcomes."""
    page, outcomes = PAGE.read_text(encoding="utf-8"), list(outcomes)
    for key in ("format", "kind"):
        first, last = (mark.format(key=key) for mark in _BETWEEN)
        before, found, rest = page.partition(first)
        _, also, after = rest.partition(last)
        if not (found and also):
            raise AssertionError(f"the page has no marks around the table of each {key}")
        page = before + first + markdown(by(outcomes, key), key) + last + after
    return page


def counted(key: str) -> Counter[str]:
    """How many files of each format or kind the page says there are."""
    first, last = (mark.format(key=key) for mark in _BETWEEN)
    table = PAGE.read_text(encoding="utf-8").partition(first)[2].partition(last)[0]
    rows = re.findall(r"^\| ([^|]+) \| (\d+) \|", table, re.MULTILINE)
    return Counter({"" if name == "all" else name: int(number) for name, number in rows})


if __name__ == "__main__":
    found = run(all_cases())
    for outcome in fallen_short(found):
        print(f"{outcome.case.key} | {outcome.verdict.outcome} | {outcome.verdict.said}")
    PAGE.write_text(page_with(found), encoding="utf-8")
    sys.exit(bool(fallen_short(found)))
