"""Tables: values with names, kept beside an expression and called by one name in it.

What is known of a leg may be thirteen targets; a learned discriminant is a few dozen numbers. Both
would drown an expression, so they stand in tables of the recipe, and the expression names them::

    minimize = "is(leg*, given=leg) + likely(leg*, kind=leg, among=looks)"

    [given.leg]
    area = "0.06+-0.02"
    thickness = "0.04+-0.01"

    [given.looks.leg]
    bias = -1.5

In a call ``given=leg`` takes the parameters of the call from a table, and a parameter that is
declared as a :class:`Table` (:mod:`moseg_core.components.parameters`) is given by the name of one.
Names are looked up by :func:`named_table` when a problem is made
(:mod:`moseg_core.problem.binding`), so that an expression is printed as it was written.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from numbers import Integral, Real
from typing import Any, TypeAlias, Union

from moseg_core.errors import ExpressionError, UsageError, unknown
from moseg_core.language.parser import parse_target
from moseg_core.language.target import Target
from moseg_core.language.tokens import GIVE_OR_TAKE

GIVEN = "given"
"""The key of a call that takes parameters from a table; no component has a parameter of it."""

Entry: TypeAlias = Union[float, str, Target, "Table"]
"""What a table holds: a number (int and bool are some), a text, a target, another table."""


class Table(Mapping[str, Entry]):
    """Values by name, which cannot be changed and can be a key: a table of a recipe.

    Parameters
    ----------
    entries : mapping of str to float, str, Target, mapping or Table
        A text with ``+-`` or ``±`` in it is a target, as in TOML, which has none of its own.

    Raises
    ------
    UsageError
        A key that is no text, or an empty one; a value of another kind; a number that is not
        finite; a malformed target.

    Notes
    -----
    Tables are equal where they are written alike: ``1``, ``1.0`` and ``true`` differ, the order
    of the names does not count.

    Examples
    --------
    >>> table = Table({"area": "0.06+-0.02", "leg": {"bias": -1.5}})
    >>> table["area"], table["leg"]["bias"]
    (Target(value=0.06, spread=0.02), -1.5)
    >>> Table(table.document()) == table
    True
    """

    def __init__(self, entries: Mapping[str, Any] | None = None, *, name: str = "") -> None:
        self._entries = {
            _checked_key(key, name): _read_entry(value, f"{name}.{key}" if name else str(key))
            for key, value in ({} if entries is None else entries).items()
        }

    def __getitem__(self, key: str) -> Entry:
        return self._entries[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    @cached_property
    def _written(self) -> frozenset[tuple[str, object]]:
        # By their texts numbers differ that print differently, so equal tables have equal digests.
        return frozenset(
            (key, value if isinstance(value, Table) else repr(value))
            for key, value in self._entries.items()
        )

    @cached_property
    def _hash(self) -> int:
        return hash(self._written)

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        return isinstance(other, Table) and other._written == self._written

    def __hash__(self) -> int:
        return self._hash

    def __reduce__(self) -> tuple[Any, ...]:
        # Hashes of texts differ from process to process, so none is sent.
        return Table, (self._entries,)

    def __repr__(self) -> str:
        return f"Table({self._entries!r})"

    def document(self) -> dict[str, Any]:
        """The same as plain data, targets as texts, which TOML and JSON can say.

        Examples
        --------
        >>> Table({"area": Target(0.06, 0.02), "most": 3}).document()
        {'area': '0.06+-0.02', 'most': 3}
        """
        return {
            key: value.document()
            if isinstance(value, Table)
            else (str(value) if isinstance(value, Target) else value)
            for key, value in self._entries.items()
        }

    def paths(self, before: str = "") -> Iterator[tuple[str, Table]]:
        """Every table in this one with its path, one after the tables that it is in.

        Examples
        --------
        >>> [path for path, _ in Table({"looks": {"leg": {"bias": 1}}, "arm": {}}).paths()]
        ['looks', 'looks.leg', 'arm']
        """
        for key, value in self._entries.items():
            if isinstance(value, Table):
                yield before + key, value
                yield from value.paths(f"{before}{key}.")


def named_table(tables: Table, name: object) -> Table:
    """The table of a name, or of a path such as ``looks.leg``.

    Raises
    ------
    UsageError
        There is none; names the nearest.

    Examples
    --------
    >>> named_table(Table({"leg": {"area": "0.06+-0.02"}}), "lge")
    Traceback (most recent call last):
        ...
    moseg_core.errors.UsageError: unknown table 'lge'; did you mean 'leg'?
    """
    found = dict(tables.paths())
    if isinstance(name, str) and name in found:
        return found[name]
    if not isinstance(name, str):
        raise UsageError(f"the name of a table is a word, not {name!r}; write given=leg")
    if not found:
        raise UsageError(f"there is no table '{name}'; write one into the recipe: [given.{name}]")
    raise UsageError(unknown("table", name, found))


def _checked_key(key: object, name: str) -> str:
    if not isinstance(key, str) or not key:
        inside = f" in table '{name}'" if name else ""
        raise UsageError(f"the names in a table are texts, not {key!r}{inside}")
    return key


def _read_entry(value: object, path: str) -> Entry:
    """The value of a path in a table, in one of the types that tables hold."""
    if isinstance(value, Table | Target):
        return value
    if isinstance(value, Mapping):
        return Table(value, name=path)
    if isinstance(value, str):
        return _read_text(value, path)
    if isinstance(value, bool | Integral):
        return value if isinstance(value, bool) else int(value)
    if isinstance(value, Real):
        number = float(value)
        if not math.isfinite(number):
            raise UsageError(f"'{path}' in the tables must be finite, not {number}")
        return number
    raise UsageError(f"'{path}' in the tables must be a number, a text or a table, not {value!r}")


def _read_text(text: str, path: str) -> Entry:
    if not any(sign in text for sign in GIVE_OR_TAKE):
        return text
    try:
        return parse_target(text)
    except ExpressionError as error:
        raise UsageError(
            f"'{path}' in the tables is no target: {error.reason} in \"{text}\"; write 0.06+-0.02"
        ) from error
