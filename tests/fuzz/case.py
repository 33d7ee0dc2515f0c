"""What a fuzz case is: a file that moseg is given, and what is known beforehand of what it holds.

A case is made when it is asked for, from a name and a seed, and is the same bytes each time. It
says what moseg is to do with it:

=========  =====================================================================================
expected   right is
=========  =====================================================================================
`REFUSED`  an error of one line; to accept the file is to accept nonsense
`SOUND`    a result that holds what the generator put in; a refusal is wrong
`EITHER`   an error of one line, or a result that could be one of such a file
=========  =====================================================================================

Whatever is accepted must also pass what :mod:`tests.fuzz.verdict` asks of any result: finite
areas, counts within those that are known, no warnings of NumPy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

REFUSED, SOUND, EITHER = "refused", "sound", "either"

Made = bytes | Mapping[str, bytes]
"""The contents of the file, or of several: those whose names begin with it, and its companions."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One file, or a few that belong together.

    Parameters
    ----------
    format : str
        The row of the table: "off", "ply", "labels json".
    kind : str
        What is wrong with it, in the words of the other table: "cut off".
    name : str
        Which of that format and kind it is.
    suffix : str
        Of the file, with its point.
    make : callable
        Makes the bytes of the file; or a mapping of relative names to bytes, "" for the file.
    task : str
        What reads it: "shape", "labels", "result", "recipe", "expression",
        "checkpoint".
    expected : str
        One of the three above.
    elements : (int, int)
        How many elements, labels or parts a result has at least and at most.
    area : float, optional
        What the areas of all elements add up to.
    file_name : str
        The whole name of the file where that is what is tried; else it is made of the others.
    """

    format: str
    kind: str
    name: str
    suffix: str
    make: Callable[[], Made] = field(repr=False)
    task: str = "shape"
    expected: str = EITHER
    elements: tuple[int, int] = (1, 1 << 62)
    area: float | None = None
    file_name: str = ""

    @property
    def key(self) -> str:
        """Format, kind and name: what no other case has."""
        return f"{self.format}: {self.kind}: {self.name}"

    def files(self) -> dict[str, bytes]:
        """Names and contents of the files; that of the case itself is the first."""
        made = self.make()
        named = {"": made} if isinstance(made, bytes) else dict(made)
        return {(name or self.file_name or f"case{self.suffix}"): b for name, b in named.items()}


def constant(made: Made) -> Callable[[], Made]:
    """A function that makes what is small enough to be there already."""
    return lambda: made


def checked(cases: Iterable[Case]) -> list[Case]:
    """The cases in their order; each has a key of its own."""
    found = list(cases)
    keys = {case.key for case in found}
    if len(keys) < len(found):
        seen: set[str] = set()
        twice = next(case.key for case in found if case.key in seen or seen.add(case.key))
        raise AssertionError(f"two cases are called '{twice}'")
    return found
