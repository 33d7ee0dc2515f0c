r"""Measures of parts as a table, and the table as text for other programs.

One row for each part, one column for each measure: the form in which R, pandas and spreadsheets
take measurements, so that nothing has to be reshaped. What is known of a whole shape only stands in
columns of its own, whose names begin with ``shape_``, the same in all rows of the shape; rows of
another kind would have to be taken out before anything can be counted. What is measured, and in
which units, is the business of :mod:`moseg_core.search.part_measures`.

Text is written as RFC 4180 says: cells that hold a comma, a quote or a line break are quoted,
quotes are doubled, lines end with CR LF. Numbers have a point and as many digits as tell them from
their neighbours; what is not known is an empty cell. A spreadsheet takes a text that begins with
``=``, ``+``, ``-`` or ``@`` (or a tab, or a line break) for a formula, and labels come from files
of strangers: an apostrophe is put in front of such a text, as OWASP advises ("CSV Injection"),
by which spreadsheets know that it is a text. Numbers are numbers, also those below 0.
"""

from __future__ import annotations

import csv
import html
import io
import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

Cell = str | int | float | None
"""What stands in a row and column; None where it is not known."""

_LEADS_TO_FORMULAS = ("=", "+", "-", "@", "\t", "\r", "\n")
_OF_TERMS, OF_SHAPE = "term_", "shape_"


@dataclass(frozen=True, kw_only=True)
class PartTable:
    r"""What was measured of parts: a row for each, a column for each measure.

    Iterating gives a dict for each row; ``pandas.DataFrame(table.rows)`` is a data frame.

    Parameters
    ----------
    columns : tuple of str
        Names of the columns, each once.
    cells : tuple of tuple of str, int, float or None
        The rows, with as many cells as there are columns; None where something is not known.

    Examples
    --------
    >>> table = PartTable(columns=("part", "area"), cells=(("leg", 0.5), ("=1+1", None)))
    >>> table.rows[0]["area"], len(table)
    (0.5, 2)
    >>> print(table.to_csv().replace("\r\n", "\n"))
    part,area
    leg,0.5
    '=1+1,
    <BLANKLINE>
    """

    columns: tuple[str, ...]
    cells: tuple[tuple[Cell, ...], ...]

    @property
    def rows(self) -> list[dict[str, Cell]]:
        """A dict for each part, by column."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.cells]

    def __iter__(self) -> Iterator[dict[str, Cell]]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.cells)

    def __repr__(self) -> str:
        return f"PartTable({len(self)} parts, {len(self.columns)} columns)"

    @classmethod
    def of_rows(cls, rows: Iterable[dict[str, Cell]]) -> PartTable:
        """A table of rows that need not have the same columns.

        Parameters
        ----------
        rows : iterable of dict
            By column. What a row lacks is not known there; columns come in the order in which they
            are met, those of terms and of whole shapes behind the others.

        Examples
        --------
        >>> rows = [{"part": "a", "shape_cost": 1.0}, {"part": "b", "area": 2.0}]
        >>> PartTable.of_rows(rows).columns
        ('part', 'area', 'shape_cost')
        """
        kept = list(rows)
        met = dict.fromkeys(name for row in kept for name in row)
        columns = tuple(sorted(met, key=_rank))  # stable: within a rank as they were met
        cells = tuple(tuple(row.get(name) for name in columns) for row in kept)
        return cls(columns=columns, cells=cells)

    @classmethod
    def joined(cls, tables: Sequence[PartTable]) -> PartTable:
        """The rows of several tables, one table after the other, with the columns of all."""
        return cls.of_rows(row for table in tables for row in table)

    def with_column(self, name: str, value: Cell) -> PartTable:
        """The table with one more column at its front, the same in all rows."""
        return PartTable(
            columns=(name, *self.columns), cells=tuple((value, *row) for row in self.cells)
        )

    def to_csv(self, *, delimiter: str = ",") -> str:
        r"""The table as text with a line of names and a line for each row.

        Parameters
        ----------
        delimiter : str
            What stands between cells; ``"\t"`` for a ``.tsv`` file.

        Returns
        -------
        str
            Lines end with CR LF: write it to a file that is opened with ``newline=""``, or as
            bytes.
        """
        stream = io.StringIO(newline="")
        writer = csv.writer(stream, delimiter=delimiter, lineterminator="\r\n")
        writer.writerow([_as_text(name) for name in self.columns])
        writer.writerows([_in_csv(cell) for cell in row] for row in self.cells)
        return stream.getvalue()

    def to_json(self) -> str:
        """The table as a JSON array with an object for each row, a row on a line.

        ``pandas.read_json`` and ``jsonlite::fromJSON`` of R read it as a data frame.
        """
        lines = [
            json.dumps({name: _finite(cell) for name, cell in row.items()}, ensure_ascii=False)
            for row in self
        ]
        return "[\n" + ",\n".join(lines) + "\n]\n" if lines else "[]\n"

    def _repr_html_(self) -> str:
        """The table in a notebook."""
        head = "".join(f"<th>{html.escape(name)}</th>" for name in self.columns)
        rows = "".join(
            f"<tr>{''.join(f'<td>{html.escape(shown(cell))}</td>' for cell in row)}</tr>"
            for row in self.cells
        )
        return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


def shown(cell: Cell) -> str:
    """A cell for people: numbers with six digits, nothing where nothing is known.

    Examples
    --------
    >>> shown(0.123456789), shown(None), shown("leg")
    ('0.123457', '', 'leg')
    """
    if cell is None:
        return ""
    return f"{cell:.6g}" if isinstance(cell, float) else str(cell)


def _rank(name: str) -> int:
    """Where a column belongs: measures, then terms, then what is known of shapes."""
    return 1 if name.startswith(_OF_TERMS) else 2 if name.startswith(OF_SHAPE) else 0


def _in_csv(cell: Cell) -> str:
    cell = _finite(cell)
    if cell is None:
        return ""
    return _as_text(cell) if isinstance(cell, str) else repr(cell)


def _as_text(text: str) -> str:
    """A text that no spreadsheet takes for a formula."""
    return f"'{text}" if text.startswith(_LEADS_TO_FORMULAS) else text


def _finite(cell: Cell) -> Cell:
    """The cell; None where it is no number that can be told."""
    return None if isinstance(cell, float) and not math.isfinite(cell) else cell
