"""Things by their names, for people who type those names: a wrong one is told the nearest.

Options, labels in expressions and components are looked up by the core, which says what was meant
(:func:`moseg_core.errors.unknown`). What a result hands out by name is looked up by its user, with
brackets, and should say the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypeVar

from moseg_core.errors import unknown

T = TypeVar("T")


class UnknownNameError(KeyError):
    """No entry has this name; a ``KeyError`` whose text is a sentence."""

    def __str__(self) -> str:
        return str(self.args[0])


class Named(Mapping[str, T]):
    """A mapping from names that knows what its entries are called.

    Parameters
    ----------
    entries : mapping of str to object
    kind : str
        What one of them is, in a message: "part".

    Raises
    ------
    KeyError
        Where an entry is asked for that is not there, with the nearest name.

    Examples
    --------
    >>> ages = Named({"Anna": 30, "Hanno": 4}, kind="person")
    >>> ages["Anna"], ages.get("Ana"), list(ages)
    (30, None, ['Anna', 'Hanno'])
    >>> ages["Ana"]
    Traceback (most recent call last):
    moseg_core.search.named.UnknownNameError: unknown person 'Ana'; did you mean 'Anna'?
    """

    def __init__(self, entries: Mapping[str, T], *, kind: str) -> None:
        self._entries, self._kind = dict(entries), kind

    def __getitem__(self, name: str) -> T:
        try:
            return self._entries[name]
        except KeyError:
            raise UnknownNameError(unknown(self._kind, str(name), self._entries)) from None

    def __contains__(self, name: object) -> bool:
        return name in self._entries  # that of a mapping would look for the nearest name

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._entries!r}, kind={self._kind!r})"
